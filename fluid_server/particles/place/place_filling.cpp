#include "fluid_server/particles/place/place_filling.hpp"

#include <algorithm>
#include <cmath>

namespace wade::fluid {

namespace {

// A cell of the lattice that a wall or the edge of the water cuts is asked at so many points along x and along z how much of it is
// water. They have no measure in common with walls along the diagonal.
constexpr int points_along = 10;
constexpr double first_point_x = 0.37, first_point_z = 0.61;

// A column no nearer to a wall than this, in spacings, is filled. With less, rows of a lattice along a wall would begin so near to
// their own images that relaxing them fails; with half a spacing an oblique wall would cost an eighth of the water of a narrow
// tank, which the other columns then hold.
constexpr double clearance = 0.2;

// Depth of the water at t = 0, m; 0 where there is none.
double depth_at(const Scene& scene, const PlaceSolids& solids, const MapPoint& p) {
    const Place& place = *scene.place;
    double depth = 0;
    const Vec3 x{static_cast<float>(p.x), 0, static_cast<float>(p.z)};
    const double ground = static_cast<double>(solids.ground().at(x[0], x[2]).height(x[0], x[2]));
    for (const StandingWater& water : place.water) {
        if (water.polygon.rings.empty() || contains(water.polygon, p)) depth = std::max(depth, water.level - ground);
    }
    if (place.water_depth) depth = std::max(depth, height_in(*place.water_depth, p));
    return depth > 0 && solids.is_water(x) ? depth : 0;
}

bool is_clear(const PlaceSolids& solids, const MapPoint& p, double clear) {
    const auto x = static_cast<float>(p.x), z = static_cast<float>(p.z);
    const Vec3 above{x, solids.ground().at(x, z).height(x, z) + static_cast<float>(2 * clear), z};
    Vec3 moved = above;
    solids.keep_away(moved, static_cast<float>(clear));
    return moved[0] == x && moved[2] == z;
}

// Of the water in a cell of the lattice, m3.
double volume_of(const Scene& scene, const PlaceSolids& solids, const MapPoint& middle, bool is_cut) {
    const double d = scene.fluid.particle_spacing;
    const auto at = [&](double a, double b) { return depth_at(scene, solids, {middle.x + a * d, middle.z + b * d}); };
    const auto [least, most] = std::minmax({at(-0.5, -0.5), at(0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0, 0)});
    if (!is_cut && (least > 0) == (most > 0)) return d * d * at(0, 0);
    double sum = 0;
    for (int n = 0; n < points_along * points_along; ++n) {
        sum += at((n % points_along + first_point_x) / points_along - 0.5,
                  (n / points_along + first_point_z) / points_along - 0.5);
    }
    return d * d * sum / (points_along * points_along);
}

// Calls body(middle, depth there, volume of the cell) for the cells of the lattice.
template <typename Body>
void for_each_column(const Scene& scene, const PlaceSolids& solids, Body&& body) {
    const double d = scene.fluid.particle_spacing;
    const Interval &x = solids.shape().x, &z = solids.shape().z;
    const auto nx = static_cast<int>(std::ceil(x.length() / d - 1e-6)),
               nz = static_cast<int>(std::ceil(z.length() / d - 1e-6));
    for (int k = 0; k < nz; ++k) {
        for (int i = 0; i < nx; ++i) {
            const MapPoint middle{x.lo + (i + 0.5) * d, z.lo + (k + 0.5) * d};
            const bool is_taken = middle.x < x.hi && middle.z < z.hi && is_clear(solids, middle, clearance * d);
            const bool is_cut = !is_clear(solids, middle, (0.5 * std::sqrt(2.0) + clearance) * d);
            body(middle, is_taken ? depth_at(scene, solids, middle) : 0, volume_of(scene, solids, middle, is_cut));
        }
    }
}

struct Volumes {
    double water = 0, under_middles = 0;  // m3
};
Volumes volumes_of(const Scene& scene, const PlaceSolids& solids) {
    Volumes volumes;
    const double area = scene.fluid.particle_spacing * scene.fluid.particle_spacing;
    for_each_column(scene, solids, [&](const MapPoint&, double depth, double volume) {
        volumes.water += volume;
        volumes.under_middles += depth * area;
    });
    return volumes;
}

std::size_t particles_in(double volume, double spacing) {
    return static_cast<std::size_t>(std::lround(volume / (spacing * spacing * spacing)));
}

}  // namespace

std::size_t particles_of_place(const Scene& scene, const PlaceSolids& solids) {
    return particles_in(volumes_of(scene, solids).water, scene.fluid.particle_spacing);
}

void fill_place(Particles& particles, const Scene& scene, const PlaceSolids& solids) {
    const double d = scene.fluid.particle_spacing;
    const Volumes volumes = volumes_of(scene, solids);
    if (!(volumes.under_middles > 0)) return;
    const double wanted = static_cast<double>(particles_in(volumes.water, d)) / (volumes.under_middles / (d * d * d));
    double due = 0;
    std::size_t filled = 0;
    for_each_column(scene, solids, [&](const MapPoint& p, double depth, double) {
        due += wanted * depth / d;
        const auto x = static_cast<float>(p.x), z = static_cast<float>(p.z);
        const double ground = static_cast<double>(solids.ground().at(x, z).height(x, z));
        for (double y = 0.5 * d; static_cast<double>(filled) + 0.5 < due; y += d, ++filled) {
            const double pressure = scene.world.gravity * std::max(0.0, depth - y);
            particles.add({x, static_cast<float>(ground + y), z}, {0, 0, 0}, Kind::fluid, static_cast<float>(pressure));
        }
    });
}

}  // namespace wade::fluid
