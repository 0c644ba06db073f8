#include "crowd_client/navigation/obstacles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"

namespace wade::crowd {
namespace {

struct Hit {
    double time = 2;  // in units of the displacement, [0, 1]; 2: none
    int axis = 0;     // 0: a face normal to x, 1: normal to z
    double face = 0;  // its coordinate along the axis, m
};

bool strictly_inside(const Obstacle& box, const Vector2d& p) {
    return box.x.lo < p.x() && p.x() < box.x.hi && box.z.lo < p.y() && p.y() < box.z.hi;
}

// Finds where the segment p + t d, t in [0, 1], enters the open box (slab method). A point on a face that moves along
// it or away from it does not enter.
Hit entry(const Obstacle& box, const Vector2d& p, const Vector2d& d) {
    double t_in = -std::numeric_limits<double>::infinity();
    double t_out = std::numeric_limits<double>::infinity();
    Hit hit;
    for (int axis = 0; axis < 2; ++axis) {
        const Interval& side = axis == 0 ? box.x : box.z;
        if (d[axis] == 0) {
            if (p[axis] <= side.lo || p[axis] >= side.hi) return {};
            continue;
        }
        const double near_face = d[axis] > 0 ? side.lo : side.hi;
        const double far_face = d[axis] > 0 ? side.hi : side.lo;
        const double t_near = (near_face - p[axis]) / d[axis];
        if (t_near > t_in) {
            t_in = t_near;
            hit.axis = axis;
            hit.face = near_face;
        }
        t_out = std::min(t_out, (far_face - p[axis]) / d[axis]);
    }
    if (t_in < 0 || t_in > 1 || t_in >= t_out) return {};
    hit.time = t_in;
    return hit;
}

// Returns the range between two coordinates, a skin wider on either side against rounding.
Interval box_range(double a, double b) {
    return {std::min(a, b) - Walls::skin, std::max(a, b) + Walls::skin};
}

bool free_of_boxes(const Walls& walls, const Vector2d& p) {
    return !any_near(walls.boxes, {p.x(), p.x()}, {p.y(), p.y()},
                     [&](const Obstacle& b) { return strictly_inside(b, p); });
}

}  // namespace

Walls make_walls(const Scene& scene) {
    std::vector<Obstacle> boxes = scene.site ? std::vector<Obstacle>{} : scene.obstacles;
    if (const double period = scene.world->period(); period > 0) {
        for (const Obstacle& box : scene.obstacles) {
            for (const double shift : {-period, period}) {
                boxes.push_back({{box.x.lo + shift, box.x.hi + shift}, box.z, box.height});
            }
        }
    }
    for (Obstacle& box : boxes) {
        box.x = {box.x.lo - Walls::skin, box.x.hi + Walls::skin};
        box.z = {box.z.lo - Walls::skin, box.z.hi + Walls::skin};
    }
    constexpr double cell = 1;  // m; wider than a step most often is
    Walls walls{scene.world, place_boxes(std::move(boxes), cell)};
    walls.has_fall = scene.world->ends == Ends::open && scene.channel->flow != Flow::closed;
    if (scene.channel->flow == Flow::closed) walls.tank = Walls::Tank{scene.channel->x, scene.channel->z};
    walls.houses = houses_of(scene);
    return walls;
}

Interval ends_for(const Walls& walls, const Vector2d& p, double goal_x, bool carried_down) {
    constexpr double nowhere = std::numeric_limits<double>::infinity();
    if (walls.world.ends == Ends::periodic) return {-nowhere, nowhere};
    Interval ends{walls.has_fall && carried_down ? -nowhere : 0, walls.world.length};
    if (!walls.tank || !walls.tank->x.contains(p.x()) || !walls.tank->z.contains(p.y())) return ends;
    return walls.tank->x.contains(goal_x) ? walls.tank->x : ends;
}

std::optional<Vector2d> place_outside(const Walls& walls, const Vector2d& p) {
    if (!walls.houses.empty()) return place_before_houses(walls.houses, p);
    if (free_of_boxes(walls, p)) return p;
    std::optional<Vector2d> best;
    double best_distance = 3 * Walls::skin;
    const double reach = best_distance;
    const Interval near_x = box_range(p.x() - reach, p.x() + reach), near_z = box_range(p.y() - reach, p.y() + reach);
    for_each_near(walls.boxes, near_x, near_z, [&](const Obstacle& box) {
        for (const double x : {p.x(), box.x.lo, box.x.hi}) {
            for (const double z : {p.y(), box.z.lo, box.z.hi}) {
                const Vector2d candidate(x, z);
                const double distance = std::max(std::abs(x - p.x()), std::abs(z - p.y()));
                const bool in_world = x >= 0 && x <= walls.world.length && z >= 0 && z <= walls.world.width;
                if (distance < best_distance && in_world && free_of_boxes(walls, candidate)) {
                    best = candidate;
                    best_distance = distance;
                }
            }
        }
    });
    return best;
}

Vector2d keep_in_world(const World& world, const Vector2d& p, const Vector2d& walking, double dt) {
    const bool ends = world.ends == Ends::open;
    // Most positions are far from all edges, and the divisions below cost more than the rest.
    const double reach_x = 2 * dt * std::abs(walking.x()), reach_z = 2 * dt * std::abs(walking.y());
    const bool far_x = !ends || (p.x() > reach_x && world.length - p.x() > reach_x);
    if (far_x && p.y() > reach_z && world.width - p.y() > reach_z) return walking;
    return {ends ? std::clamp(walking.x(), -p.x() / dt, (world.length - p.x()) / dt) : walking.x(),
            std::clamp(walking.y(), -p.y() / dt, (world.width - p.y()) / dt)};
}

Vector2d slide(const Walls& walls, const Vector2d& p, const Vector2d& displacement, const Interval& ends) {
    if (!walls.houses.empty()) return slide_along_houses(walls, p, displacement, ends);
    Vector2d target = p + displacement;
    target.x() = std::clamp(target.x(), ends.lo, ends.hi);
    target.y() = std::clamp(target.y(), 0.0, walls.world.width);
    const Interval x = box_range(p.x(), target.x()), z = box_range(p.y(), target.y());
    if (!any_near(walls.boxes, x, z, [](const Obstacle&) { return true; })) return target;

    // Each face removes one component, so two faces end a step; further turns serve boxes that are met while sliding
    // along another. The rest after the last turn is dropped: the point stays at its last contact.
    constexpr int max_turns = 8;
    Vector2d at = p;
    for (int turn = 0; turn < max_turns && at != target; ++turn) {
        const Vector2d rest = target - at;
        Hit first;
        for_each_near(walls.boxes, x, z, [&](const Obstacle& box) {
            const Hit hit = entry(box, at, rest);
            if (hit.time < first.time) first = hit;
        });
        if (first.time > 1) return free_of_boxes(walls, target) ? target : at;
        const int along = 1 - first.axis;
        const auto [lo, hi] = std::minmax(at[along], target[along]);
        Vector2d touch;
        touch[first.axis] = first.face;
        touch[along] = std::clamp(at[along] + first.time * rest[along], lo, hi);
        if (!free_of_boxes(walls, touch)) return at;
        at = touch;
        target[first.axis] = first.face;
    }
    return at;
}

}  // namespace wade::crowd
