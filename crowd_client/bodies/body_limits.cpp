// How far bodies may move: limits u.n <= g, and the step that they leave of a wish.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/bodies/bodies.hpp"

namespace wade::crowd {
namespace {

constexpr double longest_step = 0.7;  // m; images and cells of the neighbours reach as far as two such steps meet

struct Limit {
    double nx = 0, nz = 0;  // unit vector towards what is in the way
    double gap = 0;         // m, >= 0
};

void add_neighbours(std::vector<Limit>& limits, const Bodies& bodies, std::size_t k, const Vector2d& p, double reach) {
    bodies.cells.visit_near(p, reach, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= reach * reach) return;
        const double d = std::sqrt(square);
        if (!(d > 0)) return;
        limits.push_back({dx / d, dz / d, std::max(0.0, d - 2 * bodies.radius - body_slack) / 2});
    });
}

Vector2d nearest_in(const Obstacle& box, const Vector2d& p) {
    return {std::clamp(p.x(), box.x.lo, box.x.hi), std::clamp(p.y(), box.z.lo, box.z.hi)};
}

// Calls visit(way, d) for each obstacle less than `reach` away: the way to its nearest place, d long, m; d > 0.
template <typename Visit>
void for_each_within(const Walls& walls, const Vector2d& p, double reach, Visit&& visit) {
    const Interval x{p.x() - reach, p.x() + reach}, z{p.y() - reach, p.y() + reach};
    for_each_near(walls.boxes, x, z, [&](const Obstacle& box) {
        const Vector2d way = nearest_in(box, p) - p;
        const double d = std::sqrt(way.squaredNorm());
        if (d < reach && d > 0) visit(way, d);
    });
}

void add_obstacles(std::vector<Limit>& limits, const Walls& walls, const Vector2d& p, double radius, double step) {
    for_each_within(walls, p, radius + body_slack + step, [&](const Vector2d& way, double d) {
        limits.push_back({way.x() / d, way.y() / d, std::max(0.0, d - radius - body_slack)});
    });
}

// The centre stays between the ends along x and the edges along z. Those further away than `step` do not matter.
void add_edges(std::vector<Limit>& limits, const World& world, const Vector2d& p, const Interval& ends, double step) {
    const auto add = [&](double nx, double nz, double gap) {
        if (gap < step + body_slack) limits.push_back({nx, nz, std::max(0.0, gap)});
    };
    add(-1, 0, p.x() - ends.lo);
    add(1, 0, ends.hi - p.x());
    add(0, -1, p.y());
    add(0, 1, world.width - p.y());
}

// Slides a wish along the limit that it breaks most, twice, then shortens it.
Vector2d within(const std::vector<Limit>& limits, Vector2d u) {
    for (int turn = 0; turn < 2; ++turn) {
        const Limit* worst = nullptr;
        double most = 0;
        for (const Limit& limit : limits) {
            const double excess = u.x() * limit.nx + u.y() * limit.nz - limit.gap;
            if (excess <= most) continue;
            most = excess;
            worst = &limit;
        }
        if (worst == nullptr) return u;
        u -= most * Vector2d(worst->nx, worst->nz);
    }
    double scale = 1;
    for (const Limit& limit : limits) {
        const double along = u.x() * limit.nx + u.y() * limit.nz;
        if (along > limit.gap) scale = std::min(scale, limit.gap / along);
    }
    return scale * u;
}

}  // namespace

void limit_steps(Bodies& bodies, const Walls& walls, std::span<const Vector2d> positions,
                 std::span<const Vector2d> wishes, std::span<const Interval> ends, int threads) {
    const std::size_t n = positions.size();
    bodies.step.resize(n);
    double longest = 0;
    for (const Vector2d& w : wishes) longest = std::max(longest, w.squaredNorm());
    longest = std::min(std::sqrt(longest), longest_step);
    const double reach = 2 * bodies.radius + body_slack + 2 * longest;
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
        std::vector<Limit> limits;
#pragma omp for
        for (std::size_t k = 0; k < n; ++k) {
            limits.clear();
            add_neighbours(limits, bodies, k, positions[k], reach);
            add_obstacles(limits, walls, positions[k], bodies.radius, longest);
            add_edges(limits, walls.world, positions[k], ends[k], longest);
            const double length = wishes[k].norm();
            const Vector2d wish = length > longest ? Vector2d(wishes[k] * (longest / length)) : wishes[k];
            bodies.step[k] = within(limits, wish);
        }
    }
}

namespace {

// What moves one body out of the others and out of obstacles; counts those it is too close to.
Vector2d push_of(const BodyCells& cells, const Walls& walls, const std::vector<Vector2d>& places, std::size_t k,
                 double radius, std::size_t& too_close) {
    const double apart = 2 * radius + 2 * body_slack;
    Vector2d push = Vector2d::Zero();
    cells.visit_near(places[k], apart, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= apart * apart) return;
        ++too_close;
        const double d = std::sqrt(square);
        // Who stands in one place is parted along x, by number.
        const Vector2d n = d > 1e-9 ? Vector2d(dx / d, dz / d) : Vector2d(k < j ? 1 : -1, 0);
        push -= (0.5 * (apart - d) + body_slack) * n;
    });
    for_each_within(walls, places[k], radius + 2 * body_slack, [&](const Vector2d& way, double d) {
        ++too_close;
        push -= (radius + 3 * body_slack - d) * (way / d);
    });
    return push;
}

}  // namespace

void make_room_for_bodies(Agents& agents, const Walls& walls, double radius) {
    constexpr int most_turns = 5000;
    BodyCells cells;
    std::vector<Vector2d> places = agents.position, pushes(places.size());
    std::size_t too_close = 1, worst = 0;
    for (int turn = 0; turn < most_turns && too_close > 0; ++turn) {
        sort_people(cells, walls.world, places, 2 * radius + 1e-2);
        too_close = 0;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const std::size_t before = too_close;
            pushes[k] = push_of(cells, walls, places, k, radius, too_close);
            if (too_close > before) worst = k;
        }
        for (std::size_t k = 0; k < places.size(); ++k) {
            Vector2d& p = places[k];
            p += pushes[k];
            p.y() = std::clamp(p.y(), 0.0, walls.world.width);
            if (const double period = walls.world.period(); period > 0) {
                p.x() -= period * std::floor(p.x() / period);
                if (p.x() >= period) p.x() = 0;
            } else {
                p.x() = std::clamp(p.x(), 0.0, walls.world.length);
            }
        }
    }
    if (too_close == 0) {
        agents.position = places;
        return;
    }
    std::ostringstream message;
    message << "/crowd/groups/" << agents.group[worst] << "/start: bodies of radius " << radius
            << " m (/crowd/body_radius_m) find no room near (" << agents.position[worst].x() << ", "
            << agents.position[worst].y() << ") m, where agent " << worst
            << " starts; allowed: fewer agents, a larger pitch or a smaller radius";
    throw ConfigurationError(message.str());
}

}  // namespace wade::crowd
