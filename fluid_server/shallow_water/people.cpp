#include "fluid_server/shallow_water/people.hpp"

#include <algorithm>
#include <cmath>

#include "configs/numbers/kernel_area.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"

namespace wade::fluid::shallow_water {

namespace {

// Returns the mean of the cone over a cell with its centre (dx, dz) from the person, m.
double mean_cone(const Grid& grid, double dx, double dz, double spread) {
    const double half_x = 0.5 * grid.dx, half_z = 0.5 * grid.dz;
    return spread * spread / grid.cell_area() *
           cone_over({(dx - half_x) / spread, (dx + half_x) / spread, (dz - half_z) / spread, (dz + half_z) / spread});
}

// Calls body(cell, distance of its centre) for the cells along one axis that reach into [place - reach, place + reach].
template <typename Body>
void for_each_along(const Interval& extent, std::size_t n, double size, bool periodic, double place, double reach,
                    Body&& body) {
    const auto first = static_cast<std::ptrdiff_t>(std::floor((place - reach - extent.lo) / size));
    const auto last = static_cast<std::ptrdiff_t>(std::floor((place + reach - extent.lo) / size));
    const auto cells = static_cast<std::ptrdiff_t>(n);
    for (std::ptrdiff_t i = first; i <= last; ++i) {
        if (!periodic && (i < 0 || i >= cells)) continue;
        const double centre = extent.lo + (static_cast<double>(i) + 0.5) * size;
        body(static_cast<std::size_t>((i % cells + cells) % cells), centre - place);
    }
}

}  // namespace

void find_near(const ShallowWater& world, const Push& push, std::size_t begin, std::size_t end, NearCells& near) {
    near.place.clear();
    near.weight.clear();
    const Grid& grid = world.grid;
    const Channel& channel = world.scene.channel;
    const bool periodic_x = channel.flow == Flow::recirculating || channel.flow == Flow::periodic;
    const bool periodic_z = channel.sides == Sides::periodic;
    for_each_along(grid.z, grid.nz, grid.dz, periodic_z, push.place[1], push.spread, [&](std::size_t k, double dz) {
        const std::size_t row = grid.row(static_cast<std::ptrdiff_t>(k));
        for_each_along(grid.x, grid.nx, grid.dx, periodic_x, push.place[0], push.spread, [&](std::size_t i, double dx) {
            const std::size_t c = row + i;
            if ((i >= begin && i < end) || world.water.h[c] < world.constants.dry) return;
            if (!world.bed.obstacle.empty() && world.bed.obstacle[c] > 0) return;
            const double w = mean_cone(grid, dx, dz, push.spread);
            if (w <= 0) return;
            near.place.push_back(c);
            near.weight.push_back(w);
        });
    });
}

void add_cells(const ShallowWater& world, const NearCells& near, NearWater& sum) {
    const double mass_of_depth = world.scene.fluid->rest_density * world.grid.cell_area();
    for (std::size_t n = 0; n < near.place.size(); ++n) {
        const std::size_t c = near.place[n];
        const double h = world.water.h[c];
        sum.add(near.weight[n], mass_of_depth * world.openings.share_of(c) * h, world.water.qx[c] / h,
                world.water.qz[c] / h);
    }
}

GroundVector take_from(ShallowWater& world, const NearCells& near, const GroundVector& impulse, double weight) {
    const double mass_of_depth = world.scene.fluid->rest_density * world.grid.cell_area();
    GroundVector lost{};
    if (impulse[0] == 0 && impulse[1] == 0) return lost;
    for (std::size_t n = 0; n < near.place.size(); ++n) {
        const std::size_t c = near.place[n];
        const double part = near.weight[n] * world.water.h[c] / weight;
        const double qx = world.water.qx[c], qz = world.water.qz[c];
        world.water.qx[c] -= part * impulse[0];
        world.water.qz[c] -= part * impulse[1];
        const double mass = mass_of_depth * world.openings.share_of(c);
        lost[0] += mass * (qx - world.water.qx[c]);
        lost[1] += mass * (qz - world.water.qz[c]);
    }
    return lost;
}

void push_cells(ShallowWater& world, PeopleInWater& people, double share) {
    NearCells near;
    for (const Push& push : people.pushes) {
        find_near(world, push, 0, 0, near);
        NearWater water;
        add_cells(world, near, water);
        const GroundVector impulse = impulse_now(push, share, water, people.account);
        const GroundVector lost = take_from(world, near, impulse, water.weight);
        people.account.taken[0] += lost[0];
        people.account.taken[1] += lost[1];
    }
}

}  // namespace wade::fluid::shallow_water
