// Limits u.n <= g on the motion of bodies, and the step that they leave of a wish.

#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/bodies/bodies.hpp"
#include "crowd_client/bodies/body_looks.hpp"
#include "crowd_client/bodies/obstacles_near.hpp"
#include "crowd_client/markers/lanes.hpp"

namespace wade::crowd {
namespace {

constexpr double half_life = 0.05;                     // of the gap to a neighbour, s
constexpr double shrink_rate = 0.3, grow_rate = 0.15;  // m/s, of a radius

// Returns the shift of a periodic image from its person, along x, m.
double shift_of(const Bodies& bodies, std::uint32_t entry, double period) {
    const double moved = bodies.cells.x[entry] - bodies.place[bodies.cells.person[entry]].x();
    return period * std::round(moved / period);
}

// Returns a bit per entry of a block: set if the entry is less than `reach` from p, but not at p.
inline std::uint32_t near_in_block(const double* x, const double* z, const Vector2d& p, double reach) {
    using L = Lanes<double>;
    static_assert(BodyCells::lanes == 2 * L::count);
    const L::Reals own_x = p.x(), own_z = p.y(), none = 0, limit = reach * reach;
    const auto near = [&](std::size_t from) {
        const L::Reals dx = L::load(x + from) - own_x, dz = L::load(z + from) - own_z;
        const L::Reals square = dx * dx + dz * dz;
        return bits_of((square < limit) & (none < square));
    };
    return near(0) | near(L::count) << L::count;
}

// Adds the entries less than `reach` from agent k. Most blocks have few: the first three are taken without a branch, as
// it would be predicted badly.
void add_near(NearPairs& pairs, const Bodies& bodies, std::size_t k, double reach, double period) {
    const Vector2d p = bodies.place[k];
    const BodyCells& cells = bodies.cells;
    cells.visit_runs(p, {-reach, reach}, {-reach, reach}, [&](std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t block = first; block < end; block += BodyCells::lanes) {
            std::uint32_t near = near_in_block(&cells.x[block], &cells.z[block], p, reach);
            if (end - block < BodyCells::lanes) near &= (1U << (end - block)) - 1;
            pairs.make_room_for(BodyCells::lanes + 1);
            std::uint32_t *const own = pairs.own.data(), *const other = pairs.other.data();
            const std::uint32_t* const person = &cells.person[block];
            std::size_t count = pairs.count;
            const auto take_one = [&] {
                const auto i = static_cast<std::uint32_t>(std::countr_zero(near)) % BodyCells::lanes;
                own[count] = static_cast<std::uint32_t>(k);
                other[count] = person[i];
                if (period > 0) pairs.shift[count] = shift_of(bodies, block + static_cast<std::uint32_t>(i), period);
                count += static_cast<std::size_t>(near != 0);
                near &= near - 1;
            };
            for (int often = 0; often < 3; ++often) take_one();
            while (near != 0) take_one();
            pairs.count = count;
        }
    });
}

// Sets the limits of one motion. Per agent, sets the smallest gap and whether a limit may shorten the wish.
void set_limits(NearPairs& pairs, Bodies& bodies, double share) {
    constexpr double least_square = 1e-30;  // m2; avoids a division by 0
    const Vector2d *const place = bodies.place.data(), *const wish = bodies.wish.data();
    const double *const radius = bodies.radius_now.data(), *const growth = bodies.growth.data();
    const double* const shift = pairs.shift.data();
    double* const least_gap = bodies.least_gap.data();
    std::uint32_t* const is_bound = bodies.is_bound.data();
    const std::uint32_t *const own = pairs.own.data(), *const other = pairs.other.data();
    Limit* const limit = pairs.limit.data();
    for (std::size_t i = 0; i < pairs.count; ++i) {
        const std::uint32_t k = own[i], j = other[i];
        const double dx = place[j].x() + shift[i] - place[k].x(), dz = place[j].y() - place[k].y();
        const double d = std::sqrt(std::max(dx * dx + dz * dz, least_square)), per_length = 1 / d;
        const double nx = dx * per_length, nz = dz * per_length;
        const double gap = share * std::max(0.0, d - (radius[k] + body_slack) - radius[j]);
        limit[i] = {nx, nz, gap};
        least_gap[k] = std::min(least_gap[k], gap);
        is_bound[k] |= static_cast<std::uint32_t>(wish[k].x() * nx + wish[k].y() * nz > gap - growth[k]);
    }
}

void add_obstacles(std::vector<Limit>& limits, const Walls& walls, const Vector2d& p, double radius, double step) {
    for_each_within(walls, p, radius + body_slack + step, [&](const Vector2d& way, double d) {
        limits.push_back({way.x() / d, way.y() / d, std::max(0.0, d - radius - body_slack)});
    });
}

// Keeps the centre between the ends along x and the edges along z. Skips bounds that are further away than `step`.
void add_edges(std::vector<Limit>& limits, const World& world, const Vector2d& p, const Interval& ends, double step) {
    const auto add = [&](double nx, double nz, double gap) {
        if (gap < step + body_slack) limits.push_back({nx, nz, std::max(0.0, gap)});
    };
    add(-1, 0, p.x() - ends.lo);
    add(1, 0, ends.hi - p.x());
    add(0, -1, p.y());
    add(0, 1, world.width - p.y());
}

// Slides a wish along the limit that it breaks most, twice, then shortens it until it keeps all limits.
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

// Returns the radius that an agent would have after its desired turn of the shoulders.
double wished_radius(const Bodies& bodies, const BodyMemory& body, std::uint32_t id) {
    const double facing = std::min(1.0, 3 * body.opposed[id]);
    const double low = 0.4 * (1 - facing), high = 1 - 0.3 * facing;
    const double turned = std::clamp((body.pressed[id] - low) / (high - low), 0.0, 1.0);
    return bodies.radius * (1 - (1 - turned_share) * turned);
}

// Values that the motions of a step share for all agents.
struct Motions {
    int count;
    double time;     // h, s
    double share;    // sigma
    double longest;  // largest wish plus growth in one motion, m

