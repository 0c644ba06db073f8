#include "crowd_client/bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wade::crowd {
namespace {

constexpr double longest_lead = 1.0;  // m; |s| of the site
constexpr double memory_time = 0.2;   // s, of kappa
constexpr double follow_reach = 1.5;  // m, near enough to follow
constexpr double follow_time = 1.0;   // s, of lambda
constexpr double image_reach = 2.0;   // m, of the images beyond a joint

// Clockwise as seen with x to the right and z up.
Vector2d turned_right(const Vector2d& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.x() + s * v.y(), c * v.y() - s * v.x()};
}

Vector2d lead(const BodyStyle& style, const Vector2d& v, double longest) {
    const double speed = v.norm();
    const double factor = style.lead_length > 0 ? style.lead_length / (speed + 0.15) : style.lead_time;
    const double length = factor * speed;
    return length > longest ? Vector2d(v * (longest / speed)) : Vector2d(v * factor);
}

// Sites in the world, or a little outside where R leaves room for it.
Vector2d kept_near(const World& world, const Vector2d& q, double room) {
    const double x = world.period() > 0 ? q.x() : std::clamp(q.x(), -room, world.length + room);
    return {x, std::clamp(q.y(), -room, world.width + room)};
}

// Mean cosine of the angle between one's own heading and those of the people near; not below 0.
double share_followed(const Bodies& bodies, const Agents& agents, std::span<const std::uint32_t> active, std::size_t k,
                      const Vector2d& p) {
    const Vector2d& own = agents.heading[active[k]];
    double sum = 0, all = 0;
    bodies.cells.visit_near(p, follow_reach, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= follow_reach * follow_reach) return;
        sum += own.dot(agents.heading[active[j]]);
        all += 1;
    });
    return all > 0 ? std::max(0.0, sum / all) : 0.0;
}

}  // namespace

BodyStyle body_style(BodyRule rule) {
    BodyStyle style;
    style.contest_distance = 0.55;
    if (rule == BodyRule::human) {
        style.lead_length = 0.6;
        style.side_turn = 0.3;
        style.detour_turn = 2;
        style.discount = 0.5;
        style.blocked_share = 0.2;
        style.of_the_wish = true;
        style.patience = 1;
        style.spacing_rate = 2.2;
        style.least_ground = 0.05;
    } else {
        style.lead_time = 0.4;
        style.side_turn = 0.2;
        style.detour_turn = 1.5;
        style.discount = 0.9;
        style.blocked_share = 0.5;
        style.patience = 0.5;
    }
    return style;
}

void prepare_bodies(Bodies& bodies, Walkers& walkers, const Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, int threads) {
    const BodyStyle& style = bodies.style;
    const std::size_t n = active.size();
    for (std::vector<Vector2d>* v : {&bodies.site, &bodies.velocity, &bodies.turned_goal}) v->resize(n);
    for (std::vector<double>* v : {&bodies.desired_speed, &bodies.discount, &bodies.followed}) v->resize(n);
    sort_people(bodies.cells, world, positions, image_reach);
    const double room = GroundGrid::cell_size - perception_radius;
    const double longest = std::min(longest_lead, room);
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t id = active[k];
        const double side = style.side_turn * std::min(1.0, 3 * agents.contested[id]);
        const Vector2d s = turned_right(lead(style, agents.velocity[id], longest), side);
        bodies.site[k] = kept_near(world, positions[k] + s, room);
        bodies.velocity[k] = agents.velocity[id];
        bodies.turned_goal[k] = turned_right(goal_offsets[k], style.detour_turn * agents.blocked[id]);
        bodies.desired_speed[k] = agents.desired_speed[id];
        bodies.discount[k] = style.discount;
        if (style.only_followers) bodies.followed[k] = share_followed(bodies, agents, active, k, positions[k]);
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
    const double v0 = agents.desired_speed[id];
    if (!(style.spacing_rate > 0)) return walking_velocity(motion.vector[k], v0, rule, dt);
    const double length = motion.vector[k].norm();
    if (!(length > 0)) return Vector2d::Zero();
    const double ground = std::max(0.0, motion.owned[k] * marker_area - style.least_ground);
    double slowed = std::exp(-style.spacing_rate * ground);
    Vector2d wish = motion.vector[k] * (v0 / length);
    if (style.only_followers) {
        agents.followed[id] += std::min(1.0, dt / follow_time) * (bodies.followed[k] - agents.followed[id]);
        slowed *= agents.followed[id];
        wish = walking_velocity(motion.vector[k], v0, rule, dt);
    }
    return wish * (1 - slowed);
}

void note_blocked(const Bodies& bodies, Agents& agents, std::uint32_t id, const Vector2d& u, const Vector2d& w,
                  double dt) {
    const BodyStyle& style = bodies.style;
    const double free = agents.desired_speed[id] * dt;
    const double least = style.blocked_share * (style.of_the_wish ? std::min(w.norm(), free / 2) : free);
    const double blocked = u.norm() < least ? 1.0 : 0.0;
    agents.blocked[id] += std::min(1.0, dt / style.patience) * (blocked - agents.blocked[id]);
}

}  // namespace wade::crowd
