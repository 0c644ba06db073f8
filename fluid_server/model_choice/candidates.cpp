#include "fluid_server/model_choice/candidates.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade::fluid::model_choice {

namespace {

constexpr const char* choice_source = "the choice of the model";

using Rows = std::array<const TableRow*, water_kinds>;  // by kind; null where the table has none

bool same_but_spacing(Settings a, const Settings& b) {
    a.spacing = b.spacing;
    return a == b;
}

// Returns the row of a kind for this spacing: the finest row that is no finer than `spacing`; null if there is none.
const TableRow* row_for(const std::vector<TableRow>& table, WaterKind kind, const Settings& settings, double spacing) {
    const TableRow* best = nullptr;
    for (const TableRow& row : table) {
        if (row.kind != kind || !same_but_spacing(row.settings, settings)) continue;
        if (row.settings.spacing < spacing * (1 - rounding_tolerance)) continue;
        if (best == nullptr || row.settings.spacing < best->settings.spacing) best = &row;
    }
    return best;
}

// As few digits as give the same number again.
std::string exact(double value) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// Six significant digits are enough for a spacing that is the choice's own, and can be read.
double readable(double value) {
    return std::stod(short_number(value));
}

std::vector<SceneOverride> overrides_of(const Candidate& candidate, const Scene& written) {
    std::vector<SceneOverride> list;
    const auto set = [&](const std::string& pointer, const std::string& value) {
        list.push_back({pointer, value, choice_source + (": " + pointer + "=" + value)});
    };
    const Settings& s = candidate.settings;
    set("/fluid/model", s.model);
    set("/fluid/max_impulse_error", "0");
    set("/fluid/particle_spacing_m", exact(candidate.spacing));
    if (s.model == "shallow_water") set("/fluid/shallow_water/cell_size_m", exact(candidate.spacing));
    if (!s.tolerance.empty()) set("/fluid/density_solve/tolerance", s.tolerance);
    if (s.divergence_tolerance == "off") {
        set("/fluid/divergence_solve/max_iterations", "0");
    } else if (!s.divergence_tolerance.empty()) {
        set("/fluid/divergence_solve/tolerance", s.divergence_tolerance);
    }
    if (!s.cfl.empty()) {
        set("/fluid/cfl", s.cfl);
    } else if (s.model == "shallow_water") {
        set("/fluid/cfl", exact(std::min(written.fluid->cfl, 0.5)));
    }
    if (!s.kernel.empty()) set("/fluid/kernel", s.kernel);
    return list;
}

// An emitter keeps the volume of its stock, but no more than twice what the channel takes; other channels need what they
// hold.
std::uint64_t room_for(const Scene& written, double spacing, std::uint64_t needed) {
    if (written.channel->flow != Flow::emitter) return needed;
    const double finer = std::pow(written.fluid->particle_spacing / spacing, 3);
    const auto stock =
        static_cast<std::uint64_t>(std::floor(written.fluid->max_particles * finer * (1 + rounding_tolerance)));
    return std::min(stock, 2 * needed);
}

// Sets what depends on the scene: particles, cost, overrides, and whether it can be run.
void complete(Candidate& c, const LoadedScene& written) {
    Scene scene = written.scene;
    scene.fluid->particle_spacing = c.spacing;
    if (const auto kernel = choice_named<KernelKind>(c.settings.kernel)) scene.fluid->kernel = *kernel;
    c.particles = particles_needed(scene);
    c.cost = c.particle_steps(scene.duration) * c.step_cost;
    c.overrides = overrides_of(c, written.scene);
    const std::string room = std::to_string(room_for(written.scene, c.spacing, c.particles));
    c.overrides.push_back({"/fluid/max_particles", room, choice_source + (": /fluid/max_particles=" + room)});
    // Its front is to move as the crowd, which is not told of the choice, expects.
    if (c.settings.model == "kinematic" && scene.fluid->kinematic.transport_factor != 1) {
        c.refused = "/fluid/kinematic/transport_factor is not 1";
        return;
    }
    try {
        static_cast<void>(scene_as(written, c));
    } catch (const ConfigurationError& error) {
        c.refused = error.what();
    }
}

// A candidate at this spacing, from the rows of all kinds of water; nothing if one is missing.
std::optional<Candidate> candidate_at(const std::vector<TableRow>& table, const Settings& settings, double spacing,
                                      const LoadedScene& written, const SceneWater& water) {
    Candidate c;
    c.settings = settings;
    c.spacing = spacing;
    for (const KindOfWater& kind : water.kinds) {
        const TableRow* row = row_for(table, kind.kind, settings, spacing / water.scale);
        if (row == nullptr) return std::nullopt;
        if (estimate_margin * row->impulse_median >= c.median) {
            c.median = estimate_margin * row->impulse_median;
            c.worst = kind.kind;
        }
        c.p95 = std::max(c.p95, estimate_margin * row->impulse_p95);
        const double faster = row->wave_speed > 0 ? wave_speed(written.scene, water) / row->wave_speed : 1;
        c.steps_per_s = std::max(c.steps_per_s, row->steps_per_s * faster * row->settings.spacing / spacing);
        c.step_cost = std::max(c.step_cost, row->particle_step_cost);
        c.settings.spacing = std::min(c.settings.spacing, row->settings.spacing);
    }
    c.steps_per_s = std::max(c.steps_per_s, written.scene.frame_rate);  // no step is longer than a frame
    complete(c, written);
    return c;
}

}  // namespace

