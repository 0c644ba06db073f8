#include "fluid_server/particles/site/site_filling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"

namespace wade::fluid {

namespace {

// A cell of the lattice that a wall or the edge of the water cuts is asked at so many points along x and along z how much of it is
// water. They have no measure in common with walls along the diagonal.
constexpr int points_along = 10;
constexpr double first_point_x = 0.37, first_point_z = 0.61;

// A column no nearer to a wall than this, in spacings, is filled. With less, rows of a lattice along a wall would begin so near to
// their own images that relaxing them fails; with half a spacing an oblique wall would cost an eighth of the water of a narrow
// tank, which the other columns then hold.
constexpr double wall_clearance = 0.2;

// Depth that the water at t = 0 would have if there were no walls, m; 0 where there is none.
double depth_without_walls(const Scene& scene, const SiteSolids& solids, const MapPoint& p) {
    const Site& site = *scene.site;
    double depth = 0;
    const auto x = static_cast<float>(p.x), z = static_cast<float>(p.z);
    const double ground = static_cast<double>(solids.ground().at(x, z).height(x, z));
    for (const StandingWater& water : site.water) {
        if (water.polygon.rings.empty() || contains(water.polygon, p)) depth = std::max(depth, water.level - ground);
    }
    if (site.water_depth) depth = std::max(depth, height_in(*site.water_depth, p));
    return depth;
}

// A square of cells of the lattice. Without walls near all of it is water, or none.
enum class Tile { solid, water, walls };
constexpr int tile_cells = 16;

// Depth of the water at t = 0, m; 0 where there is none.
double depth_at(const Scene& scene, const SiteSolids& solids, Tile tile, const MapPoint& p) {
    const double depth = depth_without_walls(scene, solids, p);
    if (depth <= 0 || tile == Tile::water) return depth;
    return solids.is_water({static_cast<float>(p.x), 0, static_cast<float>(p.z)}) ? depth : 0;
}

Tile tile_at(const SiteSolids& solids, double x, double z, double side, std::vector<std::uint32_t>& walls) {
    const auto f = [](double v) { return static_cast<float>(v); };
    solids.find_walls({{f(x), 0, f(z)}, {f(x + side), 0, f(z + side)}}, walls);
    if (!walls.empty()) return Tile::walls;
    return solids.is_water({f(x + side / 2), 0, f(z + side / 2)}) ? Tile::water : Tile::solid;
}

bool is_clear(const SiteSolids& solids, const MapPoint& p, double clear) {
    const auto x = static_cast<float>(p.x), z = static_cast<float>(p.z);
    const Vec3 above{x, solids.ground().at(x, z).height(x, z) + static_cast<float>(2 * clear), z};
    Vec3 moved = above;
    solids.keep_away(moved, static_cast<float>(clear));
    return moved[0] == x && moved[2] == z;
}

// Of the water in a cell of the lattice, m3.
double volume_of(const Scene& scene, const SiteSolids& solids, Tile tile, const MapPoint& middle) {
    const double d = scene.fluid->particle_spacing;
    const auto at = [&](double a, double b) {
        return depth_at(scene, solids, tile, {middle.x + a * d, middle.z + b * d});
    };
    const bool is_cut = tile == Tile::walls && !is_clear(solids, middle, (0.5 * std::sqrt(2.0) + wall_clearance) * d);
    const auto [least, most] = std::minmax({at(-0.5, -0.5), at(0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0, 0)});
    if (!is_cut && (least > 0) == (most > 0)) return d * d * at(0, 0);
    double sum = 0;
    for (int i = 0; i < points_along; ++i) {
        for (int k = 0; k < points_along; ++k)
            sum += at((i + first_point_x) / points_along - 0.5, (k + first_point_z) / points_along - 0.5);
    }
    return d * d * sum / (points_along * points_along);
}

struct Column {
    MapPoint middle;
    double depth = 0;  // m
};
struct Columns {
    std::vector<Column> filled;
    double water = 0, under_middles = 0;  // m3
};

// The cells of the lattice of the world, row by row.
Columns columns_of(const Scene& scene, const SiteSolids& solids) {
    Columns columns;
    if (scene.site->water.empty() && !scene.site->water_depth) return columns;
    const double d = scene.fluid->particle_spacing;
    const Interval &x = solids.shape().x, &z = solids.shape().z;
    const auto nx = static_cast<int>(std::ceil(x.length() / d - 1e-6)),
               nz = static_cast<int>(std::ceil(z.length() / d - 1e-6));
    std::vector<Tile> tiles(static_cast<std::size_t>(nx / tile_cells + 1));
    std::vector<std::uint32_t> walls;
    for (int k = 0; k < nz; ++k) {
        for (std::size_t t = 0; k % tile_cells == 0 && t < tiles.size(); ++t) {
            const double side = tile_cells * d;
            tiles[t] = tile_at(solids, x.lo + static_cast<double>(t) * side, z.lo + k * d, side, walls);
        }
        for (int i = 0; i < nx; ++i) {
            const Tile tile = tiles[static_cast<std::size_t>(i / tile_cells)];
            if (tile == Tile::solid) continue;
            const MapPoint middle{x.lo + (i + 0.5) * d, z.lo + (k + 0.5) * d};
            columns.water += volume_of(scene, solids, tile, middle);
            if (middle.x >= x.hi || middle.z >= z.hi) continue;
            if (tile == Tile::walls && !is_clear(solids, middle, wall_clearance * d)) continue;
            const double depth = depth_at(scene, solids, tile, middle);
            if (depth <= 0) continue;
            columns.filled.push_back({middle, depth});
            columns.under_middles += depth * d * d;
        }
    }
    return columns;
}

std::size_t particles_in(double volume, double spacing) {
    return static_cast<std::size_t>(std::lround(volume / (spacing * spacing * spacing)));
}

}  // namespace

void fill_site(Particles& particles, const Scene& scene, const SiteSolids& solids) {
    const double d = scene.fluid->particle_spacing;
    const Columns columns = columns_of(scene, solids);
    if (columns.filled.empty()) return;
    const double wanted = static_cast<double>(particles_in(columns.water, d)) / (columns.under_middles / (d * d * d));
    double due = 0;
    std::size_t filled = 0;
    for (const Column& column : columns.filled) {
        due += wanted * column.depth / d;
        const auto x = static_cast<float>(column.middle.x), z = static_cast<float>(column.middle.z);
        const double ground = static_cast<double>(solids.ground().at(x, z).height(x, z));
        for (double y = 0.5 * d; static_cast<double>(filled) + 0.5 < due; y += d, ++filled) {
            const double pressure = scene.world->gravity * std::max(0.0, column.depth - y);
            particles.add({x, static_cast<float>(ground + y), z}, {0, 0, 0}, Kind::fluid, static_cast<float>(pressure));
        }
    }
}

}  // namespace wade::fluid
