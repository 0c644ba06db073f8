// Decisions of agents with bodies, and the memories that these decisions use.

#include "crowd_client/bodies/bodies.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/bodies/body_looks.hpp"
#include "crowd_client/markers/counter_random.hpp"

namespace wade::crowd {
namespace {

constexpr double longest_lead = 1.0;      // m; |s| of the site
constexpr double contested_time = 0.4;    // s, of kappa
constexpr double followed_time = 1.0;     // s, of lambda
constexpr double opposed_time = 0.5;      // s, of o
constexpr double pressed_time = 1.0;      // s, of c
constexpr double look_followed = 0.4;     // s, between two updates of lambda
constexpr double look_opposed = 0.5;      // s, between two updates of o
constexpr double trapped_patience = 5;    // s; before an agent tries the other side
constexpr double keep_right_from = 0.05;  // o

// Moves a running mean towards the current value, over `memory` s.
void note(double& value, double now, double time, double memory) {
    value += std::min(1.0, time / memory) * (now - value);
}

// Returns the ground that a body with turned shoulders covers, m2.
double covered_ground(double radius) {
    return std::numbers::pi * turned_share * radius * turned_share * radius;
}

// Returns v turned clockwise, seen with x to the right and z up. |angle| <= 1.5 rad. It uses the first terms of cosine
// and sine, to 1e-7, as their bits are the same on all machines.
inline Vector2d turned_right(const Vector2d& v, double angle) {
    const double q = angle * angle;
    const double c =
        1 -
        q * (1. / 2 - q * (1. / 24 - q * (1. / 720 - q * (1. / 40320 - q * (1. / 3628800 - q * (1. / 479001600))))));
    const double s =
        angle * (1 - q * (1. / 6 - q * (1. / 120 - q * (1. / 5040 - q * (1. / 362880 - q * (1. / 39916800))))));
    return {c * v.x() + s * v.y(), c * v.y() - s * v.x()};
}

Vector2d shortened(const Vector2d& v, double longest) {
    const double length = std::sqrt(v.squaredNorm());
    return length > longest ? Vector2d(v * (longest / length)) : v;
}

// Clamps a site to the world, widened by `room`, the margin that R leaves.
Vector2d kept_near(const World& world, const Vector2d& q, double room) {
    const double x = world.period() > 0 ? q.x() : std::clamp(q.x(), -room, world.length + room);
    return {x, std::clamp(q.y(), -room, world.width + room)};
}

// Updates v, c, s, b and the side of a detour from the agent's motion since the last decision.
void note_progress(const BodyStyle& style, BodyMemory& body, std::uint32_t id, double desired_speed, double time) {
    const Vector2d went = body.went[id], wished = body.wished[id];
    body.went[id] = body.wished[id] = Vector2d::Zero();
    body.pace[id] = went / time;
    const double square = wished.squaredNorm();
    note(body.pressed[id], square > 0 ? std::clamp(1 - went.dot(wished) / square, 0.0, 1.0) : 0.0, time, pressed_time);
    const double speed = std::sqrt(body.pace[id].squaredNorm());
    body.stood[id] = std::clamp(body.stood[id] + (speed < 0.1 * desired_speed ? time : -2 * time), 0.0, 10.0);
    const double walked = body.intended[id].squaredNorm() * time;
    const double left = walked > 0 ? std::clamp(wished.dot(body.intended[id]) / walked, 0.0, 1.0) : 1.0;
    note(body.blocked[id], speed < style.slow_share * left * body.follow_speed[id] * desired_speed ? 1.0 : 0.0, time,
         style.patience);
    const bool keeps_right = body.opposed[id] > keep_right_from;
    const double side = keeps_right ? 1.0 : body.detour_side[id];
    const double trapped = !keeps_right && body.blocked[id] > 0.9 ? body.trapped_time[id] + time : 0.0;
    const bool changes = trapped >= trapped_patience;
    body.detour_side[id] = changes ? -side : side;
    body.trapped_time[id] = changes ? 0.0 : trapped;
}

// Returns true if an agent that has stood too long steps back in this second.
bool yields(const Bodies& bodies, const BodyMemory& body, std::uint32_t id, const Decision& decision) {
    constexpr double patience = 2, chance = 0.3, nobody_opposed = 0.1;
    if (body.stood[id] <= patience || body.opposed[id] >= nobody_opposed) return false;
    constexpr std::uint64_t stream = std::uint64_t{1} << 42;  // apart from the streams of markers and agents
    const double offset = unit_fraction(mix_bits(body.draw[id]));
    const auto second = static_cast<std::uint64_t>(static_cast<double>(decision.number) * decision.time + offset);
    return counter_uniform(bodies.seed, stream + body.draw[id], second) < chance;
}

}  // namespace

BodyStyle body_style(BodyRule rule) {
    BodyStyle style;
    if (rule == BodyRule::human) {
        style.spacing_rate = 2.08;
        style.slow_share = 0.6;
    }
    return style;
}

void begin_bodies(Agents& agents, double radius) {
    BodyMemory& body = agents.body;
    const std::size_t n = agents.size();
    body.radius.assign(n, radius);
    for (std::vector<double>* v : {&body.detour_side, &body.follow_speed}) v->assign(n, 1.0);
    for (std::vector<double>* v : {&body.contested, &body.blocked, &body.followed, &body.opposed, &body.pressed,
                                   &body.stood, &body.trapped_time}) {
        v->assign(n, 0.0);
    }
    for (std::vector<Vector2d>* v : {&body.intended, &body.pace, &body.went, &body.wished}) {
        v->assign(n, Vector2d::Zero());
    }
    body.draw.resize(n);
    for (std::size_t id = 0; id < n; ++id) {
        const Vector2d& p = agents.position[id];
        body.draw[id] = mix_bits(mix_bits(std::bit_cast<std::uint64_t>(p.x())) + std::bit_cast<std::uint64_t>(p.y()));
        if (agents.outcome[id] == Outcome::indoors) body.draw[id] = mix_bits(body.draw[id] + id);  // many at one door
    }
}

void prepare_bodies(Bodies& bodies, Walkers& walkers, Agents& agents, std::span<const std::uint32_t> active,
                    std::span<const Vector2d> positions, std::span<const Vector2d> goal_offsets, const World& world,
                    double perception_radius, const Decision& decision, int threads) {
    const BodyStyle& style = bodies.style;
    BodyMemory& body = agents.body;
    const std::size_t n = active.size();
    for (std::vector<Vector2d>* v :
         {&bodies.site, &bodies.velocity, &bodies.turned_goal, &bodies.heading, &bodies.way, &bodies.bearing}) {
        v->resize(n);
    }
    for (std::vector<double>* v : {&bodies.desired_speed, &bodies.discount}) v->resize(n);
    const bool looks = decision.is_due(look_followed) && style.spacing_rate > 0;
    const bool looks_ahead = decision.is_due(look_opposed);
    bodies.followed.resize(looks ? n : 0);
    bodies.opposed.resize(looks_ahead ? n : 0);
    sort_people(bodies.cells, world, positions, furthest_look);
    bodies.are_sorted = true;
    const double room = GroundGrid::cell_size - perception_radius;
    const double longest = std::min(longest_lead, room);
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
#pragma omp for
        for (std::size_t k = 0; k < n; ++k) {
            const std::uint32_t id = active[k];
            if (decision.number > 0) note_progress(style, body, id, agents.desired_speed[id], decision.time);
            const double side = style.side_turn * std::min(1.0, 3 * body.contested[id]);
            const Vector2d s = turned_right(shortened(style.lead_time * body.pace[id], longest), side);
            bodies.site[k] = kept_near(world, positions[k] + s, room);
            bodies.velocity[k] = body.pace[id];
            bodies.turned_goal[k] =
                turned_right(goal_offsets[k], style.detour_turn * body.detour_side[id] * body.blocked[id]);
            bodies.desired_speed[k] = agents.desired_speed[id];
            bodies.discount[k] = style.discount;
            if (looks) bodies.heading[k] = unit_or(body.pace[id], agents.heading[id]);
            if (!looks_ahead) continue;
            bodies.way[k] = unit_or(goal_offsets[k], Vector2d::Zero());
            bodies.bearing[k] = unit_or(goal_offset(agents, id, world.period()), Vector2d::Zero());
        }
#pragma omp single
        {
            if (looks) sort_headings(bodies.looks, bodies.cells, bodies.heading);
            if (looks_ahead) sort_routes(bodies.looks, bodies.cells, bodies.way, bodies.bearing);
        }
#pragma omp for
        for (std::size_t k = 0; k < n; ++k) {
            const Vector2d& p = positions[k];
            if (looks) bodies.followed[k] = share_followed(bodies.looks, bodies.cells, p, bodies.heading[k]);
            if (looks_ahead) {
                bodies.opposed[k] = share_opposed(bodies.looks, bodies.cells, p, bodies.way[k], bodies.bearing[k]);
            }
        }
    }
    walkers.goal_offset = bodies.turned_goal;
    walkers.site = bodies.site;
    walkers.velocity = bodies.velocity;
    walkers.desired_speed = bodies.desired_speed;
    walkers.discount = bodies.discount;
    walkers.contest_distance = style.contest_distance;
}

