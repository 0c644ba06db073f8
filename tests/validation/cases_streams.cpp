// Opposing and crossing streams of people with bodies.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "cases.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_route.hpp"
#include "crowd_trips.hpp"

namespace wade::validation {
namespace {

using Times = std::vector<std::vector<double>>;

// Whole numbers of people in a group: as many as its grid has, then the grid's first ones.
void set_people(Scene& scene, std::size_t group, int people) {
    if (people == 0) {
        scene.crowd->groups.erase(scene.crowd->groups.begin() + static_cast<std::ptrdiff_t>(group));
        return;
    }
    AgentGroup& its = scene.crowd->groups.at(group);
    its.count = people;
    its.rows = std::min(its.rows, (people + its.columns - 1) / its.columns);
}

// IMO test 8. Desired speeds of people of 30 to 50 years, uniform from 1.41 to 1.54 m/s: RiMEA guideline, after Weidmann 1992
// (table 1 of Zhou, Klein and Mayer 2015, Validation of a Pedestrian Simulator with RiMEA Test Scenarios).
void draw_speeds(crowd::CrowdWorld& crowd) {
    constexpr std::uint64_t stream = 0x7370656564;  // apart from the marker streams, which are cell numbers
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        crowd.agents.desired_speed[id] = 1.41 + 0.13 * crowd::counter_uniform(crowd.scene.seed, stream, id);
    }
}

Result run_rooms(const Request& request) {
    const std::uint64_t seeds = request.level == 0 ? 2 : 10;
    Result result = crowd_result();
    Tally tally;
    Times first;
    std::vector<double> means;
    double longest = 0;
    for (const int against : {0, 10, 50, 100}) {
        std::vector<double> entered;  // room 2, by the last of the 100
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            Scene scene = people_scene(request, "crowd_rooms.json", seed);
            set_people(scene, 1, against);
            crowd::CrowdWorld crowd = crowd::make_crowd(scene);
            draw_speeds(crowd);
            const Trip trip =
                walk_past(crowd, {{{21, 5}, {21, 7}, {1, 0}}, {{11, 7}, {11, 5}, {-1, 0}}}, result, tally);
            const std::vector<double> times = times_of(crowd, trip);
            entered.push_back(times.size() == 100 ? times.back() : std::numeric_limits<double>::quiet_NaN());
            if (seed == 1) first.push_back(times);
            if (against == 100) longest = worse(longest, entered.back());
        }
        means.push_back(mean(entered));
        result.metrics.push_back({"time_against_" + std::to_string(against), means.back(), "s"});
    }
    double falls = 0;
    for (std::size_t k = 1; k < means.size(); ++k) {
        falls = worse(falls, means[k - 1] - means[k]);
    }
    result.metrics.push_back({"longest_time_against_100", longest, "s"});
    result.metrics.push_back({"time_falls_with_people", falls, "s"});
    report_tally(tally, result);
    result.curves = {curve_of_leaving("people_in_the_other_room",
                                      {"against_0", "against_10", "against_50", "against_100"}, first, 1)};
    return result;
}

// Two blocks meet in a corridor 4 m wide.
Scene blocks(const Request& request, std::uint64_t seed, int people) {
    Scene scene = people_scene(request, "crowd_rooms.json", seed);
    constexpr double pitch = 0.7;  // m, 2 people/m2
    constexpr int abreast = 5;
    const int deep = people / abreast;
    const double block = deep * pitch, gap = 10;  // m
    scene.world->length = 2 * (block + gap) + gap + 4;
    scene.world->width = 6;
    scene.obstacles = {
        {{0, scene.world->length}, {0, 1}, 3}, {{0, scene.world->length}, {5, 6}, 3}, {{0, 1}, {1, 5}, 3}};
    for (const int k : {0, 1}) {
        AgentGroup& group = scene.crowd->groups.at(static_cast<std::size_t>(k));
        group.columns = deep, group.rows = abreast, group.count = people;
        group.pitch_x = pitch, group.pitch_z = 0.75;
        group.start_x = k == 0 ? gap : scene.world->length - gap - block + pitch;
        group.start_z = 1.5;
        group.goal_x = k == 0 ? scene.world->length - 2.5 : 3.5;
        group.goal_z = 3;
    }
    return scene;
}

Result run_blocks(const Request& request) {
    const std::uint64_t seeds = request.level == 0 ? 1 : 5;
    Result result = crowd_result();
    Tally tally;
    for (const int people : {150, 250}) {
        double longest = 0;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            crowd::CrowdWorld crowd = crowd::make_crowd(blocks(request, seed, people));
            const double middle = crowd.scene.world->length / 2, beyond = 5;  // m past the middle: apart again
            const Trip trip = walk_past(crowd,
                                        {{{middle + beyond, 1}, {middle + beyond, 5}, {1, 0}},
                                         {{middle - beyond, 5}, {middle - beyond, 1}, {-1, 0}}},
                                        result, tally);
            longest = std::max(longest, trip.end);
        }
        result.metrics.push_back({"longest_time_" + std::to_string(people), longest, "s"});
    }
    report_tally(tally, result);
    return result;
}

