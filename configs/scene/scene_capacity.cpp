#include "configs/scene/scene_capacity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/polygon_rows.hpp"
#include "configs/scene/world.hpp"

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

double reach_of_water(const Fluid& fluid) {
    const double support = support_radius_of(fluid);
    return fluid.model == ModelKind::shallow_water ? std::min(support, fluid.shallow_water.cell_size) : support;
}

namespace {

// Of a site, as far as levels tell: those of its water and its outlets above the lowest ground of its raster, at least 1 m.
double deepest_water(const Site& site) {
    double lowest = std::numeric_limits<double>::infinity(), depth = 1;
    if (site.ground.raster) {
        for (const double y : site.ground.raster->values) lowest = y < lowest ? y : lowest;
    } else {
        lowest = site.ground.level;
        for (const auto& point : site.ground.points) lowest = std::min(lowest, point[1]);
    }
    for (const StandingWater& water : site.water) depth = std::max(depth, water.level - lowest);
    for (const Outlet& outlet : site.outlets) {
        for (const SeriesPoint& point : outlet.stage) depth = std::max(depth, point.value - lowest);
    }
    return depth;
}

}  // namespace

Interval heights_of_ground(const Scene& scene) {
    const Ground& ground = scene.site->ground;
    Interval heights{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto take = [&](double y) { heights = {std::min(heights.lo, y), std::max(heights.hi, y)}; };
    if (ground.raster) {
        for (const double y : ground.raster->values) {
            if (!std::isnan(y)) take(y);
        }
        return heights;
    }
    for (const auto& point : ground.points) take(point[1]);
    for (const double x : {0.0, scene.world->length}) {
        for (const double z : {0.0, scene.world->width}) {
            if (ground.points.empty()) take(ground.level + ground.slope_x * x + ground.slope_z * z);
        }
    }
    return heights;
}

double deepest_water(const Scene& scene) {
    if (scene.site) return deepest_water(*scene.site);
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
    return particles_in(channel.x.length() * channel.z.length() * channel.depth, scene.fluid->particle_spacing);
}

namespace {

// Returns the volume of standing water on a site at t = 0, m3, from depths at points as far apart as particles, but at
// most about a million points.
double standing_water(const Scene& scene) {
    const Site& site = *scene.site;
    const double area = scene.world->length * scene.world->width;
    const double step = std::max(scene.fluid->particle_spacing, std::sqrt(area / 1e6));
    const auto along = [&](double length) { return static_cast<int>(std::max(1.0, std::round(length / step))); };
    const int nx = along(scene.world->length), nz = along(scene.world->width);
    const double dx = scene.world->length / nx, dz = scene.world->width / nz;
    const PointGrid grid{nx, nz, dx, dz};
    const auto number = [&](int column, int row) { return static_cast<std::size_t>(row * nx + column); };
    std::vector<double> depths(static_cast<std::size_t>(nx) * static_cast<std::size_t>(nz), 0.0);
    for (int row = 0; row < nz; ++row) {
        for (int column = 0; column < nx && site.water_depth; ++column)
            depths[number(column, row)] = height_in(*site.water_depth, grid.at(column, row));
    }
    for (const StandingWater& water : site.water) {
        const auto fill = [&](int column, int row) {
            double& depth = depths[number(column, row)];
            depth = std::max(depth, water.level - ground_height(site.ground, grid.at(column, row)));
        };
        const MapPolygon everywhere{{{{0, 0}, {nx * dx, 0}, {nx * dx, nz * dz}, {0, nz * dz}}}};
        for_each_point_in(water.polygon.rings.empty() ? everywhere : water.polygon, grid, fill);
    }
    for (const House& house : site.houses)
        for_each_point_in(house.polygon, grid, [&](int column, int row) { depths[number(column, row)] = 0; });
    double volume = 0;
    for (const double depth : depths) {
        if (depth > 0) volume += depth * dx * dz;
    }
    return volume;
}

}  // namespace

std::uint64_t particles_needed(const Scene& scene) {
    if (scene.site) return particles_in(standing_water(scene), scene.fluid->particle_spacing);
    const Channel& channel = scene.channel;
    const double d = scene.fluid->particle_spacing;
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
    const auto room = static_cast<std::uint64_t>(std::max(scene.fluid->max_particles, 0));
    double volume = 0;
    if (scene.site) {
        for (const Source& source : scene.site->sources) volume += integral_of(source.discharge, 0, scene.duration);
    }
    const double from_sources = volume / particle_volume(scene.fluid);
    return std::min(particles_needed(scene) + static_cast<std::uint64_t>(std::min(from_sources, 1e9)), room);
}

}  // namespace wade