Vector2d wished_velocity(const Bodies& bodies, Agents& agents, std::uint32_t id, std::size_t k, const Motion& motion,
                         double marker_area, SpeedRule rule, const Decision& decision) {
    constexpr double back = 0.3;  // m/s
    BodyMemory& body = agents.body;
    if (motion.owned[k] > 0) {
        const double share = static_cast<double>(motion.contested[k]) / motion.owned[k];
        note(body.contested[id], share, decision.time, contested_time);
    }
    if (!bodies.followed.empty()) {
        note(body.followed[id], bodies.followed[k], decision.interval(look_followed), followed_time);
    }
    if (!bodies.opposed.empty()) {
        note(body.opposed[id], bodies.opposed[k], decision.interval(look_opposed), opposed_time);
    }
    if (yields(bodies, body, id, decision)) return -back * unit_or(bodies.turned_goal[k], Vector2d::Zero());
    const Vector2d free = walking_velocity(motion.vector[k], agents.desired_speed[id], rule, decision.time);
    const BodyStyle& style = bodies.style;
    if (!(style.spacing_rate > 0)) return free;
    const double followed = body.followed[id], ground = motion.owned[k] * marker_area;
    const double room = ground / style.passing_ground, squared = room * room;
    const double passing = squared * squared * squared * (1 - followed);
    const double free_ground = std::max(0.0, ground - covered_ground(bodies.radius));
    body.follow_speed[id] = 1 - followed * std::exp(-style.spacing_rate * free_ground * (1 + passing));
    return free * body.follow_speed[id];
}

}  // namespace wade::crowd
