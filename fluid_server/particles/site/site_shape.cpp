#include "fluid_server/particles/site/site_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "configs/numbers/portable.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"

namespace wade::fluid {

namespace {

// Of a ground cell, in particle spacings: between two and four water over bumps is as quiet as over smooth ground.
constexpr double ground_cell = 3;

// What a height may be off a plane, m: rounding.
constexpr double off_plane = 1e-5;

double twice_area(const MapPoint& a, const MapPoint& b, const MapPoint& c) {
    return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
}

// The mean of what a raster says in a square, or what it says at its middle where its cells are longer than that.
double height_near(const Raster& raster, const MapPoint& p, double side) {
    const auto cells = [&](double lo, double hi, double origin, std::size_t n) {
        const double first = std::ceil((lo - origin) / raster.cell - 0.5),
                     last = std::ceil((hi - origin) / raster.cell - 0.5);
        const auto most = static_cast<double>(n);
        return std::array<std::size_t, 2>{static_cast<std::size_t>(std::clamp(first, 0.0, most)),
                                          static_cast<std::size_t>(std::clamp(last, 0.0, most))};
    };
    const auto columns = cells(p.x - side / 2, p.x + side / 2, raster.x, raster.columns);
    const auto rows = cells(p.z - side / 2, p.z + side / 2, raster.z, raster.rows);
    double sum = 0, count = 0;
    for (std::size_t row = rows[0]; row < rows[1]; ++row) {
        for (std::size_t column = columns[0]; column < columns[1]; ++column) {
            const double v = raster.at(column, row);
            if (std::isnan(v)) continue;
            sum += v;
            count += 1;
        }
    }
    return count > 1 ? sum / count : height_in(raster, p);
}

GroundGrid ground_grid(const Ground& ground, const World& world, double spacing) {
    GroundGrid grid;
    grid.cell = ground_cell * spacing;
    if (ground.raster) grid.cell = std::max(grid.cell, 2 * ground.raster->cell);
    const bool is_one_plane = !ground.raster && ground.points.empty();
    if (is_one_plane) grid.cell = std::max({grid.cell, world.length, world.width});
    grid.x = grid.z = -grid.cell;
    grid.nx = static_cast<std::size_t>(std::ceil(world.length / grid.cell)) + 2;
    grid.nz = static_cast<std::size_t>(std::ceil(world.width / grid.cell)) + 2;
    const Triangles surface(ground.raster ? std::vector<std::array<double, 3>>{} : ground.points);
    std::vector<double> heights;
    for (std::size_t k = 0; k <= grid.nz; ++k) {
        for (std::size_t i = 0; i <= grid.nx; ++i) {
            const MapPoint p{grid.x + static_cast<double>(i) * grid.cell, grid.z + static_cast<double>(k) * grid.cell};
            heights.push_back(ground.raster            ? height_near(*ground.raster, p, grid.cell)
                              : !ground.points.empty() ? surface.height_at(p)
                                                       : ground.level + ground.slope_x * p.x + ground.slope_z * p.z);
        }
    }
    const double along_x = (heights[grid.nx] - heights[0]) / static_cast<double>(grid.nx);
    const double along_z = (heights[grid.nz * (grid.nx + 1)] - heights[0]) / static_cast<double>(grid.nz);
    for (std::size_t n = 0; n < heights.size(); ++n) {
        const std::size_t i = n % (grid.nx + 1), k = n / (grid.nx + 1);
        const double on_plane = heights[0] + static_cast<double>(i) * along_x + static_cast<double>(k) * along_z;
        grid.is_plane = grid.is_plane && std::abs(heights[n] - on_plane) <= off_plane;
    }
    grid.height.assign(heights.begin(), heights.end());
    return grid;
}

// Whether a free outlet is at each point of a side of the world, from one corner to the other, that is in no house.
bool is_open(const Site& site, const SiteShape& shape, const MapPoint& from, const MapPoint& to, double reach) {
    const double length = length_of(to.x - from.x, to.z - from.z), steps = std::max(1.0, std::ceil(length / reach));
    bool any = false;
    for (double s = 0.5; s < steps; ++s) {
        const MapPoint p{from.x + s / steps * (to.x - from.x), from.z + s / steps * (to.z - from.z)};
        if (in_house(shape, p)) continue;
        const bool leaves = std::any_of(site.outlets.begin(), site.outlets.end(), [&](const Outlet& outlet) {
            return outlet.kind == OutletKind::free && is_at(outlet, p, reach);
        });
        if (!leaves) return false;
        any = true;
    }
    return any;
}

}  // namespace

bool Triangles::in_circle(const Corners& t, const MapPoint& p) const {
    const auto lift = [&](std::size_t n) {
        const double x = place_[n].x - p.x, z = place_[n].z - p.z;
        return std::array<double, 3>{x, z, x * x + z * z};
    };
    const auto a = lift(t[0]), b = lift(t[1]), c = lift(t[2]);
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) >
           0;
}