// A door that 100 people pass in one direction and 50 in the other.
Result run_two_way_doors(const Request& request) {
    const std::uint64_t seeds = request.level == 0 ? 1 : 5;
    Result result = crowd_result();
    Tally tally;
    for (const double width : {1.0, 1.2, 1.5}) {
        double longest = 0;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            Scene scene = people_scene(request, "crowd_rooms.json", seed);
            scene.obstacles.resize(4);
            scene.obstacles.push_back({{15.9, 16.1}, {1, 6 - width / 2}, 3});
            scene.obstacles.push_back({{15.9, 16.1}, {6 + width / 2, 11}, 3});
            set_people(scene, 1, 50);
            crowd::CrowdWorld crowd = crowd::make_crowd(scene);
            const Trip trip =
                walk_past(crowd, {{{16.5, 5}, {16.5, 7}, {1, 0}}, {{15.5, 7}, {15.5, 5}, {-1, 0}}}, result, tally);
            longest = std::max(longest, trip.end);
        }
        char name[40];
        std::snprintf(name, sizeof name, "longest_time_%.0f_cm", 100 * width);
        result.metrics.push_back({name, longest, "s"});
    }
    report_tally(tally, result);
    return result;
}

// Two streams that cross at a right angle, and two that become one.
Result run_crossing(const Request& request) {
    const std::uint64_t seeds = request.level == 0 ? 1 : 5;
    Result result = crowd_result();
    Tally tally;
    Times first;
    std::vector<double> detours, flows;
    double longest = 0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        crowd::CrowdWorld crossing = crowd::make_crowd(people_scene(request, "crowd_crossing.json", seed));
        const std::vector<crowd::Vector2d> start = crossing.agents.position;
        const Trip trip =
            walk_past(crossing, {{{26, 18}, {26, 22}, {1, 0}}, {{22, 26}, {18, 26}, {0, 1}}}, result, tally);
        for (std::size_t id = 0; id < start.size(); ++id) {
            const double way = 26 - (crossing.agents.group[id] == 0 ? start[id].x() : start[id].y());
            detours.push_back(trip.passed_at[id] * crossing.agents.desired_speed[id] / way);
        }
        longest = std::max(longest, trip.end);
        crowd::CrowdWorld junction = crowd::make_crowd(people_scene(request, "crowd_junction.json", seed));
        const Trip together = walk_past(junction, {{{37.4, 8}, {35, 8}, {0, 1}}}, result, tally);
        std::vector<double> out = times_of(junction, together, 0);
        const std::vector<double> others = times_of(junction, together, 1);
        if (seed == 1) first = {out, others};
        out.insert(out.end(), others.begin(), others.end());
        std::sort(out.begin(), out.end());
        flows.push_back(middle_flow(out) / 2.4);
    }
    result.metrics = {
        {"time_over_free_time_crossing", mean(detours), "1"},
        {"longest_time_crossing", longest, "s"},
        {"specific_flow_junction", mean(flows), "1/(m s)"},
    };
    report_tally(tally, result);
    result.curves = {curve_of_leaving("people_through_the_junction", {"from_the_west", "from_the_east"}, first, 1)};
    return result;
}

// Two people exactly opposite each other in a corridor 2 m wide.
Result run_head_on(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    for (const char* bodies : {"none", "human", "fast"}) {
        double longest = 0;
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            Scene scene = people_scene(request, "crowd_rooms.json", seed, {std::string("/crowd/bodies=") + bodies});
            for (AgentGroup& group : scene.crowd->groups) {
                group.columns = group.rows = group.count = 1;
                group.start_jitter = 0;
                group.start_x = group.goal_x < 16 ? 21 : 11;
                group.start_z = group.goal_z;
            }
            crowd::CrowdWorld crowd = crowd::make_crowd(scene);
            Tally points;
            const Trip trip = walk_past(crowd, {{{20, 5}, {20, 7}, {1, 0}}, {{12, 7}, {12, 5}, {-1, 0}}}, result,
                                        crowd::has_bodies(crowd) ? tally : points);
            tally.left_behind = std::max(tally.left_behind, points.left_behind);
            const double free_time = 9 / crowd.agents.desired_speed[0];
            for (const double time : trip.passed_at) longest = worse(longest, time / free_time);
        }
        result.metrics.push_back({std::string("time_over_free_time_") + bodies, longest, "1"});
    }
    report_tally(tally, result);
    return result;
}

