// Where things are: intervals, and what must lie within what.

#include <algorithm>
#include <cmath>
#include <vector>

#include "configs/checks/scene_checks.hpp"
#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

struct Box {
    Interval x, y, z;
    std::string pointer;
};

std::string words(const Interval& interval) {
    return short_number(interval.lo) + " to " + short_number(interval.hi) + " m";
}

void check_interval(const Interval& interval, const std::string& axis, const std::string& source,
                    const std::string& pointer) {
    if (interval.lo < interval.hi) return;
    refuse(source, pointer + "/" + axis + "_min_m",
           short_number(interval.lo) + " m is not smaller than " + axis + "_max_m = " + short_number(interval.hi) +
               " m; allowed: < " + short_number(interval.hi) + " m.");
}

bool within(const Interval& inner, const Interval& outer) {
    return outer.lo <= inner.lo && inner.hi <= outer.hi;
}

// Sharing a face is not overlapping.
bool overlap(const Interval& a, const Interval& b) {
    return a.lo < b.hi && b.lo < a.hi;
}
bool overlap(const Box& a, const Box& b) {
    return overlap(a.x, b.x) && overlap(a.y, b.y) && overlap(a.z, b.z);
}

void check_box(const Box& box, const std::string& what, const Scene& scene, const std::string& source) {
    check_interval(box.x, "x", source, box.pointer);
    check_interval(box.z, "z", source, box.pointer);
    const Channel& channel = scene.channel;
    if (within(box.x, channel.x) && within(box.z, channel.z)) return;
    refuse(source, box.pointer,
           what + " at x " + words(box.x) + ", z " + words(box.z) + " reaches outside the channel; allowed: x " +
               words(channel.x) + ", z " + words(channel.z) + ".");
}

// The last box against those before it; scenes have few boxes.
void check_apart(const std::vector<Box>& boxes, const std::string& source) {
    const Box& last = boxes.back();
    for (std::size_t k = 0; k + 1 < boxes.size(); ++k) {
        if (!overlap(last, boxes[k])) continue;
        const Interval x{std::max(last.x.lo, boxes[k].x.lo), std::min(last.x.hi, boxes[k].x.hi)};
        const Interval z{std::max(last.z.lo, boxes[k].z.lo), std::min(last.z.hi, boxes[k].z.hi)};
        refuse(source, last.pointer,
               "overlaps " + boxes[k].pointer + " at x " + words(x) + ", z " + words(z) + "; they may touch at most.");
    }
}

// Where the water wraps round or comes in, an obstacle must be out of the particles' reach: their neighbours beyond the
// border do not see it, and the emitter would push its lattice through it.
void check_obstacles_near_ends(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const double reach = reach_of_water(scene.fluid);
    Interval x = channel.x;
    Interval z = channel.z;
    if (channel.flow == Flow::recirculating || channel.flow == Flow::periodic) x = {x.lo + reach, x.hi - reach};
    if (channel.flow == Flow::emitter) x.hi -= 2 * reach;
    if (channel.sides == Sides::periodic) z = {z.lo + reach, z.hi - reach};
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
        const Obstacle& obstacle = scene.obstacles[i];
        if (within(obstacle.x, x) && within(obstacle.z, z)) continue;
        refuse(source, "/obstacles/" + std::to_string(i),
               "the obstacle at x " + words(obstacle.x) + ", z " + words(obstacle.z) + " is too near to the emitter (" +
                   short_number(2 * reach) + " m) or to a periodic border (" + short_number(reach) +
                   " m); allowed: x " + words(x) + ", z " + words(z) + ".");
    }
}

// Measured: of what passes a gap of 0.2 m under 1 m of water in 2 s with four spacings in it, 17 % pass with one, 79 % with two,
// 94 % with three.
constexpr double spacings_in_a_gap = 3;

struct Gap {
    double width;  // m
    std::string between;
};

// What is free between two intervals, m; not positive if they touch or overlap.
double free_between(const Interval& a, const Interval& b) {
    return std::max(b.lo - a.hi, a.lo - b.hi);
}