Triangles::Triangles(const std::vector<std::array<double, 3>>& points) {
    if (points.empty()) return;
    MapPoint lo{points[0][0], points[0][2]}, hi = lo;
    for (const auto& p : points) {
        lo = {std::min(lo.x, p[0]), std::min(lo.z, p[2])};
        hi = {std::max(hi.x, p[0]), std::max(hi.z, p[2])};
    }
    const double size = 1e4 * std::max({hi.x - lo.x, hi.z - lo.z, 1.0}), x = 0.5 * (lo.x + hi.x),
                 z = 0.5 * (lo.z + hi.z);
    place_ = {{x - 2 * size, z - size}, {x + 2 * size, z - size}, {x, z + 2 * size}};
    height_ = {0, 0, 0};
    triangles_ = {{0, 1, 2}};
    for (const auto& point : points) {
        const MapPoint p{point[0], point[2]};
        std::vector<std::pair<std::size_t, std::size_t>> edges;  // of the triangles that go
        std::vector<Corners> kept;
        for (const Corners& t : triangles_) {
            if (!in_circle(t, p)) {
                kept.push_back(t);
                continue;
            }
            for (std::size_t n = 0; n < 3; ++n) edges.emplace_back(t[n], t[(n + 1) % 3]);
        }
        if (edges.empty()) continue;  // the place of another point
        const std::size_t number = place_.size();
        place_.push_back(p);
        height_.push_back(point[1]);
        for (const auto& [a, b] : edges) {
            if (std::find(edges.begin(), edges.end(), std::pair{b, a}) == edges.end()) kept.push_back({a, b, number});
        }
        triangles_ = std::move(kept);
    }
    std::erase_if(triangles_, [](const Corners& t) { return std::min({t[0], t[1], t[2]}) < 3; });
}

double Triangles::height_at(const MapPoint& p) const {
    constexpr double slack = -1e-9;
    for (const Corners& t : triangles_) {
        const MapPoint &a = place_[t[0]], &b = place_[t[1]], &c = place_[t[2]];
        const double all = twice_area(a, b, c);
        if (all <= 0) continue;
        const double at_a = twice_area(p, b, c) / all, at_b = twice_area(a, p, c) / all, at_c = 1 - at_a - at_b;
        if (at_a < slack || at_b < slack || at_c < slack) continue;
        return at_a * height_[t[0]] + at_b * height_[t[1]] + at_c * height_[t[2]];
    }
    double nearest = std::numeric_limits<double>::infinity(), height = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t n = 3; n < place_.size(); ++n) {
        const double distance = length_of(place_[n].x - p.x, place_[n].z - p.z);
        if (distance >= nearest) continue;
        nearest = distance, height = height_[n];
    }
    return height;
}

double GroundGrid::height_at(const MapPoint& p) const {
    const double u = std::clamp((p.x - x) / cell, 0.0, static_cast<double>(nx));
    const double v = std::clamp((p.z - z) / cell, 0.0, static_cast<double>(nz));
    const std::size_t i = std::min(static_cast<std::size_t>(u), nx - 1),
                      k = std::min(static_cast<std::size_t>(v), nz - 1);
    const double a = u - static_cast<double>(i), b = v - static_cast<double>(k);
    const double corner = at_node(i, k), opposite = at_node(i + 1, k + 1);
    if (b > a) return corner + b * (at_node(i, k + 1) - corner) + a * (opposite - at_node(i, k + 1));
    return corner + a * (at_node(i + 1, k) - corner) + b * (opposite - at_node(i + 1, k));
}

double GroundGrid::lowest() const {
    return static_cast<double>(*std::min_element(height.begin(), height.end()));
}

bool in_house(const SiteShape& shape, const MapPoint& p) {
    return std::any_of(shape.houses.begin(), shape.houses.end(),
                       [&](const MapPolygon& house) { return contains(house, p); });
}

SiteShape site_shape(const Scene& scene) {
    const Site& site = *scene.site;
    SiteShape shape;
    shape.x = {0, scene.world->length};
    shape.z = {0, scene.world->width};
    for (const House& house : site.houses) shape.houses.push_back(house.polygon);
    shape.gates = site.barriers;
    shape.ground = ground_grid(site.ground, scene.world, scene.fluid->particle_spacing);
    const double reach = 2 * scene.fluid->particle_spacing;
    const MapPoint a{shape.x.lo, shape.z.lo}, b{shape.x.hi, shape.z.lo}, c{shape.x.lo, shape.z.hi},
        d{shape.x.hi, shape.z.hi};
    shape.open[SiteShape::x_lo] = is_open(site, shape, a, c, reach);
    shape.open[SiteShape::x_hi] = is_open(site, shape, b, d, reach);
    shape.open[SiteShape::z_lo] = is_open(site, shape, a, b, reach);
    shape.open[SiteShape::z_hi] = is_open(site, shape, c, d, reach);
    return shape;
}

}  // namespace wade::fluid