// A corridor with people in both directions, beside a corridor with people in one direction.
Result run_two_way(const Request& request) {
    const double time = request.level == 0 ? 60 : 300;  // s
    Request with_bodies = request;
    with_bodies.overrides.insert(with_bodies.overrides.begin(), {"/crowd/bodies=human", "/crowd/markers=redrawn"});
    const std::vector<double> densities = request.level == 0 ? std::vector<double>{1, 2} : std::vector<double>{1, 2, 3};
    Result result = crowd_result();
    Tally tally;
    double outside = 0;
    Curve speeds{"speed_by_density_m_s", {"density_per_m2", "two_way", "one_way", "exact_Weidmann"}, {}};
    const std::uint64_t seeds = request.level == 0 ? 1 : 5;
    constexpr double begin = 30, end = 30;  // s
    for (const double density : densities) {
        double speed[2] = {0, 0}, last[2] = {0, 0};
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            Request with_seed = with_bodies;
            with_seed.overrides.push_back("/seed=" + std::to_string(seed));
            for (const bool two_ways : {false, true}) {
                crowd::CrowdWorld crowd = corridor_crowd(with_seed, SpeedRule::pi, density, two_ways, four_metres);
                Overlaps unused;
                const auto walk = [&](double seconds) {
                    if (!(seconds > 0)) return 0.0;
                    return seconds * mean_progress(crowd, seconds, result, unused, [&] { note_bodies(crowd, tally); });
                };
                walk(begin);
                const double before = walk(time - begin - end), at_end = walk(end);
                speed[two_ways] += (before + at_end) / (time - begin) / static_cast<double>(seeds);
                last[two_ways] += at_end / end / static_cast<double>(seeds);
            }
        }
        const double ratio = speed[1] / speed[0];
        outside = worse(worse(outside, 0.5 - std::min(ratio, last[1] / last[0])), ratio - 1.05);
        speeds.rows.push_back({density, speed[1], speed[0], weidmann_speed(density)});
        result.metrics.push_back({"ratio_of_speeds_" + std::to_string(std::lround(density)), ratio, "1"});
    }
    result.metrics.push_back({"ratio_outside", outside, "1"});
    report_tally(tally, result);
    result.curves = {speeds};
    return result;
}

}  // namespace

Case crowd_rooms_case() {
    return {.name = "crowd_rooms",
            .truth =
                "IMO MSC.1/Circ.1533, test 8 (ISO 20414: counter-flow): 100 people go from one room of 10 x 10 m "
                "through a corridor "
                "of 2 x 10 m into another, against 0, 10, 50 and 100 who come from there; people of 30 to 50 years, "
                "1.41 to 1.54 m/s. "
                "The time of the last one grows with the number who come the other way. Beyond the guideline: against "
                "100 it is "
                "at most 120 s. Time of the entry into the other room. coarse: 2 seeds; medium: 10.",
            .reference = "IMO test 8",
            .spacings = {0, 0},
            .quick = true,
            .run = run_rooms};
}

Case crowd_blocks_case() {
    return {
        .name = "crowd_blocks",
        .truth =
            "Two blocks of 150, and of 250, people at 2 people/m2 meet in a corridor 4 m wide and pass through each "
            "other. coarse: 1 seed; medium: 5.",
        .reference = "all pass",
        .spacings = {0, 0},
        .run = run_blocks};
}

Case crowd_two_way_doors_case() {
    return {
        .name = "crowd_two_way_doors",
        .truth =
            "100 people pass a door of 1.0, 1.2 and 1.5 m in a wall 0.2 m thick one way, 50 the other. coarse: 1 seed; "
            "medium: 5.",
        .reference = "all pass",
        .spacings = {0, 0},
        .quick = true,
        .run = run_two_way_doors};
}

Case crowd_crossing_case() {
    return {.name = "crowd_crossing",
            .truth =
                "Two streams of 100 people cross at a right angle in corridors 4 m wide, and two of 100 meet head on "
                "in a corridor "
                "2.4 m wide and leave it together by a third (a T-junction): all get through. Flow of the middle 80 % "
                "behind the "
                "junction. coarse: 1 seed; medium: 5.",
            .reference = "all pass",
            .spacings = {0, 0},
            .quick = true,
            .run = run_crossing};
}

Case crowd_head_on_case() {
    return {
        .name = "crowd_head_on",
        .truth =
            "Two people exactly opposite each other in a corridor 2 m wide pass each other: without bodies and redrawn "
            "markers, `human` and `fast`. The longest time of ten seeds over that of who meets nobody.",
        .reference = "they pass",
        .spacings = {0},
        .quick = true,
        .run = run_head_on};
}

Case crowd_two_way_case() {
    return {
        .name = "crowd_two_way",
        .truth =
            "Half of the people walk one way in a corridor 4 m wide that repeats after 20 m, half the other, 300 s: at "
            "0.5 "
            "to 1.05 times the speed of as many who all walk one way, without a lock. Measured two-way flow is the "
            "slower one above 1 person/m2 (Zhang and Seyfried 2012). Speeds after the first 30 s, and, for a lock, "
            "of the last 30 s. coarse: 60 s, 1 and 2 people/m2; medium: 300 s, 1 to 3, means of five seeds.",
        .reference = "0.5 to 1.05",
        .spacings = {0, 0},
        .quick = true,
        .run = run_two_way};
}

}  // namespace wade::validation
