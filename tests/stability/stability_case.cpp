#include "stability_case.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"
#include "configs/loading/scene_loader.hpp"

namespace wade::stability {

bool Check::holds(double bound) const {
    switch (rule) {
        case Rule::at_most:
            return value <= bound;
        case Rule::less_than:
            return value < bound;
        case Rule::at_least:
            return value >= bound;
        case Rule::report:
            return true;
    }
    return false;
}

std::string Check::rule_text() const {
    if (rule == Rule::report) return {};
    std::ostringstream text;
    text << (rule == Rule::at_most ? "<= " : rule == Rule::less_than ? "< " : ">= ") << limit;
    return text.str();
}

std::vector<Check> all_checks(const Result& r) {
    std::vector<Check> checks{
        {"given_up", r.failure.empty() ? 0.0 : 1.0, Check::Rule::at_most, 0},
        {"nonfinite", static_cast<double>(r.nonfinite), Check::Rule::at_most, 0},
        {"lost_particles", static_cast<double>(r.lost_particles), Check::Rule::at_most, 0},
        {"mean_density_error", r.mean_density_error, Check::Rule::at_most, Rules::mean_compression},
        {"energy_ratio", r.energy_ratio, Check::Rule::at_most, Rules::energy_ratio},
        {"kinetic_ratio", r.kinetic_ratio, Check::Rule::at_most, Rules::kinetic_ratio},
        {"displacement", r.max_displacement, Check::Rule::less_than, Rules::displacement},
    };
    checks.insert(checks.end(), r.checks.begin(), r.checks.end());
    return checks;
}

bool passes(const Result& result) {
    const std::vector<Check> checks = all_checks(result);
    return std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passes(); });
}

const std::vector<Case>& all_cases() {
    static const std::vector<Case> cases = [] {
        std::vector<Case> all;
        for (const std::vector<Case>& family :
             {water_cases(), sloshing_cases(), inflow_cases(), particle_cases(), likeness_cases(), crowd_cases()}) {
            all.insert(all.end(), family.begin(), family.end());
        }
        return all;
    }();
    return cases;
}

Scene scene_for(const Request& request, const std::string& name, const std::vector<std::string>& quick_overrides) {
    std::vector<SceneOverride> overrides;
    if (request.quick) {
        for (const std::string& text : quick_overrides) overrides.push_back(parse_override(text));
    }
    for (const std::string& text : request.overrides) overrides.push_back(parse_override(text));
    const std::filesystem::path file = std::filesystem::path(WADE_CONFIGS) / "stability" / (name + ".json");
    if (std::filesystem::exists(file)) return load_scene(file, overrides).scene;
    const std::string scenes = read_text_file(WADE_HARD_SCENES, WADE_HARD_SCENES);
    return load_scene_text(Json::parse(scenes, {.comments = true}).at(name).dump(), file, overrides).scene;
}

void check_at_most(Result& result, const std::string& name, double value, double limit) {
    result.checks.push_back({name, value, Check::Rule::at_most, limit});
}

void check_at_least(Result& result, const std::string& name, double value, double limit) {
    result.checks.push_back({name, value, Check::Rule::at_least, limit});
}

void note(Result& result, const std::string& name, double value) {
    result.checks.push_back({name, value, Check::Rule::report, 0});
}

}  // namespace wade::stability
