#include "fluid_server/model_choice/scout.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene_frames.hpp"
#include "fluid_server/shallow_water/step.hpp"

namespace wade::fluid::model_choice {

namespace {

namespace swe = fluid::shallow_water;

constexpr std::size_t most_probes = 200;
constexpr double wet_depth = 0.02;  // m, less is a film

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool in_water_way(const Scene& scene, const Probe& p) {
    if (!scene.channel->x.contains(p.x) || !scene.channel->z.contains(p.z)) return false;
    return std::none_of(scene.obstacles.begin(), scene.obstacles.end(),
                        [&](const Obstacle& o) { return o.x.contains(p.x) && o.z.contains(p.z); });
}

// Cell-steps of a run of the whole scene.
double work(const Scene& scene, const SceneWater& water, double size) {
    const auto cells = static_cast<double>(cells_along(scene.channel->x, size) * cells_along(scene.channel->z, size));
    const double steps = std::max(scene.frame_rate, 4 * wave_speed(scene, water) / size);  // two dimensions at cfl 0.5
    return cells * steps * scene.duration;
}

// Cells of half the depth, or as much larger as the budget asks for; no fewer than four across.
double cell_size(const Scene& scene, const SceneWater& water, double budget) {
    const double largest = std::min(scene.channel->z.length(), scene.channel->x.length()) / 4;
    double size = std::min(0.5 * water.depth, largest);
    while (size < largest && work(scene, water, size) * cell_step_cost > budget) size = std::min(1.25 * size, largest);
    return size;
}

// The spacing plays no part on the grid; it has to be less than the depth.
std::optional<LoadedScene> on_grid(const LoadedScene& written, const SceneWater& water, double size) {
    const auto set = [](const std::string& pointer, const std::string& value) {
        return SceneOverride{pointer, value, "the pilot of the choice of the model"};
    };
    try {
        return load_scene_text(
            written.canonical_json, written.scene.name + ".json",
            {set("/fluid/model", "shallow_water"), set("/fluid/max_impulse_error", "0"), set("/fluid/cfl", "0.5"),
             set("/fluid/particle_spacing_m", short_number(0.1 * water.depth)),
             set("/fluid/max_particles", "100000000"), set("/fluid/shallow_water/cell_size_m", short_number(size))});
    } catch (const ConfigurationError&) {
        return std::nullopt;
    }
}

struct Record {
    std::size_t cell = 0;
    double depth = 0, speed = 0, first_time = -1;

    void look(const swe::ShallowWater& world) {
        const double h = world.water.h[cell];
        if (h <= wet_depth) return;
        if (first_time < 0) first_time = world.time;
        const double u = length_of(world.primitive.u[cell], world.primitive.v[cell]);
        if (h * u >= depth * speed) depth = h, speed = u;
    }
};

std::size_t cell_at(const swe::Grid& grid, const Probe& p) {
    const auto along = [](double v, const Interval& extent, std::size_t n) {
        const double place = (v - extent.lo) / extent.length() * static_cast<double>(n);
        return std::min(static_cast<std::size_t>(std::max(place, 0.0)), n - 1);
    };
    return grid.row(static_cast<std::ptrdiff_t>(along(p.z, grid.z, grid.nz))) + along(p.x, grid.x, grid.nx);
}

}  // namespace

std::vector<Probe> probes_of(const Scene& scene) {
    std::vector<Probe> all;
    for (const AgentGroup& group : scene.crowd->groups) {
        for (int k = 0; k < group.count; ++k) {
            const int column = k % group.columns, row = k / group.columns;
            const Probe start{group.start_x + column * group.pitch_x, group.start_z + row * group.pitch_z};
            const bool stands = group.desired_speed == 0;
            for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
                const Probe place{start.x + share * (group.goal_x - start.x),
                                  start.z + share * (group.goal_z - start.z)};
                if ((share == 0 || !stands) && in_water_way(scene, place)) all.push_back(place);
            }
        }
    }
    const std::size_t every = (all.size() + most_probes - 1) / most_probes;
    std::vector<Probe> some;
    for (std::size_t k = 0; k < all.size(); k += std::max<std::size_t>(every, 1)) some.push_back(all[k]);
    return some;
}

std::optional<Meeting> scout(const LoadedScene& written, const SceneWater& water, double budget) {
    const std::vector<Probe> probes = probes_of(written.scene);
    if (probes.empty()) return std::nullopt;
    const auto coarse = on_grid(written, water, cell_size(written.scene, water, budget));
    if (!coarse) return std::nullopt;
    swe::ShallowWater world(coarse->scene);
    std::vector<Record> records;
    records.reserve(probes.size());
    for (const Probe& probe : probes) records.push_back({cell_at(world.grid, probe)});

    Meeting meeting;
    meeting.probes = probes.size();
    const std::uint64_t frames = frames_of(coarse->scene);
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
        if (static_cast<double>(meeting.cell_steps) * cell_step_cost > budget) break;
        const double end = static_cast<double>(frame) / coarse->scene.frame_rate;
        while (world.time < end * (1 - 1e-12)) {
            swe::step(world, end - world.time);
            meeting.cell_steps += world.grid.cells();
        }
        meeting.until = end;
        for (Record& record : records) record.look(world);
    }
    std::vector<double> depths, speeds;
    meeting.first_time = meeting.until;
    for (const Record& record : records) {
        if (record.first_time < 0) continue;
        meeting.first_time = std::min(meeting.first_time, record.first_time);
        depths.push_back(record.depth);
        speeds.push_back(record.speed);
    }
    meeting.wet = depths.size();
    meeting.depth = median(depths);
    meeting.speed = median(speeds);
    return meeting;
}

}  // namespace wade::fluid::model_choice
