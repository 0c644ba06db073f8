// How far bodies may move: limits u.n <= g, and the step that they leave of a wish.

#include <algorithm>
#include <cmath>

#include "crowd_client/bodies/bodies.hpp"
#include "crowd_client/bodies/body_looks.hpp"
#include "crowd_client/bodies/obstacles_near.hpp"

namespace wade::crowd {
namespace {

constexpr double shrink_rate = 0.3, grow_rate = 0.15;  // m/s, of a radius

struct Limit {
    double nx = 0, nz = 0;  // unit vector towards what is in the way
    double gap = 0;         // m, >= 0
};

// share: sigma, of the gap to a neighbour.
void add_neighbours(std::vector<Limit>& limits, const Bodies& bodies, std::size_t k, double reach, double share) {
    const double own = bodies.radius_now[k] + body_slack;
    bodies.cells.visit_near(bodies.place[k], reach, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= reach * reach) return;
        const double d = std::sqrt(square);
        if (!(d > 0)) return;
        limits.push_back({dx / d, dz / d, share * std::max(0.0, d - own - bodies.radius_now[j])});
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

// The radius that turned shoulders would leave an agent.
double wished_radius(const Bodies& bodies, const BodyMemory& body, std::uint32_t id) {
    const double facing = std::min(1.0, 3 * body.opposed[id]);
    const double low = 0.4 * (1 - facing), high = 1 - 0.5 * facing;
    const double turned = std::clamp((body.pressed[id] - low) / (high - low), 0.0, 1.0);
    return bodies.radius * (1 - (1 - turned_share) * turned);
}

// How far a body grows, of what it wishes; its limits shrink by as much.
double grown(std::vector<Limit>& limits, double wish) {
    double growth = wish;
    for (const Limit& limit : limits) growth = std::min(growth, 0.5 * limit.gap);
    for (Limit& limit : limits) limit.gap -= growth;
    return growth;
}

// What a motion has for all.
struct Motions {
    double time;     // h, s
    double share;    // sigma
    double longest;  // of all wishes and growths, m
    double count;    // in a step
};

// Moves place k, into next_place.
void move_one(Bodies& bodies, BodyMemory& body, std::uint32_t id, std::size_t k, const Walls& walls,
              const Vector2d& wish, const Interval& ends, const Motions& motions, std::vector<Limit>& limits) {
    const Vector2d& p = bodies.place[k];
    const double now = bodies.radius_now[k];
    limits.clear();
    add_neighbours(limits, bodies, k, 2 * bodies.radius + body_slack + motions.longest / motions.share, motions.share);
    add_obstacles(limits, walls, p, now, motions.longest);
    const double more = std::min(grow_rate * motions.time, wished_radius(bodies, body, id) - now);
    body.radius[id] = more > 0 ? now + grown(limits, more) : now;
    add_edges(limits, walls.world, p, ends, motions.longest);
    const Vector2d u = within(limits, wish / motions.count);
    bodies.step[k] += u;
    bodies.next_place[k] = p + u;
    if (const double period = walls.world.period(); period > 0) {
        double& x = bodies.next_place[k].x();
        x -= period * std::floor(x / period);
        if (x >= period) x = 0;
    }
}

}  // namespace

void limit_steps(Bodies& bodies, Agents& agents, std::span<const std::uint32_t> active, const Walls& walls,
                 std::span<const Vector2d> positions, std::span<const Vector2d> wishes, std::span<const Interval> ends,
                 double dt, int threads) {
    const std::size_t n = positions.size();
    bodies.step.assign(n, Vector2d::Zero());
    bodies.place.assign(positions.begin(), positions.end());
    bodies.next_place.resize(n);
    bodies.radius_now.resize(n);
    BodyMemory& body = agents.body;
    const int count = motions_in(dt);
    Motions motions{dt / count, 1 - std::exp2(-dt / count / longest_motion), 0, static_cast<double>(count)};
    double longest = 0;
    for (const Vector2d& w : wishes) longest = std::max(longest, w.squaredNorm());
    motions.longest = std::sqrt(longest) / motions.count + grow_rate * motions.time;
    const double reach = 2 * bodies.radius + body_slack + motions.longest / motions.share;
    for (int motion = 0; motion < count; ++motion) {
        sort_people(bodies.cells, walls.world, bodies.place, std::max(reach, furthest_look));
#pragma omp parallel num_threads(threads) if (threads > 1)
        {
            std::vector<Limit> limits;
#pragma omp for
            for (std::size_t k = 0; k < n; ++k) {
                const double r = body.radius[active[k]];
                const double least = std::max(wished_radius(bodies, body, active[k]), r - shrink_rate * motions.time);
                bodies.radius_now[k] = std::min(r, least);
            }
#pragma omp for
            for (std::size_t k = 0; k < n; ++k) {
                move_one(bodies, body, active[k], k, walls, wishes[k], ends[k], motions, limits);
            }
        }
        std::swap(bodies.place, bodies.next_place);
    }
    for (std::size_t k = 0; k < n; ++k) {
        body.went[active[k]] += bodies.step[k];
        body.wished[active[k]] += wishes[k];
    }
}

}  // namespace wade::crowd