    // Returns the distance within which another agent can limit one motion, m.
    [[nodiscard]] double reach(double radius) const { return 2 * radius + body_slack + longest / share; }
};

Motions motions_of(double dt, std::span<const Vector2d> wishes) {
    const int count = motions_in(dt);
    const double time = dt / count;
    double longest = 0;
    for (const Vector2d& w : wishes) longest = std::max(longest, w.squaredNorm());
    return {count, time, std::min(0.5, 1 - std::exp(-time / half_life * std::numbers::ln2)),
            std::sqrt(longest) / count + grow_rate * time};
}

// Sets the growth of agent k in a motion, and its radius, which shrinks at once.
void wish_motion(Bodies& bodies, const BodyMemory& body, std::uint32_t id, std::size_t k, const Motions& motions) {
    const double r = body.radius[id], wished = bodies.radius_wished[k];
    const double now = std::min(r, std::max(wished, r - shrink_rate * motions.time));
    bodies.radius_now[k] = now;
    bodies.growth[k] = std::max(0.0, std::min(grow_rate * motions.time, wished - now));
    bodies.least_gap[k] = std::numeric_limits<double>::infinity();
    bodies.is_bound[k] = 0;
}

// Moves agent k, into next_place. own: its limits towards neighbours. Most agents have room for their whole wish.
void move_one(Bodies& bodies, BodyMemory& body, std::uint32_t id, std::size_t k, const Walls& walls,
              const Interval& ends, const Motions& motions, std::span<const Limit> own, std::vector<Limit>& limits) {
    const Vector2d& p = bodies.place[k];
    const double now = bodies.radius_now[k];
    limits.clear();
    if (walls.has_any()) add_obstacles(limits, walls, p, now, motions.longest);
    double least_gap = bodies.least_gap[k];
    for (const Limit& limit : limits) least_gap = std::min(least_gap, limit.gap);
    const double growth = std::min(bodies.growth[k], 0.5 * least_gap);
    for (Limit& limit : limits) limit.gap -= growth;
    body.radius[id] = now + growth;
    add_edges(limits, walls.world, p, ends, motions.longest);
    Vector2d u = bodies.wish[k];
    if (bodies.is_bound[k] != 0 || !limits.empty()) {
        for (const Limit& limit : own) limits.push_back({limit.nx, limit.nz, limit.gap - growth});
        u = within(limits, u);
    }
    bodies.step[k] += u;
    bodies.next_place[k] = p + u;
}

}  // namespace

// The neighbour search runs once a step: a pair comes closer by at most twice the longest motion in each motion.
// Positions are not wrapped into a periodic world during the step.
void limit_steps(Bodies& bodies, Agents& agents, std::span<const std::uint32_t> active, const Walls& walls,
                 std::span<const Vector2d> positions, std::span<const Vector2d> wishes, std::span<const Interval> ends,
                 double dt, int threads) {
    const std::size_t n = positions.size();
    bodies.step.assign(n, Vector2d::Zero());
    bodies.place.assign(positions.begin(), positions.end());
    for (std::vector<Vector2d>* v : {&bodies.next_place, &bodies.wish}) v->resize(n);
    for (std::vector<double>* v : {&bodies.radius_now, &bodies.radius_wished, &bodies.growth, &bodies.least_gap}) {
        v->resize(n);
    }
    bodies.is_bound.resize(n);
    bodies.neighbours.resize(n);
    bodies.near.resize(std::max(bodies.near.size(), static_cast<std::size_t>(std::max(threads, 1))));
    BodyMemory& body = agents.body;
    const Motions motions = motions_of(dt, wishes);
    const double reach = motions.reach(bodies.radius) + 2 * (motions.count - 1) * motions.longest;
    if (!bodies.are_sorted || reach > furthest_look) {
        sort_people(bodies.cells, walls.world, positions, std::max(reach, furthest_look));
    }
    bodies.are_sorted = false;
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
        std::vector<Limit> limits;
        NearPairs& pairs = bodies.near[static_cast<std::size_t>(omp_get_thread_num())];
        pairs.count = 0;
#pragma omp for schedule(static)
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t before = pairs.count;
            add_near(pairs, bodies, k, reach, walls.world.period());
            bodies.neighbours[k] = static_cast<std::uint32_t>(pairs.count - before);
            bodies.radius_wished[k] = wished_radius(bodies, body, active[k]);
            bodies.wish[k] = wishes[k] / motions.count;
        }
        for (int motion = 0; motion < motions.count; ++motion) {
#pragma omp for schedule(static)
            for (std::size_t k = 0; k < n; ++k) wish_motion(bodies, body, active[k], k, motions);
            set_limits(pairs, bodies, motions.share);  // for the agents of this thread in the next loop
            std::size_t from = 0;
#pragma omp for schedule(static)
            for (std::size_t k = 0; k < n; ++k) {
                const std::span<const Limit> own{pairs.limit.data() + from, bodies.neighbours[k]};
                move_one(bodies, body, active[k], k, walls, ends[k], motions, own, limits);
                from += own.size();
            }
#pragma omp single
            std::swap(bodies.place, bodies.next_place);
        }
    }
    for (std::size_t k = 0; k < n; ++k) {
        body.went[active[k]] += bodies.step[k];
        body.wished[active[k]] += wishes[k];
    }
}

}  // namespace wade::crowd