// A side of a house.
struct PlanSide {
    MapPoint a, b;
};

// Ground plan of a house with its box.
struct Plan {
    Interval x{INFINITY, -INFINITY}, z{INFINITY, -INFINITY};
    std::vector<PlanSide> sides;
    const MapPolygon* polygon = nullptr;
    std::string name;
};

Plan plan_of(const House& house) {
    Plan plan;
    plan.polygon = &house.polygon;
    plan.name = house.label;
    for (const MapLine& ring : house.polygon.rings) {
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const MapPoint& p = ring[k];
            plan.x = {std::min(plan.x.lo, p.x), std::max(plan.x.hi, p.x)};
            plan.z = {std::min(plan.z.lo, p.z), std::max(plan.z.hi, p.z)};
            plan.sides.push_back({p, ring[(k + 1) % ring.size()]});
        }
    }
    return plan;
}

// What is free between two houses, 0 where they overlap, and the middle of where it is narrowest.
struct Strait {
    double width = INFINITY;
    MapPoint middle;

    void take(const PlanSide& side, const MapPoint& p) {
        const MapPoint foot = on_map::nearest_on(side.a, side.b, p);
        const double distance = length_of(foot.x - p.x, foot.z - p.z);
        if (distance >= width) return;
        width = distance;
        middle = {0.5 * (foot.x + p.x), 0.5 * (foot.z + p.z)};
    }
};
Strait strait_between(const Plan& one, const Plan& other) {
    Strait strait;
    for (const PlanSide& a : one.sides) {
        for (const PlanSide& b : other.sides) {
            if (on_map::cross(a.a, a.b, b.a, b.b)) return {0, a.a};
            strait.take(a, b.a);
            strait.take(b, a.a);
        }
    }
    if (contains(*other.polygon, one.sides[0].a) || contains(*one.polygon, other.sides[0].a)) strait.width = 0;
    return strait;
}

// Calls add(width, between) for what is narrower than `enough`, m, among the houses of a site and the walls round it.
template <typename Add>
void find_gaps(const Scene& scene, double enough, Add&& add) {
    constexpr double touching = 1e-6;  // m
    std::vector<Plan> plans;
    for (const House& house : scene.site->houses) plans.push_back(plan_of(house));
    std::sort(plans.begin(), plans.end(), [](const Plan& a, const Plan& b) { return a.x.lo < b.x.lo; });
    const auto note = [&](double width, const std::string& between) {
        if (width > touching) add(width, between);
    };
    const auto in_house = [&](const MapPoint& p) {
        return std::any_of(plans.begin(), plans.end(), [&](const Plan& plan) {
            return plan.x.lo <= p.x && p.x <= plan.x.hi && contains(*plan.polygon, p);
        });
    };
    for (std::size_t i = 0; i < plans.size(); ++i) {
        const Plan& one = plans[i];
        for (std::size_t k = i + 1; k < plans.size() && plans[k].x.lo < one.x.hi + enough; ++k) {
            if (free_between(one.z, plans[k].z) >= enough) continue;
            const Strait strait = strait_between(one, plans[k]);
            if (strait.width < enough && !in_house(strait.middle))
                note(strait.width, one.name + " and " + plans[k].name);
        }
        note(one.x.lo, one.name + " and the site's edge at x 0");
        note(one.z.lo, one.name + " and the site's edge at z 0");
        note(scene.world->length - one.x.hi,
             one.name + " and the site's edge at x " + short_number(scene.world->length));
        note(scene.world->width - one.z.hi, one.name + " and the site's edge at z " + short_number(scene.world->width));
    }
}

void check_in_world(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const Interval world_x{0, scene.world->length}, world_z{0, scene.world->width};
    if (within(channel.x, world_x) && within(channel.z, world_z)) return;
    refuse(source, "/channel",
           "the channel at x " + words(channel.x) + ", z " + words(channel.z) +
               " reaches outside the world; allowed: x " + words(world_x) + ", z " + words(world_z) + ".");
}

}  // namespace

