#include "crowd_client/water/water_met.hpp"

#include <algorithm>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "crowd_client/water/contacts.hpp"

namespace wade::crowd {
namespace {

// Returns the cell of a position, along one axis.
Interval cell_of(double place) {
    const double start = GroundGrid::line_start(GroundGrid::line_of(place));
    return {start, start + GroundGrid::cell_size};
}

bool holds(const Interval& interval, double place) {
    return place >= interval.lo && place <= interval.hi;
}

double mean(double sum, std::uint64_t steps) {
    return steps > 0 ? sum / static_cast<double>(steps) : 0;
}

}  // namespace

double channel_share(const Channel& channel, const Vector2d& place) {
    if (!holds(channel.x, place.x()) || !holds(channel.z, place.y())) return 0;
    constexpr double area = GroundGrid::cell_size * GroundGrid::cell_size;
    return common_length(channel.x, cell_of(place.x())) * common_length(channel.z, cell_of(place.y())) / area;
}

void note_water_met(Agents& agents, const Scene& scene, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, const WaterBins& water) {
    for (std::size_t k = 0; k < active.size(); ++k) {
        const std::uint32_t id = active[k];
        const CellWater met = water_at(water, positions[k], scene.fluid->rest_density);
        agents.max_depth[id] = std::max(agents.max_depth[id], met.depth);
        agents.max_dv[id] = std::max(agents.max_dv[id], met.depth * met.speed);
        const double share = water.has_columns() ? 1.0 : channel_share(scene.channel, positions[k]);
        if (!(met.depth > 0) || !(share > 0)) continue;
        ++agents.wet_steps[id];
        agents.depth_sum[id] += met.depth / share;
        agents.dv_sum[id] += met.depth / share * met.speed;
        agents.tau_sum[id] += agents.tau[id];
    }
}

double mean_depth_met(const Agents& agents, std::size_t id) {
    return mean(agents.depth_sum[id], agents.wet_steps[id]);
}

double mean_dv_met(const Agents& agents, std::size_t id) {
    return mean(agents.dv_sum[id], agents.wet_steps[id]);
}

double mean_tau_met(const Agents& agents, std::size_t id) {
    return mean(agents.tau_sum[id], agents.wet_steps[id]);
}

}  // namespace wade::crowd
