// What confines the water beside the banks: the top, planes without slip; and what acts on it: slope, friction, an inflow
// that changes. The bed's shape stands in scene_checks_bed.cpp.

#include <algorithm>
#include <array>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/time_lines.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

std::string item(const std::string& list, std::size_t i) {
    return "/channel/" + list + "/" + std::to_string(i);
}

void check_top(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    if (channel.top == Top::open) return;
    const auto check_below = [&](double surface, const std::string& what) {
        if (surface <= channel.height + rounding_tolerance) return;
        refuse(source, "/channel/height_m",
               short_number(channel.height) + " m is lower than " + what + ", which reaches up to " +
                   short_number(surface) + " m; allowed: >= " + short_number(surface) + " m.");
    };
    if (has_river(channel)) check_below(channel.depth, "the water of /channel/depth_m");
    for (std::size_t i = 0; i < channel.water_blocks.size(); ++i) {
        check_below(channel.water_blocks[i].y_min + channel.water_blocks[i].depth, item("water_blocks", i));
    }
    if (channel.top == Top::wall) return;
    if (scene.world->gravity != 0) {
        refuse(source, "/world/gravity_m_s2",
               short_number(scene.world->gravity) +
                   " m/s2 would let the water fall for ever, as /channel/top is \"periodic\" and there is no bed; "
                   "allowed: 0 m/s2.");
    }
    if (!scene.obstacles.empty()) {
        refuse(source, "/obstacles",
               "there is no bed on which an obstacle could stand where /channel/top is \"periodic\"; allowed: none.");
    }
}

struct PlaneFacts {
    Plane plane;
    std::array<bool, 3> across;  // axes along which the plane cannot move
};
constexpr std::array<PlaneFacts, 7> planes{{{Plane::bed, {false, true, false}},
                                            {Plane::top, {false, true, false}},
                                            {Plane::x_min, {true, false, false}},
                                            {Plane::x_max, {true, false, false}},
                                            {Plane::z_min, {false, false, true}},
                                            {Plane::z_max, {false, false, true}},
                                            {Plane::obstacles, {true, true, true}}}};

const PlaneFacts& facts_of(Plane plane) {
    return *std::find_if(planes.begin(), planes.end(), [&](const PlaneFacts& facts) { return facts.plane == plane; });
}

// Why a scene has no such plane; empty if it has.
std::string missing(Plane plane, const Scene& scene) {
    const Channel& channel = scene.channel;
    switch (plane) {
        case Plane::bed:
            return channel.top == Top::periodic ? "/channel/top is \"periodic\"" : "";
        case Plane::top:
            return channel.top != Top::wall ? "/channel/top is not \"wall\"" : "";
        case Plane::x_min:
        case Plane::x_max:
            return channel.flow != Flow::closed ? "/channel/flow is not \"closed\"" : "";
        case Plane::z_min:
        case Plane::z_max:
            return channel.sides != Sides::walls ? "/channel/sides is not \"walls\"" : "";
        case Plane::obstacles:
            return scene.obstacles.empty() ? "/obstacles is empty" : "";
    }
    return "";
}

void check_no_slip(const Scene& scene, const std::string& source) {
    static constexpr std::array<const char*, 3> axes{"x", "y", "z"};
    const std::vector<NoSlip>& list = scene.channel->no_slip;
    for (std::size_t i = 0; i < list.size(); ++i) {
        PlaneFacts facts = facts_of(list[i].plane);
        const std::string plane = quoted(facts.plane);
        const std::string pointer = item("no_slip", i);
        if (const std::string why = missing(facts.plane, scene); !why.empty()) {
            refuse(source, pointer + "/plane", "there is no plane " + plane + ", as " + why + ".");
        }
        for (std::size_t k = 0; k < i; ++k) {
            if (list[k].plane != facts.plane) continue;
            refuse(source, pointer + "/plane", plane + " has its velocity in " + item("no_slip", k) + " already.");
        }
        // A bed that is not level could not slide along x without moving through the water.
        if (facts.plane == Plane::bed && !scene.channel->bed_points.empty()) facts.across[0] = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!facts.across[axis] || list[i].velocity[axis] == 0) continue;
            refuse(source, pointer + "/velocity_" + axes[axis] + "_m_s",
                   short_number(list[i].velocity[axis]) + " m/s would move " + plane +
                       " into or out of the water; allowed: 0 m/s.");
        }
    }
    if (!list.empty() && !(scene.fluid->kinematic_viscosity > 0)) {
        refuse(source, "/channel/no_slip",
               "without viscosity a plane does not hold the water, so it has no effect; allowed: none, or "
               "/fluid/viscosity_m2_s > 0.");
    }
}

void check_slope_and_friction(const Channel& channel, const std::string& source) {
    if (channel.slope != 0 && channel.flow == Flow::recirculating) {
        refuse(
            source, "/channel/slope",
            short_number(channel.slope) +
                " has no effect in a recirculating channel, whose speed is held at velocity_m_s; allowed: 0, or flow "
                "\"periodic\".");
    }
    if (channel.top != Top::periodic) return;
    if (channel.slope != 0) {
        refuse(source, "/channel/slope",
               short_number(channel.slope) +
                   " has no effect where /channel/top is \"periodic\", as there is neither bed "
                   "nor gravity; allowed: 0.");
    }
    if (channel.manning_n != 0) {
        refuse(
            source, "/channel/manning_n",
            short_number(channel.manning_n) +
                " s/m^(1/3) is the friction of a bed, and there is none where /channel/top is \"periodic\"; allowed: "
                "0.");
    }
}

void check_velocity_history(const Channel& channel, const std::string& source) {
    const std::vector<VelocityPoint>& history = channel.velocity_history;
    if (history.empty()) return;
    if (channel.flow == Flow::closed || channel.flow == Flow::periodic) {
        refuse(source, "/channel/velocity_history",
               "nothing sets the speed of a " + name_of(channel.flow) +
                   " channel; allowed: none, or flow \"emitter\" or \"recirculating\".");
    }
    check_times(times_of(history), source, "/channel/velocity_history");
}

}  // namespace

void check_boundaries(const Scene& scene, const std::string& source, Problems& problems) {
    problems.attempt([&] { check_top(scene, source); });
    problems.attempt([&] { check_bed(scene, source); });
    problems.attempt([&] { check_no_slip(scene, source); });
    problems.attempt([&] { check_slope_and_friction(scene.channel, source); });
    problems.attempt([&] { check_velocity_history(scene.channel, source); });
}

}  // namespace wade
