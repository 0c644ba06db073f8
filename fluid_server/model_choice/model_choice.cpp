#include "fluid_server/model_choice/model_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <system_error>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"

namespace wade::fluid::model_choice {

namespace {

std::string digits(double value, int significant) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", significant, value);
    return text;
}

// Rounded up to three digits, so that it is allowed.
std::string rounded_up(double value) {
    const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
    return short_number(std::ceil(value / unit * (1 - 1e-12)) * unit);
}

std::string times(double factor) {
    return digits(factor, factor >= 100 ? 3 : 2) + " times";
}

std::string kinds_text(const SceneWater& water) {
    std::string text;
    for (const KindOfWater& kind : water.kinds) {
        text += (text.empty() ? "" : "; ") + std::string(name_of(kind.kind)) + " (" + kind.why + ")";
    }
    return text;
}

[[noreturn]] void refuse_demand(const std::vector<Candidate>& all, const std::vector<Candidate>& front, double demand,
                                const std::string& source) {
    if (front.empty()) {
        const std::string why = all.empty() ? "the table has no model for this kind of water" : all.front().refused;
        refuse(source, "/fluid/model", "\"auto\" has no model for this scene: " + why);
    }
    const Candidate& best = front.back();
    refuse(source, "/fluid/max_impulse_error",
           short_number(demand) + " cannot be met: the smallest estimated error is " + digits(best.median, 3) +
               ", of " + label(best) + ", at " + times(best.cost / front.front().cost) + " the cost of the cheapest, " +
               label(front.front()) + " (about " + digits(best.cost, 2) +
               " s of CPU time for the whole run); allowed: >= " + rounded_up(best.median) + ".");
}

std::string candidate_line(const Candidate& c, const Candidate& chosen) {
    char text[200];
    std::snprintf(text, sizeof text, "  %-58s %7.2g %7.2g %9.2g  %s", label(c).c_str(), c.median, c.p95,
                  c.cost / chosen.cost, &c == &chosen ? "<- taken" : "");
    std::string line = text;
    line.erase(line.find_last_not_of(' ') + 1);
    return line;
}

std::string meeting_line(const std::optional<Meeting>& meeting, double duration) {
    if (!meeting)
        return "pilot: no scout, as \"shallow_water\" cannot take this scene or no people come into its channel";
    const Meeting& m = *meeting;
    std::string text = "pilot: shallow water through " + digits(m.until, 3) + " of " + digits(duration, 4) + " s (" +
                       std::to_string(m.cell_steps) + " cell-steps): ";
    if (m.wet == 0) return text + "none of " + std::to_string(m.probes) + " places of people meets water";
    return text + std::to_string(m.wet) + " of " + std::to_string(m.probes) + " places of people meet water, from " +
           digits(m.first_time, 2) + " s on, typically " + digits(m.depth, 2) + " m at " + digits(m.speed, 2) + " m/s";
}

std::string pilot_line(const PilotResult& p, const Candidate& chosen, const Candidate& better) {
    return "pilot: " + digits(p.time, 2) + " s of such water, chosen against " + label(better) +
           ": impulses differ by " + digits(p.difference, 2) +
           " (median of 8), by the demand and the estimate at most " + digits(p.allowed, 2) + "; " +
           digits(p.steps_per_s, 3) + " time steps a second, expected " + digits(chosen.steps_per_s, 3) + "; cost " +
           digits(100 * p.cost / chosen.cost, 2) + " % of the run";
}

// Runs scout and pilot of the candidate at `index` and goes one up if they contradict it.
void check_by_pilot(const LoadedScene& written, const SceneWater& water, const std::vector<Candidate>& front,
                    std::size_t& index, ModelChoice& choice) {
    const Candidate& chosen = front[index];
    const double budget = std::max(pilot_share * chosen.cost, least_pilot);
    choice.meeting = scout(written, water, 0.3 * budget);
    choice.lines.push_back(meeting_line(choice.meeting, written.scene.duration));
    if (index + 1 == front.size()) {
        choice.lines.emplace_back("pilot: nothing to compare with, no candidate is better");
        return;
    }
    const Candidate& better = front[index + 1];
    const double spent = choice.meeting ? static_cast<double>(choice.meeting->cell_steps) * cell_step_cost : 0;
    std::string why;
    choice.pilot = run_pilot(written, water, choice.meeting, chosen, better, written.scene.fluid->max_impulse_error,
                             budget - spent, why);
    if (!choice.pilot) {
        choice.lines.push_back("pilot: no comparison with the next better candidate: " + why);
        return;
    }
    choice.lines.push_back(pilot_line(*choice.pilot, chosen, better));
    if (!choice.pilot->contradicts()) return;
    choice.went_up = true;
    ++index;
    choice.lines.push_back("pilot: contradicts the choice, so that the next better candidate is taken: " +
                           label(better) + ", estimated median error " + digits(better.median, 2));
}

}  // namespace

ModelChoice choose_model(const LoadedScene& written, const std::string& source, bool with_pilot,
                         const std::vector<TableRow>& table) {
    const SceneWater water = water_of(written.scene);
    const std::vector<Candidate> all = candidates_of(table, written, water);
    const std::vector<Candidate> front = front_of(all);
    const double demand = written.scene.fluid->max_impulse_error;
    const std::optional<std::size_t> cheapest = choose(front, demand);
    if (!cheapest) refuse_demand(all, front, demand, source);

    std::size_t index = *cheapest;
    ModelChoice choice;
    std::vector<std::string>& lines = choice.lines;
    lines.push_back("model \"auto\", max_impulse_error " + short_number(demand) + ": water of this scene: " +
                    kinds_text(water) + "; lengths of the table times " + digits(water.scale, 3));
    lines.emplace_back("  candidates that none beats in error and cost                median    95 %      cost");
    for (const Candidate& c : front) lines.push_back(candidate_line(c, front[index]));
    lines.push_back("the cheapest with an estimated median error of at most " + short_number(demand) + ": " +
                    label(front[index]) + " (" + digits(front[index].median, 2) + ", by the kind " +
                    std::string(name_of(front[index].worst)) + "); about " + digits(front[index].cost, 2) +
                    " s of CPU time for the whole run on the machine of the table");
    if (with_pilot) check_by_pilot(written, water, front, index, choice);
    choice.chosen = front[index];
    choice.scene = scene_as(written, choice.chosen);
    std::string repeat;
    for (const SceneOverride& change : choice.chosen.overrides)
        repeat += " --set " + change.pointer + "=" + change.value;
    lines.push_back("chosen: " + label(choice.chosen) + "; estimated error: median " + digits(choice.chosen.median, 3) +
                    ", 95 % " + digits(choice.chosen.p95, 3) + ", by the kind " +
                    std::string(name_of(choice.chosen.worst)));
    lines.push_back("without a choice the same is:" + repeat);
    return choice;
}

std::filesystem::path write_chosen(const LoadedScene& chosen, const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "scene_as_chosen.json", part = folder / "scene_as_chosen.json.part";
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    std::ofstream out(part);
    out << chosen.canonical_json;
    out.close();
    if (!out) throw ConfigurationError("--out: cannot write " + file.string());
    std::filesystem::rename(part, file);
    return file;
}

}  // namespace wade::fluid::model_choice
