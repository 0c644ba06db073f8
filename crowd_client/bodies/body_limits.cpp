// How far bodies may move: limits u.n <= g, and the step that they leave of a wish.

#include <algorithm>
#include <bit>
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

// Somebody who may come near in this step. shift: along x, of an image in a periodic world, m.
struct Neighbour {
    std::uint32_t person = 0;
    double shift = 0;
};

double shift_of(const Bodies& bodies, std::uint32_t entry, double period) {
    const double moved = bodies.cells.x[entry] - bodies.place[bodies.cells.person[entry]].x();
    return period * std::round(moved / period);
}

// Which of a block of entries are less than `reach` from p, a bit for each.
std::uint32_t near_in_block(const double* x, const double* z, const Vector2d& p, double reach) {
    std::uint32_t bits = 0;
#pragma omp simd reduction(| : bits)
    for (std::size_t l = 0; l < BodyCells::lanes; ++l) {
        const double dx = x[l] - p.x(), dz = z[l] - p.y();
        bits |= dx * dx + dz * dz < reach * reach ? 1U << l : 0U;
    }
    return bits;
}

// Adds those less than `reach` from place k; returns their number.
std::uint32_t list_neighbours(std::vector<Neighbour>& list, const Bodies& bodies, std::size_t k, double reach,
                              double period) {
    const Vector2d p = bodies.place[k];
    const BodyCells& cells = bodies.cells;
    const std::size_t before = list.size();
    cells.visit_runs(p, {-reach, reach}, {-reach, reach}, [&](std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t block = first; block < end; block += BodyCells::lanes) {
            std::uint32_t near = near_in_block(&cells.x[block], &cells.z[block], p, reach);
            if (end - block < BodyCells::lanes) near &= (1U << (end - block)) - 1;
            for (; near != 0; near &= near - 1) {
                const std::uint32_t i = block + static_cast<std::uint32_t>(std::countr_zero(near));
                list.push_back({cells.person[i], period > 0 ? shift_of(bodies, i, period) : 0.0});
            }
        }
    });
    return static_cast<std::uint32_t>(list.size() - before);
}

// share: sigma, of the gap to a neighbour.
void add_neighbours(std::vector<Limit>& limits, const Bodies& bodies, std::size_t k,
                    std::span<const Neighbour> neighbours, double reach, double share) {
    const double own = bodies.radius_now[k] + body_slack;
    const Vector2d& p = bodies.place[k];
    for (const auto& [j, shift] : neighbours) {
        const double dx = bodies.place[j].x() + shift - p.x(), dz = bodies.place[j].y() - p.y();
        const double square = dx * dx + dz * dz;
        if (square >= reach * reach || !(square > 0)) continue;
        const double d = std::sqrt(square), per_length = 1 / d;
        limits.push_back({dx * per_length, dz * per_length, share * std::max(0.0, d - own - bodies.radius_now[j])});
    }
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
    const double low = 0.4 * (1 - facing), high = 1 - 0.3 * facing;
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

// What the motions of a step have for all.
struct Motions {
    int count;
    double time;     // h, s
    double share;    // sigma
    double longest;  // of all wishes and growths in one of them, m

    // How far away somebody matters in one of them, m.
    [[nodiscard]] double reach(double radius) const { return 2 * radius + body_slack + longest / share; }
};

Motions motions_of(double dt, std::span<const Vector2d> wishes) {
    const int count = motions_in(dt);
    const double time = dt / count;
    double longest = 0;
    for (const Vector2d& w : wishes) longest = std::max(longest, w.squaredNorm());
    return {count, time, 1 - std::exp2(-time / longest_motion), std::sqrt(longest) / count + grow_rate * time};
}

// Moves place k, into next_place.
void move_one(Bodies& bodies, BodyMemory& body, std::uint32_t id, std::size_t k, const Walls& walls,
              const Vector2d& wish, const Interval& ends, const Motions& motions, std::span<const Neighbour> neighbours,
              std::vector<Limit>& limits) {
    const Vector2d& p = bodies.place[k];
    const double now = bodies.radius_now[k];
    limits.clear();
    add_neighbours(limits, bodies, k, neighbours, motions.reach(bodies.radius), motions.share);
    add_obstacles(limits, walls, p, now, motions.longest);
    const double more = std::min(grow_rate * motions.time, bodies.radius_wished[k] - now);
    body.radius[id] = more > 0 ? now + grown(limits, more) : now;
    add_edges(limits, walls.world, p, ends, motions.longest);
    const Vector2d u = within(limits, wish / motions.count);
    bodies.step[k] += u;
    bodies.next_place[k] = p + u;
}

}  // namespace

// People are looked for once: nobody comes nearer by more than two motions in each. Places are not brought back into a
// periodic world meanwhile.
void limit_steps(Bodies& bodies, Agents& agents, std::span<const std::uint32_t> active, const Walls& walls,
                 std::span<const Vector2d> positions, std::span<const Vector2d> wishes, std::span<const Interval> ends,
                 double dt, int threads) {
    const std::size_t n = positions.size();
    bodies.step.assign(n, Vector2d::Zero());
    bodies.place.assign(positions.begin(), positions.end());
    bodies.next_place.resize(n);
    bodies.radius_now.resize(n);
    bodies.radius_wished.resize(n);
    bodies.neighbours.resize(n);
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
        std::vector<Neighbour> near;  // of this thread's people, one after the other
#pragma omp for schedule(static)
        for (std::size_t k = 0; k < n; ++k) {
            bodies.neighbours[k] = list_neighbours(near, bodies, k, reach, walls.world.period());
            bodies.radius_wished[k] = wished_radius(bodies, body, active[k]);
        }
        for (int motion = 0; motion < motions.count; ++motion) {
#pragma omp for schedule(static)
            for (std::size_t k = 0; k < n; ++k) {
                const double r = body.radius[active[k]];
                bodies.radius_now[k] = std::min(r, std::max(bodies.radius_wished[k], r - shrink_rate * motions.time));
            }
            std::size_t from = 0;
#pragma omp for schedule(static)
            for (std::size_t k = 0; k < n; ++k) {
                const std::span<const Neighbour> own{near.data() + from, bodies.neighbours[k]};
                move_one(bodies, body, active[k], k, walls, wishes[k], ends[k], motions, own, limits);
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
