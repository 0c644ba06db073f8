// Walking people with bodies: at their own speed, round corners, to their own exit, at any step rate.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cases.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "crowd_route.hpp"
#include "crowd_trips.hpp"

namespace wade::validation {
namespace {

const std::vector<std::string> with_bodies{"/crowd/bodies=human", "/crowd/markers=redrawn",
                                           "/crowd/navigation/rule=travel_time", "/crowd/navigation/cell_m=0.2"};

// Tests 1 and 7: a person walks 40 m alone, at the limits of the guideline's ages and at the speed of test 1.
Result run_walks(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    double worst = 0, error_of_test_1 = 0;
    Curve speeds{"speed", {"desired_speed_m_s", "speed_m_s", "exact_speed_m_s"}, {}};
    for (const double desired : {0.46, 0.58, 0.68, 0.76, 1.33, 1.41, 1.54, 1.61}) {
        Scene scene = people_scene(request, "crowd_rimea_01.json", 1, with_bodies);
        scene.duration = 150;
        scene.crowd->groups.at(0).desired_speed = desired;
        crowd::CrowdWorld crowd = crowd::make_crowd(scene);
        const Gate line{{41, 1}, {41, 3}, {1, 0}};
        const double speed = 40 / walk_past(crowd, {line}, result, tally).passed_at[0];
        const double error = std::abs(speed / desired - 1);
        worst = worse(worst, error);
        if (desired == 1.33) error_of_test_1 = error;
        speeds.rows.push_back({desired, speed, desired});
    }
    result.metrics = {{"speed_error", worst, "1"}, {"speed_error_of_test_1", error_of_test_1, "1"}};
    report_tally(tally, result);
    result.curves = {speeds};
    return result;
}

// Tests 6 and 15.

// 500 people walk 20 m abreast past the line at the end of a corridor: straight, `length` m long; with a corner if it is 0,
// 50 m along its inner wall and 90 m along its outer one.
crowd::CrowdWorld large_crowd(const Request& request, double length) {
    Scene scene = people_scene(request, "crowd_opening.json", 1);
    constexpr double width = 20, inner = 10, leg = 60, beyond = 15;  // m
    const bool straight = length > 0;
    scene.duration = 400;
    scene.world->width = width + (straight ? 0 : inner + beyond);
    scene.world->length = (straight ? length + beyond : leg);
    // The corner: along x from leg to 0, then along z; the box fills what lies inside.
    scene.obstacles.clear();
    AgentGroup& group = scene.crowd->groups.at(0);
    group.columns = 20, group.rows = 25, group.count = 500;
    group.pitch_x = 0.9, group.pitch_z = 0.78;
    group.start_z = 0.6;
    group.start_x = straight ? 1 : leg - 19;
    group.goal_x = straight ? scene.world->length - 1 : width / 2;
    group.goal_z = straight ? width / 2 : scene.world->width - 1;
    if (!straight) scene.obstacles.push_back({{width, leg}, {width, scene.world->width}, 3});
    return crowd::make_crowd(scene);
}

Result run_corner(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    crowd::CrowdWorld twenty = crowd::make_crowd(people_scene(request, "crowd_rimea_06.json", 1, with_bodies));
    const std::vector<Gate> end{{{11, 12.5}, {13, 12.5}, {0, 1}}};
    const std::vector<double> times = times_of(twenty, walk_past(twenty, end, result, tally));
    result.metrics = {{"last_time_of_20", times.empty() ? 0 : times.back(), "s"}};
    if (request.level > 0) {
        std::array<double, 3> last{};
        Curve curve;
        std::vector<std::vector<double>> out;
        for (const auto& [k, length] : {std::pair{0, 50.0}, std::pair{1, 0.0}, std::pair{2, 90.0}}) {
            crowd::CrowdWorld crowd = large_crowd(request, length);
            const Gate line = length > 0 ? Gate{{length, 0}, {length, 20}, {1, 0}} : Gate{{0, 30}, {20, 30}, {0, 1}};
            out.push_back(times_of(crowd, walk_past(crowd, {line}, result, tally)));
            last[static_cast<std::size_t>(k)] =
                out.back().size() == 500 ? out.back().back() : std::numeric_limits<double>::quiet_NaN();
        }
        result.metrics.push_back({"last_time_short", last[0], "s"});
        result.metrics.push_back({"last_time_corner", last[1], "s"});
        result.metrics.push_back({"last_time_long", last[2], "s"});
        result.metrics.push_back({"corner_outside", worse(worse(0, last[0] - last[1]), last[1] - last[2]), "s"});
        result.curves = {curve_of_leaving("people_through", {"short", "corner", "long"}, out, 1)};
    }
    report_tally(tally, result);
    return result;
}

// Test 9: 1000 people leave by four doors, then by two. Each quarter of the room has its door.
Scene exits(const Request& request, bool four) {
    Scene scene = people_scene(request, "crowd_rimea_09.json", 1, with_bodies);
    const AgentGroup all = scene.crowd->groups.at(0);
    scene.crowd->goal_radius = 1;
    scene.crowd->groups.clear();
    for (const bool low : {true, false}) {
        for (const double door : {10.5, 25.5}) {
            AgentGroup quarter = all;
            quarter.name = std::string(low ? "low_" : "high_") + (door < 18 ? "west" : "east");
            quarter.columns = 20;
            quarter.rows = low ? 12 : 13;
            quarter.count = quarter.columns * quarter.rows;
            if (door > 18) quarter.start_x += 20 * all.pitch_x;
            if (!low) quarter.start_z += 12 * all.pitch_z;
            quarter.goal_x = door;
            quarter.goal_z = low && four ? 1 : 25;
            scene.crowd->groups.push_back(quarter);
        }
    }
    if (!four) {
        for (const double x : {10.0, 25.0}) scene.obstacles.push_back({{x, x + 1}, {2, 3}, 3});
    }
    return scene;
}

Result run_exits(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    std::vector<std::vector<double>> out;
    for (const bool four : {true, false}) {
        crowd::CrowdWorld crowd = crowd::make_crowd(exits(request, four));
        const Gate low{{0, 2}, {36, 2}, {0, -1}}, high{{0, 24}, {36, 24}, {0, 1}};
        const Gate first = four ? low : high;
        const Trip trip = walk_past(crowd, {first, first, high, high}, result, tally);
        std::vector<double> times;
        for (const double t : trip.passed_at) {
            if (!std::isnan(t)) times.push_back(t);
        }
        std::sort(times.begin(), times.end());
        out.push_back(times);
    }
    const auto of_95 = [](const std::vector<double>& times) {
        return times.size() < 950 ? std::numeric_limits<double>::quiet_NaN() : times[949];
    };
    result.metrics = {
        {"time_of_95_percent_four_doors", of_95(out[0]), "s"},
        {"time_of_95_percent_two_doors", of_95(out[1]), "s"},
        {"ratio_of_times_of_95_percent", of_95(out[1]) / of_95(out[0]), "1"},
    };
    report_tally(tally, result);
    result.curves = {curve_of_leaving("people_outside", {"four_doors", "two_doors"}, out, 2)};
    return result;
}

// Test 10: twelve cabins of 3 x 3 m on both sides of a corridor 2 m wide, the exits at its ends. Cabins are counted along
// one side and then along the other.
Scene cabins(const Request& request) {
    Scene scene = people_scene(request, "crowd_opening.json", 1);
    constexpr double cabin = 3, wall = 0.2, door = 0.9, lobby = 4;  // m
    constexpr int of_a_side = 6;
    const double end = lobby + of_a_side * cabin;
    scene.world->length = end + lobby;
    scene.world->width = 2 * cabin + 2;
    scene.crowd->goal_radius = 1;
    scene.obstacles.clear();
    scene.crowd->groups.clear();
    for (int k = 0; k < 2 * of_a_side; ++k) {
        const bool low = k < of_a_side;
        const double x = lobby + (k % of_a_side) * cabin;
        const Interval rows = low ? Interval{0, cabin} : Interval{cabin + 2, 2 * cabin + 2};
        const Interval front = low ? Interval{cabin - wall, cabin} : Interval{cabin + 2, cabin + 2 + wall};
        scene.obstacles.push_back({{x, x + wall}, rows, 3});
        if (k % of_a_side + 1 == of_a_side) scene.obstacles.push_back({{end, end + wall}, rows, 3});
        scene.obstacles.push_back({{x, x + (cabin - door) / 2}, front, 3});
        scene.obstacles.push_back({{x + (cabin + door) / 2, x + cabin}, front, 3});
        const bool main_exit = k < 4 || (k >= 6 && k < 10);
        AgentGroup group;
        group.name = "cabin_" + std::to_string(k + 1);
        group.columns = k == 11 ? 1 : 2, group.rows = 1, group.count = group.columns;
        group.start_x = x + 1, group.pitch_x = 1, group.start_z = rows.lo + 1.4;
        group.goal_x = main_exit ? scene.world->length - 1.5 : 1.5;
        group.goal_z = cabin + 1;
        group.desired_speed = 1.2;
        scene.crowd->groups.push_back(group);
    }
    return scene;
}

Result run_cabins(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    crowd::CrowdWorld crowd = crowd::make_crowd(cabins(request));
    std::vector<Gate> lines;
    for (const AgentGroup& group : crowd.scene.crowd->groups) {
        const bool main_exit = group.goal_x > crowd.scene.world->length / 2;
        lines.push_back(main_exit ? Gate{{23, 3}, {23, 5}, {1, 0}} : Gate{{3, 5}, {3, 3}, {-1, 0}});
    }
    const Trip trip = walk_past(crowd, lines, result, tally);
    result.metrics = {{"people", static_cast<double>(crowd.agents.size()), "1"}, {"longest_time", trip.end, "s"}};
    report_tally(tally, result);
    return result;
}

// The same walk at any step rate: alone, and at 0.5 people/m2 in the corridor without ends.
Result run_step_rates(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    Curve speeds{"speed_by_step_rate_m_s", {"step_rate_Hz", "alone", "in_a_stream"}, {}};
    double alone_dependence = 0, stream_dependence = 0;
    std::array<double, 2> usual{};
    for (const double rate : {30.0, 0.5, 1.0, 2.0, 5.0, 10.0, 60.0}) {
        std::array<double, 2> speed{};
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
            Request at_rate = request;
            at_rate.overrides.insert(at_rate.overrides.begin(),
                                     {with_bodies[0], with_bodies[1], assign("/frame_rate_hz", rate)});
            crowd::CrowdWorld crowd = k == 0 ? crowd::make_crowd(people_scene(at_rate, "crowd_free.json", 1))
                                             : corridor_crowd(at_rate, SpeedRule::pi, 0.5, false);
            Overlaps unused;
            speed[k] = mean_progress(crowd, 60, result, unused, [&] { note_bodies(crowd, tally); });
        }
        if (rate == 30) usual = speed;
        alone_dependence = worse(alone_dependence, std::abs(speed[0] / usual[0] - 1));
        stream_dependence = worse(stream_dependence, std::abs(speed[1] / usual[1] - 1));
        speeds.rows.push_back({rate, speed[0], speed[1]});
    }
    std::sort(speeds.rows.begin(), speeds.rows.end());
    result.metrics = {{"dependence_alone", alone_dependence, "1"}, {"dependence_in_a_stream", stream_dependence, "1"}};
    report_tally(tally, result);
    result.curves = {speeds};
    return result;
}

}  // namespace

