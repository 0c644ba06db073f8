#include "configs/scene/scene_capacity.hpp"

#include <algorithm>
#include <limits>

#include "configs/scene/particle_volume.hpp"

namespace wade {

double support_in_spacings_of(const Fluid& fluid) {
    switch (fluid.kernel) {
        case KernelKind::quartic_spline:
            return 2.4;
        case KernelKind::wendland_c2:
            return 3;
        case KernelKind::cubic_spline:
        case KernelKind::automatic:
            break;
    }
    return fluid.support_in_spacings;
}

double support_radius_of(const Fluid& fluid) {
    return support_in_spacings_of(fluid) * fluid.particle_spacing;
}

namespace {

// Of a place, as far as levels tell: those of its water and its outlets above the lowest ground of its raster, at least 1 m.
double deepest_water(const Place& place) {
    double lowest = std::numeric_limits<double>::infinity(), depth = 1;
    if (place.ground.raster) {
        for (const double y : place.ground.raster->values) lowest = y < lowest ? y : lowest;
    } else {
        lowest = place.ground.level;
        for (const auto& point : place.ground.points) lowest = std::min(lowest, point[1]);
    }
    for (const StandingWater& water : place.water) depth = std::max(depth, water.level - lowest);
    for (const Outlet& outlet : place.outlets) {
        for (const SeriesPoint& point : outlet.stage) depth = std::max(depth, point.value - lowest);
    }
    return depth;
}

}  // namespace

Interval heights_of_ground(const Scene& scene) {
    const Ground& ground = scene.place->ground;
    Interval heights{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto take = [&](double y) { heights = {std::min(heights.lo, y), std::max(heights.hi, y)}; };
    if (ground.raster) {
        for (const double y : ground.raster->values) {
            if (!std::isnan(y)) take(y);
        }
        return heights;
    }
    for (const auto& point : ground.points) take(point[1]);
    for (const double x : {0.0, scene.world.length}) {
        for (const double z : {0.0, scene.world.width}) {
            if (ground.points.empty()) take(ground.level + ground.slope_x * x + ground.slope_z * z);
        }
    }
    return heights;
}

double deepest_water(const Scene& scene) {
    if (scene.place) return deepest_water(*scene.place);
    const Channel& channel = scene.channel;
    const bool by_blocks = channel.flow == Flow::closed || !channel.water_blocks.empty();
    double depth = by_blocks ? 0 : channel.depth;
    for (const WaterBlock& block : channel.water_blocks) {
        depth = std::max(depth, block.y_min + block.depth);
    }
    return depth;
}

std::uint64_t river_particles(const Scene& scene) {
    const Channel& channel = scene.channel;
    return particles_in(channel.x.length() * channel.z.length() * channel.depth, scene.fluid.particle_spacing);
}

std::uint64_t particles_needed(const Scene& scene) {
    const Channel& channel = scene.channel;
    const double d = scene.fluid.particle_spacing;
    switch (channel.flow) {
        case Flow::emitter:
            return particles_in(
                (channel.x.length() + support_radius_of(scene.fluid) + 3 * d) * channel.z.length() * channel.depth, d);
        case Flow::recirculating:
            return river_particles(scene);
        case Flow::periodic:
            if (channel.initial_river == InitialRiver::filled) return river_particles(scene);
            break;
        case Flow::closed:
            break;
    }
    std::uint64_t sum = 0;
    for (const WaterBlock& block : channel.water_blocks) {
        sum += particles_in(block.x.length() * block.z.length() * block.depth, d);
    }
    return sum;
}

std::uint64_t particles_expected(const Scene& scene) {
    const auto room = static_cast<std::uint64_t>(std::max(scene.fluid.max_particles, 0));
    return std::min(particles_needed(scene), room);
}

}  // namespace wade
