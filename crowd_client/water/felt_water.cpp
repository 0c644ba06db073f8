#include "crowd_client/water/felt_water.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/water/near_water.hpp"

namespace wade::crowd {
namespace {

constexpr double least_spread = 0.5, spread_in_spacings = 1.5;
constexpr double largest_spread = GroundGrid::cell_size;  // reach of WaterBins around a position

// The integral of 1 - sqrt(x^2 + z^2) over x from 0 to `to`, for x^2 + z^2 <= 1:
// to - (to r + z^2 asinh(to / |z|)) / 2, r = sqrt(to^2 + z^2).
double cone_along(double to, double z) {
    const double across = std::abs(z), r = std::sqrt(to * to + z * z);
    const double curved = across > 0 ? z * z * std::asinh(to / across) : 0;
    return to - 0.5 * (to * r + curved);
}

// Solid ground near a position, in units of R around it.
struct Solids {
    Interval x, z;  // of the channel
    std::vector<Obstacle> boxes;
    std::vector<std::vector<HouseSide>> houses;  // `from` and `to` alone
};

// Finds the parts of the line z in a house: between each two sides that it crosses.
void cover(const std::vector<HouseSide>& house, double z, std::vector<Interval>& covered) {
    std::vector<double> crossings;
    for (const HouseSide& side : house) {
        if ((side.from.y() > z) == (side.to.y() > z)) continue;
        const double share = (z - side.from.y()) / (side.to.y() - side.from.y());
        crossings.push_back(side.from.x() + share * (side.to.x() - side.from.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 1; k < crossings.size(); k += 2) covered.push_back({crossings[k - 1], crossings[k]});
}

// Returns the integral of the cone of radius 1 along the line z, over ground that is not solid.
double open_line(const Solids& solids, double z, std::vector<Interval>& covered) {
    const double half_chord = std::sqrt(std::max(0.0, 1 - z * z));
    const double lo = std::max(-half_chord, solids.x.lo), hi = std::min(half_chord, solids.x.hi);
    if (!(lo < hi)) return 0;
    covered.clear();
    for (const Obstacle& box : solids.boxes) {
        if (box.z.lo < z && z < box.z.hi) covered.push_back(box.x);
    }
    for (const std::vector<HouseSide>& house : solids.houses) cover(house, z, covered);
    std::sort(covered.begin(), covered.end(), [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
    double sum = 0, at = lo;
    for (const Interval& box : covered) {
        const double from = std::min(box.lo, hi);
        if (from > at) sum += cone_along(from, z) - cone_along(at, z);
        at = std::max(at, std::min(box.hi, hi));
    }
    return hi > at ? sum + cone_along(hi, z) - cone_along(at, z) : sum;
}

// Integrates over all lines with Gauss's rule of four points between the z values of all edges. These include the
// middle of the cone, where it has a kink.
double open_cone(const Solids& solids) {
    constexpr std::array<double, 2> node{0.339981043584856, 0.861136311594053};
    constexpr std::array<double, 2> weight{0.652145154862546, 0.347854845137454};
    const double lo = std::max(-1.0, solids.z.lo), hi = std::min(1.0, solids.z.hi);
    if (!(lo < hi)) return 0;
    std::vector<double> edges{lo, hi, std::clamp(0.0, lo, hi)};
    for (const Obstacle& box : solids.boxes) {
        for (const double z : {box.z.lo, box.z.hi}) edges.push_back(std::clamp(z, lo, hi));
    }
    for (const std::vector<HouseSide>& house : solids.houses) {
        for (const HouseSide& side : house) edges.push_back(std::clamp(side.from.y(), lo, hi));
    }
    std::sort(edges.begin(), edges.end());
    std::vector<Interval> covered;
    double sum = 0;
    for (std::size_t i = 1; i < edges.size(); ++i) {
        const double middle = 0.5 * (edges[i - 1] + edges[i]), half = 0.5 * (edges[i] - edges[i - 1]);
        if (!(half > 0)) continue;
        for (std::size_t j = 0; j < node.size(); ++j) {
            sum += half * weight[j] * open_line(solids, middle - half * node[j], covered);
            sum += half * weight[j] * open_line(solids, middle + half * node[j], covered);
        }
    }
    return sum;
}

Interval seen_from(const Interval& interval, double place, double unit) {
    return {(interval.lo - place) / unit, (interval.hi - place) / unit};
}

Interval within(double place, double reach) {
    return {place - reach, place + reach};
}

bool has_boxes_near(const Feeling& feeling, const Vector2d& place) {
    return any_near(feeling.boxes, within(place.x(), feeling.spread), within(place.y(), feeling.spread),
                    [](const Obstacle&) { return true; });
}

bool has_sides_near(const Feeling& feeling, const Vector2d& place) {
    return any_side_near(feeling.houses, within(place.x(), feeling.spread), within(place.y(), feeling.spread),
                         [](const HouseSide&) { return true; });
}

// Returns the houses near a position, in units of the cone around it.
std::vector<std::vector<HouseSide>> houses_seen_from(const Feeling& feeling, const Vector2d& place) {
    std::vector<std::vector<HouseSide>> seen;
    const PlacedHouses& houses = feeling.houses;
    for_each_near(houses.grounds, within(place.x(), feeling.spread), within(place.y(), feeling.spread),
                  [&](const Obstacle& ground) {
                      const auto plan = static_cast<std::size_t>(&ground - houses.grounds.all.data());
                      std::vector<HouseSide>& sides = seen.emplace_back();
                      for (std::uint32_t k = houses.first_side[plan]; k < houses.first_side[plan + 1]; ++k) {
                          HouseSide side;
                          side.from = (houses.sides[k].from - place) / feeling.spread;
                          side.to = (houses.sides[k].to - place) / feeling.spread;
                          sides.push_back(side);
                      }
                  });
    return seen;
}

// Returns the solid ground near a position, and the ground between the ends of the world.
Solids solids_near(const Feeling& feeling, const Vector2d& position) {
    const double r = feeling.spread;
    Solids solids{seen_from(feeling.x, position.x(), r),
                  seen_from(feeling.z, position.y(), r),
                  {},
                  houses_seen_from(feeling, position)};
    for_each_near(feeling.boxes, within(position.x(), r), within(position.y(), r), [&](const Obstacle& box) {
        solids.boxes.push_back({seen_from(box.x, position.x(), r), seen_from(box.z, position.y(), r), box.height});
    });
    return solids;
}

bool is_over_a_box(const Feeling& feeling, double x, double z) {
    return any_near(feeling.boxes, {x, x}, {z, z}, [](const Obstacle&) { return true; });
}

double spread_of_points(const Scene& scene) {
    // With shallow water on a site each cell is a particle.
    const double spacing = scene.site && scene.fluid->model == ModelKind::shallow_water
                               ? std::min(scene.fluid->shallow_water.cell_size, largest_spread / spread_in_spacings)
                               : scene.fluid->particle_spacing;
    const double spread = std::max(least_spread, spread_in_spacings * spacing);
    if (spread > largest_spread) {
        std::ostringstream message;
        message << "/fluid/particle_spacing_m: people feel the water within 1.5 spacings, and " << spread
                << " m is too far; allowed: a spacing <= " << largest_spread / spread_in_spacings << " m";
        throw ConfigurationError(message.str());
    }
    return spread;
}

// The cone is integrated over columns, so that a body's width suffices. The particles of the hybrid model need more.
double spread_of_columns(const Scene& scene, const Vector2d& column) {
    if (scene.fluid->model != ModelKind::mixed) return least_spread;
    return std::clamp(spread_in_spacings * scene.fluid->particle_spacing, least_spread,
                      largest_spread - 0.5 * column.maxCoeff());
}

}  // namespace

Feeling make_feeling(const Scene& scene, const Vector2d& column) {
    Feeling feeling;
    feeling.spread = column.x() > 0 ? spread_of_columns(scene, column) : spread_of_points(scene);
    feeling.disc_radius = std::max(feeling.spread, column.maxCoeff());
    feeling.rest_density = scene.fluid->rest_density;
    feeling.x = scene.channel->x;
    feeling.z = scene.channel->z;
    std::vector<Obstacle> boxes = scene.site ? std::vector<Obstacle>{} : scene.obstacles;
    if (const double period = scene.world->period(); period > 0) {
        constexpr double nowhere = std::numeric_limits<double>::infinity();
        feeling.x = {-nowhere, nowhere};
        for (const Obstacle& box : scene.obstacles) {
            for (const double shift : {-period, period}) {
                boxes.push_back({{box.x.lo + shift, box.x.hi + shift}, box.z, box.height});
            }
        }
    }
    feeling.boxes = place_boxes(std::move(boxes));
    feeling.houses = houses_of(scene);
    return feeling;
}

double open_ground(const Feeling& feeling, const Vector2d& place) {
    const double r = feeling.spread;
    const Interval near_x = within(place.x(), r), near_z = within(place.y(), r);
    const bool far_from_ends = feeling.x.lo <= near_x.lo && near_x.hi <= feeling.x.hi && feeling.z.lo <= near_z.lo &&
                               near_z.hi <= feeling.z.hi;
    if (far_from_ends && !has_boxes_near(feeling, place) && !has_sides_near(feeling, place))
        return std::numbers::pi * r * r / 3;
    return r * r * open_cone(solids_near(feeling, place));
}

namespace {

// Sums over the particles near a position, w the weight of each.
struct ConeSums {
    double mass = 0, squares = 0;  // of w m and w^2 m, kg
    double momentum_x = 0, momentum_z = 0;

    void add(const WaterBins& bins, std::size_t k, double w) {
        const double weighed = w * static_cast<double>(bins.mass[k]);
        mass += weighed;
        squares += w * weighed;
        momentum_x += weighed * static_cast<double>(bins.vx[k]);
        momentum_z += weighed * static_cast<double>(bins.vz[k]);
    }
};

// Each column counts with the mean of the cone over its rectangle, taken as 0 where something solid stands.
ConeSums sum_of_columns(const Feeling& feeling, const WaterBins& bins, const Vector2d& place) {
    const double r = feeling.spread, per_area = r * r / (bins.column.x() * bins.column.y());
    std::optional<Solids> solids;
    if (has_boxes_near(feeling, place) || has_sides_near(feeling, place)) solids = solids_near(feeling, place);
    ConeSums sums;
    for_each_column_near(bins, place, r, [&](std::size_t k) {
        const Rectangle column = column_seen_from(bins, k, place, r);
        if (solids) {
            solids->x = {column.x_lo, column.x_hi};
            solids->z = {column.z_lo, column.z_hi};
        }
        const double w = per_area * (solids ? open_cone(*solids) : cone_over(column));
        if (w > 0) sums.add(bins, k, w);
    });
    return sums;
}

ConeSums sum_of_points(const Feeling& feeling, const WaterBins& bins, const Vector2d& place) {
    const bool has_boxes = has_boxes_near(feeling, place);
    const double per_spread = 1 / feeling.spread;
    ConeSums sums;
    for_each_particle_near(bins, place, feeling.spread, [&](std::size_t k) {
        const double dx = bins.x[k] - place.x(), dz = bins.z[k] - place.y();
        if (has_boxes && is_over_a_box(feeling, bins.x[k], bins.z[k])) return;
        sums.add(bins, k, 1 - std::sqrt(dx * dx + dz * dz) * per_spread);
    });
    return sums;
}

}  // namespace

FeltWater feel_water(const Feeling& feeling, const WaterBins& bins, const Vector2d& place) {
    FeltWater felt;
    felt.spread = feeling.spread;
    if (bins.x.empty() || !feeling.x.contains(place.x()) || !feeling.z.contains(place.y())) return felt;
    const ConeSums sums =
        bins.has_columns() ? sum_of_columns(feeling, bins, place) : sum_of_points(feeling, bins, place);
    const double ground = sums.mass > 0 ? open_ground(feeling, place) : 0;
    if (!(ground > 0)) return felt;
    felt.velocity = {bins.scale_x * sums.momentum_x / sums.mass, bins.scale_z * sums.momentum_z / sums.mass};
    felt.depth = sums.mass / (feeling.rest_density * ground);
    felt.weight = sums.mass;
    felt.theta = sums.squares / sums.mass;
    return felt;
}

double spin_of_water(const Feeling& feeling, const WaterBins& bins, const Vector2d& place) {
    if (bins.x.empty() || !feeling.x.contains(place.x()) || !feeling.z.contains(place.y())) return 0;
    // A gradient needs some columns in reach.
    const double radius = std::max(feeling.spread, std::min(1.5 * bins.column.maxCoeff(), largest_spread));
    // Sums of w m, w m r, w m r r^T and w m v r^T, r the offset from the position, v the velocity.
    double sum = 0;
    Vector2d way = Vector2d::Zero(), velocity = Vector2d::Zero();
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero(), shear = Eigen::Matrix2d::Zero();
    for_each_particle_near(bins, place, radius, [&](std::size_t k) {
        const Vector2d r(bins.x[k] - place.x(), bins.z[k] - place.y());
        const WaterParticle p = bins.particle(k);
        const double w = (1 - std::sqrt(r.squaredNorm()) / radius) * p.mass;
        sum += w;
        way += w * r;
        velocity += w * p.velocity;
        spread += w * r * r.transpose();
        shear += w * p.velocity * r.transpose();
    });
    if (!(sum > 0)) return 0;
    spread -= way * way.transpose() / sum;
    shear -= velocity * way.transpose() / sum;
    // Particles in a line, or close to one another, give no gradient. In an even cone the spread is 0.15 R^2 along any
    // axis.
    const double even = 0.15 * sum * radius * radius;
    const double determinant = spread(0, 0) * spread(1, 1) - spread(0, 1) * spread(1, 0);
    if (determinant < 1e-4 * even * even) return 0;
    const double dx_dz = shear(0, 1) * spread(0, 0) - shear(0, 0) * spread(0, 1);
    const double dz_dx = shear(1, 0) * spread(1, 1) - shear(1, 1) * spread(1, 0);
    return 0.5 * (dx_dz - dz_dx) / determinant;
}

void feel_water(const Feeling& feeling, const WaterBins& bins, std::span<const Vector2d> positions, int threads,
                std::vector<FeltWater>& felt) {
    const auto n = static_cast<std::ptrdiff_t>(positions.size());
    felt.resize(positions.size());
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
    for (std::ptrdiff_t k = 0; k < n; ++k) {
        const auto i = static_cast<std::size_t>(k);
        felt[i] = feel_water(feeling, bins, positions[i]);
    }
}

}  // namespace wade::crowd