std::vector<std::string> narrow_gaps(const Scene& scene) {
    const Channel& channel = scene.channel;
    const bool has_particles = scene.fluid->model == ModelKind::dfsph || scene.fluid->model == ModelKind::mixed;
    if (!has_particles || (!scene.site && channel.flow == Flow::closed && channel.water_blocks.empty())) return {};
    std::vector<Gap> gaps;
    // What rounding adds to a gap that is just wide enough is no fault of it.
    const double enough = (1 - 1e-6) * spacings_in_a_gap * scene.fluid->particle_spacing;
    const auto add = [&](double width, const std::string& between) {
        if (width > 0 && width < enough) gaps.push_back({width, between});
    };
    if (scene.site) find_gaps(scene, enough, add);
    const std::vector<Obstacle>& obstacles = scene.obstacles;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
        const std::string name = "/obstacles/" + std::to_string(i);
        const Obstacle& one = obstacles[i];
        for (std::size_t k = i + 1; k < obstacles.size(); ++k) {
            const std::string both = name + " and /obstacles/" + std::to_string(k);
            if (overlap(one.z, obstacles[k].z)) add(free_between(one.x, obstacles[k].x), both);
            if (overlap(one.x, obstacles[k].x)) add(free_between(one.z, obstacles[k].z), both);
        }
        if (channel.sides == Sides::walls) {
            add(one.z.lo - channel.z.lo, name + " and the bank at z_min_m");
            add(channel.z.hi - one.z.hi, name + " and the bank at z_max_m");
        }
        if (channel.flow == Flow::closed) {
            add(one.x.lo - channel.x.lo, name + " and the end at x_min_m");
            add(channel.x.hi - one.x.hi, name + " and the end at x_max_m");
        }
    }
    std::stable_sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.width < b.width; });
    constexpr std::size_t enough_to_read = 5;
    const std::size_t named = std::min(gaps.size(), enough_to_read);
    std::vector<std::string> sentences;
    sentences.reserve(named + 1);
    for (std::size_t k = 0; k < named; ++k) {
        const Gap& gap = gaps[k];
        sentences.push_back("the gap of " + short_number(gap.width) + " m between " + gap.between + " is " +
                            short_number(gap.width / scene.fluid->particle_spacing) +
                            " particle spacings wide and chokes the water; it needs /fluid/particle_spacing_m <= " +
                            short_number(gap.width / spacings_in_a_gap) + ".");
    }
    if (gaps.size() > named) {
        sentences.push_back(std::to_string(gaps.size() - named) + " more gaps are narrower than " +
                            short_number(spacings_in_a_gap) + " particle spacings.");
    }
    return sentences;
}

void check_geometry(const Scene& scene, const std::string& source, Problems& problems) {
    const Channel& channel = scene.channel;
    problems.attempt([&] { check_interval(channel.x, "x", source, "/channel"); });
    problems.attempt([&] { check_interval(channel.z, "z", source, "/channel"); });
    if (!problems.none()) return;
    problems.attempt([&] { check_in_world(scene, source); });

    std::vector<Box> boxes;
    const auto check = [&](const Box& box, const std::string& what) {
        boxes.push_back(box);
        problems.attempt([&] {
            check_box(box, what, scene, source);
            check_apart(boxes, source);
        });
    };
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
        const Obstacle& obstacle = scene.obstacles[i];
        check({obstacle.x, {0, obstacle.height}, obstacle.z, "/obstacles/" + std::to_string(i)}, "the obstacle");
    }
    for (std::size_t i = 0; i < channel.water_blocks.size(); ++i) {
        const WaterBlock& block = channel.water_blocks[i];
        const Interval y{block.y_min, block.y_min + block.depth};
        check({block.x, y, block.z, "/channel/water_blocks/" + std::to_string(i)}, "the block of water");
    }
    if (problems.none()) problems.attempt([&] { check_obstacles_near_ends(scene, source); });
}

}  // namespace wade
