#include "crowd_run.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "run.hpp"

namespace wade::validation {

const std::vector<double> marker_spacings{0.25, 0.1768, 0.125};

Scene crowd_scene(const Request& request, const std::string& name) {
    Request without_water = request;
    without_water.spacing = 0;
    if (!(request.spacing > 0)) return scene_for(without_water, name);
    const double per_cell = std::round(4 / (request.spacing * request.spacing));
    return scene_for(
        without_water, name,
        {assign("/crowd/markers_per_cell", per_cell), assign("/crowd/marker_min_distance_m", 0.4 * request.spacing)});
}

Result crowd_result() {
    Result result;
    result.model = "biocrowds";
    return result;
}

void walk(crowd::CrowdWorld& crowd, Result& result, const crowd::WaterView& water) {
    const double cpu = process_cpu_time();
    const double wall = wall_time();
    result.particle_steps += static_cast<double>(crowd.active.size());
    crowd::step(crowd, water);
    ++result.steps;
    result.particles = std::max(result.particles, crowd.agents.size());
    result.simulated_time += crowd.dt;
    result.solver_cpu_time += process_cpu_time() - cpu;
    result.solver_wall_time += wall_time() - wall;
}

double unrolled_x(const crowd::CrowdWorld& crowd, std::size_t id) {
    return crowd.agents.position[id].x() + crowd.agents.laps[id] * crowd.scene.world->period();
}

void jitter(crowd::CrowdWorld& crowd, double amplitude_x, double amplitude_z) {
    constexpr std::uint64_t stream = 0x6a69747465;  // apart from the marker streams, which are cell numbers
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        const double u = crowd::counter_uniform(crowd.scene.seed, stream, 2 * id);
        const double w = crowd::counter_uniform(crowd.scene.seed, stream, 2 * id + 1);
        crowd.agents.position[id] += crowd::Vector2d((2 * u - 1) * amplitude_x, (2 * w - 1) * amplitude_z);
    }
}

double half_width(const crowd::CrowdWorld& crowd, std::uint32_t id) {
    const std::vector<double>& radius = crowd.agents.body.radius;
    return radius.empty() ? crowd.scene.crowd->body_radius : radius[id];
}

void note_overlaps(const crowd::CrowdWorld& crowd, Overlaps& overlaps) {
    const double period = crowd.scene.world->period();
    std::vector<bool> touched(crowd.active.size(), false);
    for (std::size_t i = 0; i < crowd.active.size(); ++i) {
        const crowd::Vector2d& p = crowd.agents.position[crowd.active[i]];
        const double radius = half_width(crowd, crowd.active[i]);
        for (std::size_t j = i + 1; j < crowd.active.size(); ++j) {
            crowd::Vector2d gap = crowd.agents.position[crowd.active[j]] - p;
            if (period > 0) gap.x() -= period * std::round(gap.x() / period);
            const double reach = radius + half_width(crowd, crowd.active[j]);
            if (gap.squaredNorm() >= reach * reach) continue;
            const double depth = reach - gap.norm();
            touched[i] = touched[j] = true;
            overlaps.pairs += 1;
            overlaps.depth_sum += depth;
            overlaps.deepest = std::max(overlaps.deepest, depth);
        }
    }
    overlaps.samples += static_cast<double>(touched.size());
    overlaps.overlapping += static_cast<double>(std::count(touched.begin(), touched.end(), true));
}

void report_overlaps(const Overlaps& overlaps, const std::string& suffix, Result& result) {
    result.metrics.push_back({"overlap_share" + suffix, overlaps.overlapping / std::max(overlaps.samples, 1.0), "1"});
    result.metrics.push_back({"overlap_depth_mean" + suffix, overlaps.depth_sum / std::max(overlaps.pairs, 1.0), "m"});
    result.metrics.push_back({"overlap_depth_max" + suffix, overlaps.deepest, "m"});
}

}  // namespace wade::validation