LoadedScene scene_as(const LoadedScene& written, const Candidate& candidate) {
    LoadedScene chosen = load_scene_text(written.canonical_json, written.scene.name + ".json", candidate.overrides);
    chosen.scene.hash = written.scene.hash;  // the crowd recognises the stream by it
    return chosen;
}

std::vector<Candidate> candidates_of(const std::vector<TableRow>& table, const LoadedScene& written,
                                     const SceneWater& water) {
    std::vector<Candidate> all;
    std::vector<Settings> seen;
    const double own = written.scene.fluid->particle_spacing;
    const auto add = [&](const Settings& settings, double spacing) {
        const bool there = std::any_of(all.begin(), all.end(), [&](const Candidate& c) {
            return same_but_spacing(c.settings, settings) && std::abs(c.spacing - spacing) <= 1e-5 * spacing;
        });
        if (there) return;
        if (const auto candidate = candidate_at(table, settings, spacing, written, water)) all.push_back(*candidate);
    };
    for (const TableRow& row : table) {
        if (std::find(seen.begin(), seen.end(), row.settings) != seen.end()) continue;
        seen.push_back(row.settings);
        add(row.settings, own);
        add(row.settings, readable(row.settings.spacing * water.scale));
    }
    std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
        return std::pair(!a.refused.empty(), a.cost) < std::pair(!b.refused.empty(), b.cost);
    });
    return all;
}

std::vector<Candidate> front_of(const std::vector<Candidate>& candidates) {
    std::vector<Candidate> front;
    for (const Candidate& c : candidates) {
        if (c.refused.empty() && (front.empty() || c.median < front.back().median)) front.push_back(c);
    }
    return front;
}

std::optional<std::size_t> choose(const std::vector<Candidate>& front, double demand) {
    for (std::size_t k = 0; k < front.size(); ++k) {
        if (front[k].median <= demand * (1 + rounding_tolerance)) return k;
    }
    return std::nullopt;
}

std::string label(const Candidate& candidate) {
    const Settings& s = candidate.settings;
    std::string text = s.model + ", d = " + short_number(candidate.spacing) + " m";
    if (s.model == "shallow_water") text = s.model + ", cells of " + short_number(candidate.spacing) + " m";
    if (!s.tolerance.empty()) text += ", tol " + s.tolerance;
    if (!s.divergence_tolerance.empty()) text += ", div " + s.divergence_tolerance;
    if (!s.cfl.empty()) text += ", cfl " + s.cfl;
    if (s.kernel == "quartic_spline") text += ", quartic";
    if (s.kernel == "wendland_c2") text += ", wendland";
    return text;
}

}  // namespace wade::fluid::model_choice
