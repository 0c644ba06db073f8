#pragma once
// Small scenes for the tests of the fluid, and a loop over visible neighbours.

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/site/site_solids.hpp"

namespace wade::fluid::test {

inline Fluid fluid_of(double spacing, int capacity) {
    Fluid fluid;
    fluid.particle_spacing = spacing;
    fluid.max_particles = capacity;
    fluid.kinematic_viscosity = 0.01;
    fluid.cfl = 0.4;
    fluid.density_solve = {5e-4, 2, 100};
    fluid.divergence_solve = {1e-3, 1, 100};
    return fluid;
}

// A closed tank, filled to `depth`.
inline Scene tank(double length, double width, double depth, double spacing) {
    Scene scene;
    scene.channel->x = {0, length};
    scene.channel->z = {0, width};
    scene.channel->flow = Flow::closed;
    scene.channel->water_blocks = {{{0, length}, {0, width}, depth}};
    scene.fluid = fluid_of(spacing, 20000);
    return scene;
}

// A channel with an emitter, initially dry, narrow and short enough for a unit test.
inline Scene emitter_channel(double velocity, double gravity, int capacity) {
    Scene scene;
    scene.world->gravity = gravity;
    scene.channel->x = {0, 10};
    scene.channel->z = {0, 4};
    scene.channel->flow = Flow::emitter;
    scene.channel->depth = 1;
    scene.channel->velocity = velocity;
    scene.fluid = fluid_of(0.4642, capacity);
    return scene;
}

// A tank on a site; its walls are the sides of a courtyard of a house, so that they have any angle.
struct SiteTank {
    double length = 1.2, width = 1.2;
    double turned = 0;   // degrees in plan
    double corner = 90;  // degrees between its sides
    double side = 4;     // of the world, m

    // Converts a position of the tank, from its middle, to the map.
    [[nodiscard]] MapPoint at(double x, double z) const {
        const double a = turned * std::numbers::pi / 180, lean = z / std::tan(corner * std::numbers::pi / 180);
        return {side / 2 + std::cos(a) * (x + lean) - std::sin(a) * z,
                side / 2 + std::sin(a) * (x + lean) + std::cos(a) * z};
    }
    [[nodiscard]] MapLine box(double x0, double z0, double x1, double z1) const {
        return {at(x0, z0), at(x1, z0), at(x1, z1), at(x0, z1)};
    }
};

inline House house_of(std::vector<MapLine> rings) {
    House house;
    house.polygon.rings = std::move(rings);
    return house;
}

// The tank with water up to `level` over level ground at 0.
inline Scene site_scene(const SiteTank& tank, double level, double spacing) {
    Scene scene;
    scene.world->length = scene.world->width = tank.side;
    scene.channel->x = scene.channel->z = {0, tank.side};
    scene.channel->flow = Flow::closed;
    scene.channel->initial_river = InitialRiver::dry;
    scene.fluid = fluid_of(spacing, 30000);
    Site site;
    const double l = tank.length / 2, w = tank.width / 2, far = tank.side + 1;
    site.houses = {house_of({{{-1, -1}, {far, -1}, {far, far}, {-1, far}}, tank.box(-l, -w, l, w)})};
    if (level > 0) site.water = {{{}, level}};
    scene.site = site;
    return scene;
}

inline SiteSolids solids_of(const Scene& scene) {
    return {site_shape(scene), static_cast<float>(support_radius_of(scene.fluid)),
            static_cast<float>(scene.fluid->particle_spacing)};
}

// Calls body(watcher, j, view, its turned view or null, share of 65535) for each visible neighbour, in the order of the
// lists. Without a visibility test these are all near particles. SolidsOf: Solids or SiteSolids.
template <typename SolidsOf, typename Body>
void for_each_seen(const CellGrid& grid, const SolidsOf& solids, const Particles& p, float h, Body&& body) {
    NeighbourLists lists(p.capacity());
    find_neighbours(grid, solids, p, h, lists);
    const std::uint16_t* next = nullptr;  // share
    for (std::size_t i = 0; i < p.count; i += lists.cluster_size) {
        const NeighbourBlock& block = lists.blocks[i / block_size];
        if (i % block_size == 0) next = block.factor.data();
        const auto add = [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
            const NeighbourBlock::TurnedView* const turned = turned_view(block, view);
            for (std::size_t k = first; k < last; ++k) {
                for (std::size_t l = i; l < i + lists.cluster_size; ++l) {
                    const std::size_t j = block.j[k];
                    const Vec3 at = view.map({p.x[l], p.y[l], p.z[l]});
                    const float x = at[0] - p.x[j], y = at[1] - p.y[j], z = at[2] - p.z[j];
                    const bool sees = view.by_sight || turned != nullptr
                                          ? (lanes_of_entry(block, k) >> (l - i) & 1U) != 0
                                          : x * x + y * y + z * z < h * h;
                    if (sees) body(l, block.j[k], view, turned, view.in_part ? *next++ : 65535U);
                }
            }
        };
        for_each_segment(block, i % block_size / lists.cluster_size, add);
    }
}

}  // namespace wade::fluid::test
