#include "crowd_client/bodies/bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wade::crowd {
namespace {

constexpr double longest_lead = 1.0;    // m; |s| of the site
constexpr double memory_time = 0.2;     // s, of kappa
constexpr double follow_reach = 1.5;    // m, near enough to follow
constexpr double follow_time = 1.0;     // s, of lambda
constexpr double trapped_patience = 5;  // s; before somebody tries the other side
constexpr double image_reach = 2.0;     // m, of the images beyond a joint

std::uint64_t steps_between_looks(double dt) {
    constexpr double look_time = 0.2;  // s
    return static_cast<std::uint64_t>(std::max(1L, std::lround(look_time / dt)));
}

// Clockwise as seen with x to the right and z up.
Vector2d turned_right(const Vector2d& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.x() + s * v.y(), c * v.y() - s * v.x()};
}

Vector2d shortened(const Vector2d& v, double longest) {
    const double length = std::sqrt(v.squaredNorm());
    return length > longest ? Vector2d(v * (longest / length)) : v;
}

// Sites in the world, or a little outside where R leaves room for it.
Vector2d kept_near(const World& world, const Vector2d& q, double room) {
    const double x = world.period() > 0 ? q.x() : std::clamp(q.x(), -room, world.length + room);
    return {x, std::clamp(q.y(), -room, world.width + room)};
}

// Mean cosine of the angle between one's own heading and those of the people near; not below 0. Summed in whole numbers, so
// that it does not depend on the order in which people are stored.
double share_followed(const Bodies& bodies, const Agents& agents, std::span<const std::uint32_t> active, std::size_t k,
                      const Vector2d& p) {
    const Vector2d& own = agents.heading[active[k]];
    constexpr double unit = 0x1p-40;
    std::int64_t sum = 0, all = 0;
    bodies.cells.visit_near(p, follow_reach, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= follow_reach * follow_reach) return;
        sum += static_cast<std::int64_t>(own.dot(agents.heading[active[j]]) / unit);
        ++all;
    });
    return all > 0 ? std::max(0.0, unit * static_cast<double>(sum) / static_cast<double>(all)) : 0.0;
}

}  // namespace

BodyStyle body_style(BodyRule rule) {
    BodyStyle style;
    if (rule == BodyRule::human) style.spacing_rate = 1.83;
    return style;
}

bool looks_whom_to_follow(std::uint64_t step, double dt) {
    return step % steps_between_looks(dt) == 0;
}

void prepare_bodies(Bodies& bodies, Walkers& walkers, const Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, bool look_whom_to_follow, int threads) {
    const BodyStyle& style = bodies.style;
    const std::size_t n = active.size();
    for (std::vector<Vector2d>* v : {&bodies.site, &bodies.velocity, &bodies.turned_goal}) v->resize(n);
    for (std::vector<double>* v : {&bodies.desired_speed, &bodies.discount}) v->resize(n);
    const bool looks = look_whom_to_follow && style.spacing_rate > 0;
    bodies.followed.resize(looks ? n : 0);
    sort_people(bodies.cells, world, positions, image_reach);
    const double room = GroundGrid::cell_size - perception_radius;
    const double longest = std::min(longest_lead, room);
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t id = active[k];
        const double side = style.side_turn * std::min(1.0, 3 * agents.contested[id]);
        const Vector2d s = turned_right(shortened(style.lead_time * agents.velocity[id], longest), side);
        bodies.site[k] = kept_near(world, positions[k] + s, room);
        bodies.velocity[k] = agents.velocity[id];
        bodies.turned_goal[k] =
            turned_right(goal_offsets[k], style.detour_turn * agents.detour_side[id] * agents.blocked[id]);
        bodies.desired_speed[k] = agents.desired_speed[id];
        bodies.discount[k] = style.discount;
        if (looks) bodies.followed[k] = share_followed(bodies, agents, active, k, positions[k]);
    }
    walkers.goal_offset = bodies.turned_goal;
    walkers.site = bodies.site;
    walkers.velocity = bodies.velocity;
    walkers.desired_speed = bodies.desired_speed;
    walkers.discount = bodies.discount;
    walkers.contest_distance = style.contest_distance;
}

Vector2d wished_velocity(const Bodies& bodies, Agents& agents, std::uint32_t id, std::size_t k, const Motion& motion,
                         double marker_area, SpeedRule rule, double dt) {
    const BodyStyle& style = bodies.style;
    if (motion.owned[k] > 0) {
        const double share = static_cast<double>(motion.contested[k]) / motion.owned[k];
        agents.contested[id] += std::min(1.0, dt / memory_time) * (share - agents.contested[id]);
    }
    const Vector2d free = walking_velocity(motion.vector[k], agents.desired_speed[id], rule, dt);
    if (!(style.spacing_rate > 0)) return free;
    if (!bodies.followed.empty()) {
        const double time = static_cast<double>(steps_between_looks(dt)) * dt;
        agents.followed[id] += std::min(1.0, time / follow_time) * (bodies.followed[k] - agents.followed[id]);
    }
    return free * (1 - agents.followed[id] * std::exp(-style.spacing_rate * motion.owned[k] * marker_area));
}

void note_blocked(const Bodies& bodies, Agents& agents, std::uint32_t id, const Vector2d& u, double dt) {
    const double blocked = std::sqrt(u.squaredNorm()) < 0.5 * agents.desired_speed[id] * dt ? 1.0 : 0.0;
    agents.blocked[id] += std::min(1.0, dt / bodies.style.patience) * (blocked - agents.blocked[id]);
    double& trapped = agents.trapped_time[id];
    trapped = agents.blocked[id] > 0.9 ? trapped + dt : 0.0;
    if (trapped < trapped_patience) return;
    agents.detour_side[id] = -agents.detour_side[id];
    trapped = 0;
}

}  // namespace wade::crowd
