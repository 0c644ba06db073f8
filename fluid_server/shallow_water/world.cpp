#include "fluid_server/shallow_water/world.hpp"

#include <cmath>

#include "fluid_server/particles/filling.hpp"

namespace wade::fluid::shallow_water {

namespace {

// A cell is dry below this share of the deepest water: a film without velocity.
constexpr double dry_share = 1e-5;

// `step`: from a cell to the one above the face.
Walls find_walls(const Grid& grid, const RowMemory& obstacle, std::size_t step) {
    Walls walls;
    if (obstacle.empty()) return walls;
    walls.side.assign(grid.stored(), 0);
    walls.rows.assign(grid.stored() / grid.stride, 0);
    for (std::size_t c = step; c < grid.stored(); ++c) {
        walls.side[c] = obstacle[c] - obstacle[c - step];
        if (walls.side[c] != 0) walls.rows[c / grid.stride] = 1;
    }
    return walls;
}

// Depth, surface and velocity of n cells; the velocity is 0 up to the depth `dry`.
void find_primitive(const double* h, const double* qx, const double* qz, const double* bed, std::size_t n, double dry,
                    const CellRow& primitive) {
    double *const depth = primitive.h, *const eta = primitive.eta, *const u = primitive.normal,
                  *const v = primitive.along;
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) {
        const bool wet = h[i] > dry;
        const double inverse = 1 / (wet ? h[i] : 1.0);
        depth[i] = h[i];
        eta[i] = h[i] + bed[i];
        u[i] = wet ? qx[i] * inverse : 0.0;
        v[i] = wet ? qz[i] * inverse : 0.0;
    }
}

}  // namespace

ShallowWater::ShallowWater(const Scene& its_scene)
    : scene(its_scene),
      grid(make_grid(scene)),
      bed(make_bed(scene, grid)),
      water(initial_water(scene, grid, bed)),
      primitive(grid, bed),
      stage(grid),
      stage_primitive(grid, bed),
      walls_x(find_walls(grid, bed.obstacle, 1)),
      walls_z(find_walls(grid, bed.obstacle, grid.stride)),
      row_fastest(grid.nz, 0),
      row_least(grid.nz, 0),
      row_volume(grid.nz, 0),
      row_momentum(grid.nz, 0),
      row_inflow(grid.nz, 0),
      row_outflow(grid.nz, 0) {
    const double tilt = std::atan(scene.channel.slope);
    constants.gravity = scene.world.gravity * std::cos(tilt);
    constants.dry = dry_share * deepest_water(scene);
    acceleration = -scene.world.gravity * std::sin(tilt);
    update_primitive(*this);
}

void watch_faces(ShallowWater& world, const std::vector<std::size_t>& faces) {
    world.watched.clear();
    for (const std::size_t face : faces) {
        WatchedFace& watched = world.watched.emplace_back();
        watched.face = face;
        watched.row_mass.assign(world.grid.nz, 0);
        watched.row_momentum.assign(world.grid.nz, 0);
    }
}

void update_primitive(ShallowWater& world) {
    const Water& water = world.water;
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t c = world.grid.row(static_cast<std::ptrdiff_t>(k));
            Primitive& p = world.primitive;
            double* const eta = p.eta.empty() ? p.h.data() : p.eta.data();
            find_primitive(water.h.data() + c, water.qx.data() + c, water.qz.data() + c, world.bed.height.data() + c,
                           world.grid.nx, world.constants.dry,
                           {p.h.data() + c, eta + c, p.u.data() + c, p.v.data() + c});
        }
    });
    fill_ghosts(world.primitive, world.grid, world.scene.channel, world.constants.gravity);
}

}  // namespace wade::fluid::shallow_water