Case crowd_walks_case() {
    return {.name = "crowd_walks",
            .truth =
                "RiMEA tests 1 and 7, IMO tests 1 and 7: a person with a body walks 40 m of a corridor 2 m wide at the "
                "speed that "
                "it is given: the limits of the RiMEA guideline's ages (Weidmann 1992), 0.46 to 1.61 m/s.",
            .reference = "desired speed",
            .spacings = {0},
            .quick = true,
            .run = run_walks};
}

Case crowd_corner_case() {
    return {.name = "crowd_corner",
            .truth =
                "RiMEA tests 6 and 15: 20 people with bodies walk round a corner and not through the wall (coarse). "
                "500 walk in a "
                "corridor 20 m wide round a corner, 50 m along its inner wall and 90 m along its outer one; ideally "
                "their time lies "
                "between those of straight corridors of both lengths (medium).",
            .reference = "RiMEA tests 6 and 15",
            .spacings = {0, 0},
            .quick = true,
            .run = run_corner};
}

Case crowd_exits_case() {
    return {.name = "crowd_exits",
            .truth =
                "RiMEA and IMO test 9: 1000 people with bodies leave a room of 30 x 20 m by four doors of 1 m, then "
                "with two of "
                "them closed; the time should about double (documentation, no criterion to reject). Each quarter of "
                "the room "
                "is sent to the nearest open door.",
            .reference = "RiMEA test 9",
            .spacings = {0},
            .run = run_exits};
}

Case crowd_cabins_case() {
    return {.name = "crowd_cabins",
            .truth =
                "RiMEA and IMO test 10: 23 people in twelve cabins are assigned exits, those of the cabins 1 to 4 and "
                "7 to 10 the "
                "main one; each leaves by his own. Cabins of 3 x 3 m with doors of 0.9 m, corridor 2 m wide.",
            .reference = "RiMEA test 10",
            .spacings = {0},
            .quick = true,
            .run = run_cabins};
}

Case crowd_step_rates_case() {
    return {.name = "crowd_step_rates",
            .truth =
                "People with bodies walk as fast at 0.5 to 60 steps a second as at 30, alone and in a stream of 0.5 "
                "people/m2.",
            .reference = "30 Hz",
            .spacings = {0},
            .quick = true,
            .run = run_step_rates};
}

}  // namespace wade::validation
