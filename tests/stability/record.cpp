#include "record.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "configs/json/json.hpp"
#include "tests/reasoned_table.hpp"

namespace wade::stability {

namespace {

// JSON knows no infinity: such a value becomes text.
Json number(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : "inf";
}

}  // namespace

std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file) {
    std::vector<KnownFailure> all;
    for (const tables::Row& row : tables::read(file, "case,setting,rule,guard,reason")) {
        const double guard = tables::number(row.fields[3], row.place, "a guard, a number >= 0");
        all.push_back({row.fields[0], row.fields[1], row.fields[2], guard, row.reason});
    }
    return all;
}

bool is_known(const std::vector<KnownFailure>& all, const std::string& name, const std::string& setting,
              const Check& check) {
    return std::any_of(all.begin(), all.end(), [&](const KnownFailure& f) {
        return f.name == name && (f.setting == "*" || f.setting == setting) && f.rule == check.name &&
               check.holds(f.guard);
    });
}

std::string verdict(const Case& hard_case, const Run& run, const Result& result,
                    const std::vector<KnownFailure>& known) {
    if (passes(result)) return "pass";
    const std::vector<Check> checks = all_checks(result);
    const bool all_known = std::all_of(checks.begin(), checks.end(), [&](const Check& check) {
        return check.passes() || is_known(known, hard_case.name, run.setting, check);
    });
    return all_known ? "known" : "fail";
}

std::string record_text(const Case& hard_case, const Run& run, const Result& r,
                        const std::vector<KnownFailure>& known) {
    Json j;
    j["case"] = hard_case.name;
    j["trouble"] = hard_case.trouble;
    j["setting"] = run.setting;
    j["overrides"] = run.overrides;
    j["threads"] = run.threads;
    j["form"] = run.long_form ? "long" : run.quick ? "quick" : "full";
    j["fingerprint"] = run.fingerprint;
    j["model"] = r.model;
    j["particles"] = r.particles;
    j["steps"] = r.steps;
    j["simulated_time_s"] = r.simulated_time;
    j["cpu_s"] = r.cpu_time;
    j["mean_density_error"] = number(r.mean_density_error);
    j["max_density_error"] = number(r.max_density_error);
    j["energy_ratio"] = number(r.energy_ratio);
    j["kinetic_ratio"] = number(r.kinetic_ratio);
    j["lost_particles"] = r.lost_particles;
    j["nonfinite"] = r.nonfinite;
    j["max_displacement_over_spacing"] = number(r.max_displacement);
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(r.state_hash));
    j["state_hash"] = hash;
    j["checks"] = Json::array();
    for (const Check& check : all_checks(r)) {
        j["checks"].push_back({{"name", check.name},
                               {"value", number(check.value)},
                               {"rule", check.rule_text()},
                               {"pass", check.passes()},
                               {"known", !check.passes() && is_known(known, hard_case.name, run.setting, check)}});
    }
    j["failure"] = r.failure;
    j["remarks"] = r.remarks;
    j["pass"] = passes(r);
    j["verdict"] = verdict(hard_case, run, r, known);
    return j.dump({.indent = 2}) + "\n";
}

void write_record(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories(file.parent_path());
    const std::filesystem::path part = file.string() + ".part";
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    if (!out) throw std::runtime_error("cannot write " + part.string());
    std::filesystem::rename(part, file);
}

}  // namespace wade::stability
