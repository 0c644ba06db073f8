// People with bodies leave a room by one opening.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "cases.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_trips.hpp"

namespace wade::validation {
namespace {

constexpr double axis = 6;          // z of the middle of the opening, m
constexpr double wall_at = 9;       // x of its inner side, m
constexpr double thickness = 0.95;  // m

struct Opening {
    double width = 1;                          // m
    double thickness = validation::thickness;  // m
    int people = 150;
    std::string bodies = "human";
    double step_rate = 30;  // 1/s
    double cell = 0.2;      // of the travel-time field, m
    std::uint64_t seed = 1;
};

Scene scene_of(const Request& request, const Opening& opening) {
    Scene scene = people_scene(request, "crowd_opening.json", opening.seed,
                               {"/crowd/bodies=" + opening.bodies, assign("/frame_rate_hz", opening.step_rate),
                                assign("/crowd/navigation/cell_m", opening.cell)});
    for (Obstacle& side : scene.obstacles) {
        if (side.x.lo != wall_at) continue;
        side.x.hi = wall_at + opening.thickness;
        (side.z.lo < axis - 1 ? side.z.hi : side.z.lo) = axis + (side.z.lo < axis - 1 ? -0.5 : 0.5) * opening.width;
    }
    AgentGroup& group = scene.crowd->groups.at(0);
    group.rows = opening.people / group.columns;
    group.count = opening.people;
    group.pitch_z *= 15.0 / group.rows;
    return scene;
}

// Returns the times when people leave the opening, s, ascending.
std::vector<double> leave(const Request& request, const Opening& opening, Result& result, Tally& tally) {
    crowd::CrowdWorld crowd = crowd::make_crowd(scene_of(request, opening));
    const double outside = wall_at + opening.thickness;
    const Gate line{{outside, axis - opening.width / 2}, {outside, axis + opening.width / 2}, {1, 0}};
    return times_of(crowd, walk_past(crowd, {line}, result, tally));
}

// Mean flow of several seeds, people a second; NaN if one of the runs has none.
double mean_flow(const Request& request, Opening opening, std::uint64_t seeds, Result& result, Tally& tally) {
    std::vector<double> flows;
    for (opening.seed = 1; opening.seed <= seeds; ++opening.seed) {
        flows.push_back(middle_flow(leave(request, opening, result, tally)));
    }
    return mean(flows);
}

// Measured flows, people a second by width in m.
//   Kretz      T. Kretz, A. Gruenebohm, M. Schreckenberg, J. Stat. Mech. (2006) P10014: all runs
//   Liddle     J. Liddle et al., PED 2009 (arXiv:0911.4350): 150 people over the time that they took
//   both as listed in the tests of JuPedSim (test_13, runtest_rimea_12)
const std::multimap<double, double> kretz{{0.8, 1.388}, {0.8, 1.417}, {0.8, 1.456}, {0.9, 1.534}, {0.9, 1.583},
                                          {0.9, 1.632}, {1.0, 1.710}, {1.0, 1.808}, {1.0, 1.876}, {1.0, 2.023},
                                          {1.2, 2.033}, {1.2, 2.111}, {1.2, 2.287}};
const std::multimap<double, double> liddle{{0.9, 1.71}, {1.0, 2.02}, {1.1, 2.19},
                                           {1.2, 2.53}, {1.4, 2.91}, {1.6, 3.11}};

// Rows of width, ours, Kretz, Liddle, and 1.9 b of Seyfried et al., Transportation Science 43 (2009) 395, within 0.8 to 1.2 m.
Curve flow_curve(const std::vector<double>& widths, const std::vector<double>& flows) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    Curve curve{
        "flow",
        {"width_m", "people_per_second", "measured_Kretz_2006", "measured_Liddle_2009", "reference_Seyfried_2009"},
        {}};
    for (std::size_t k = 0; k < widths.size(); ++k) {
        curve.rows.push_back({widths[k], flows[k], none, none, widths[k] <= 1.2 ? 1.9 * widths[k] : none});
    }
    for (const auto& [width, flow] : kretz) curve.rows.push_back({width, none, flow, none, none});
    for (const auto& [width, flow] : liddle) curve.rows.push_back({width, none, none, flow, none});
    return curve;
}

// Largest relative distance of the flows of other settings from the flow of the usual one.
template <typename Vary, typename Values>
double dependence(const Request& request, std::uint64_t seeds, double usual, const Values& values, const Vary& vary,
                  Result& result, Tally& tally) {
    double largest = 0;
    for (const double value : values) {
        Opening other;
        vary(other, value);
        largest = worse(largest, std::abs(mean_flow(request, other, seeds, result, tally) / usual - 1));
    }
    return largest;
}

Result run_openings(const Request& request) {
    constexpr std::uint64_t seeds = 5;  // of two the means differ by up to 10 % where rounding alone differs
    const std::vector<double> widths{0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.6};
    Result result = crowd_result();
    Tally tally;
    std::vector<double> flows;
    for (const double width : widths) {
        flows.push_back(mean_flow(request, {.width = width}, seeds, result, tally));
    }
    double outside = 0, falls = 0, jumps = 0;
    for (std::size_t k = 0; k < widths.size(); ++k) {
        const double specific = flows[k] / widths[k];
        outside = worse(worse(outside, 1.6 - specific), specific - 2.2);
        char name[40];
        std::snprintf(name, sizeof name, "specific_flow_%.0f_cm", 100 * widths[k]);
        result.metrics.push_back({name, specific, "1/(m s)"});
        if (k == 0) continue;
        falls = worse(falls, flows[k - 1] - flows[k]);
        if (widths[k] - widths[k - 1] < 0.11) {
            jumps = worse(jumps, std::abs(specific / (flows[k - 1] / widths[k - 1]) - 1));
        }
    }
    const double usual = flows[2];
    const auto rates = request.level == 0 ? std::vector<double>{10} : std::vector<double>{10, 15, 60};
    const auto cells = request.level == 0 ? std::vector<double>{0.5} : std::vector<double>{0.1, 0.3, 0.5};
    result.metrics.push_back({"specific_flow_outside", outside, "1/(m s)"});
    result.metrics.push_back({"flow_falls_with_width", falls, "1/s"});
    result.metrics.push_back({"jump_in_specific_flow", jumps, "1"});
    result.metrics.push_back(
        {"step_rate_dependence",
         dependence(
             request, seeds, usual, rates, [](Opening& o, double v) { o.step_rate = v; }, result, tally),
         "1"});
    result.metrics.push_back(
        {"cell_dependence",
         dependence(
             request, seeds, usual, cells, [](Opening& o, double v) { o.cell = v; }, result, tally),
         "1"});
    report_tally(tally, result);
    result.curves = {flow_curve(widths, flows)};
    return result;
}

// Doors of all widths, with both kinds of bodies, at two step rates.
Result run_doors(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    Curve last{"last_one_out_s", {"width_m", "human_30_Hz", "human_10_Hz", "fast_30_Hz", "fast_10_Hz"}, {}};
    double locked = 0, runs = 0;
    std::vector<double> widths{0.62, 0.90, 0.96};  // m
    if (request.level > 0) widths.clear();
    const int step = request.level == 1 ? 5 : 1;  // of 0.02 m
    for (int k = 0; request.level > 0 && k <= 70; k += step) widths.push_back(0.6 + 0.02 * k);
    const std::uint64_t seeds = request.level == 0 ? 1 : request.level == 1 ? 2 : 5;
    for (const double width : widths) {
        std::vector<double> row{width};
        for (const char* bodies : {"human", "fast"}) {
            for (const double rate : {30.0, 10.0}) {
                double worst = 0;
                for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
                    const Opening door{.width = width,
                                       .thickness = 0.2,
                                       .people = 100,
                                       .bodies = bodies,
                                       .step_rate = rate,
                                       .seed = seed};
                    const std::vector<double> times = leave(request, door, result, tally);
                    const bool all = times.size() == 100;
                    worst = worse(worst, all ? times.back() : std::numeric_limits<double>::quiet_NaN());
                    locked += all ? 0 : 1;
                    runs += 1;
                }
                row.push_back(worst);
            }
        }
        last.rows.push_back(row);
    }
    result.metrics = {{"runs_that_lock", locked, "1"}, {"runs", runs, "1"}};
    report_tally(tally, result);
    result.curves = {last};
    return result;
}

// A lattice of water half a metre deep over the room and what lies behind it, all of one velocity towards the opening.
struct Stream {
    std::vector<float> mass, x, y, z, vx, vy, vz;

    Stream(const Scene& scene, double speed) {
        constexpr double spacing = 0.5;  // m
        for (double at_x = 1.25; at_x < scene.world->length; at_x += spacing) {
            for (double at_z = 0.25; at_z < scene.world->width; at_z += spacing) {
                x.push_back(static_cast<float>(at_x));
                z.push_back(static_cast<float>(at_z));
            }
        }
        y.assign(x.size(), 0.25F);
        mass.assign(x.size(), 125);
        vx.assign(x.size(), static_cast<float>(speed));
        vy.assign(x.size(), 0);
        vz.assign(x.size(), 0);
    }
    [[nodiscard]] crowd::WaterView view() const {
        crowd::WaterView view;
        view.mass = mass;
        view.px = x, view.py = y, view.pz = z;
        view.vx = vx, view.vy = vy, view.vz = vz;
        return view;
    }
};

Result run_pushed(const Request& request) {
    Result result = crowd_result();
    Tally tally;
    double dead = 0;
    for (const double speed : {1.5, 3.0, 8.0}) {
        double left = 0;  // the most of a run
        for (const double rate : {30.0, 10.0}) {
            for (const double width : {1.0, 2.0}) {
                Scene scene = scene_of(request, {.width = width, .people = 100, .step_rate = rate});
                scene.crowd->groups.at(0).tau = 0.8;
                crowd::CrowdWorld crowd = crowd::make_crowd(scene);
                const Stream stream(scene, speed);
                const Gate line{{wall_at + thickness, 0}, {wall_at + thickness, 1}, {1, 0}};
                const Trip trip = walk_past(crowd, {line}, result, tally, stream.view());
                left = std::max(left, 100 - static_cast<double>(times_of(crowd, trip).size()));
                dead += static_cast<double>(crowd.dead);
            }
        }
        char name[40];
        std::snprintf(name, sizeof name, "left_behind_%.0f_cm_s", 100 * speed);
        result.metrics.push_back({name, left, "1"});
    }
    result.metrics.push_back({"dead", dead, "1"});
    report_tally(tally, result);
    return result;
}

}  // namespace

Case crowd_openings_case() {
    return {
        .name = "crowd_openings",
        .truth =
            "RiMEA test 12 and the experiments behind it: 150 people with bodies `human` leave a room of 8 x 12 m by "
            "an "
            "opening of 0.8 to 1.6 m in a wall 0.95 m thick. Measured specific flows are 1.6 to 2.2 people/(m s): "
            "Kretz et al. "
            "2006 1.7 to 2.0, Seyfried et al. 2009 1.9, Liddle et al. 2009 1.9 to 2.1. Flow of the middle 80 % of the "
            "people. The flow grows with the width and depends neither on the step rate (10 to 60 Hz) nor on the cells "
            "of "
            "the ways (0.1 to 0.5 m). coarse: 2 seeds; medium: 5.",
        .reference = "1.6 to 2.2 1/(m s)",
        .spacings = {0, 0},
        .quick = true,
        .run = run_openings};
}

Case crowd_doors_case() {
    return {.name = "crowd_doors",
            .truth =
                "100 people leave a room by a door of 0.6 to 2.0 m in a wall 0.2 m thick, with bodies `human` and "
                "`fast`, at 30 "
                "and 10 steps a second: all get out in each run. coarse: 12 runs; medium: every 0.1 m, 2 seeds, 120 "
                "runs; fine: "
                "every 0.02 m, 5 seeds, 1420 runs.",
            .reference = "all leave",
            .spacings = {0, 0, 0},
            .quick = true,
            .run = run_doors};
}

Case crowd_pushed_case() {
    return {.name = "crowd_pushed",
            .truth =
                "Water of 1.5, 3 and 8 m/s presses 100 people of endurance 0.8 against a wall with a gap of 1 and 2 m, "
                "at 30 and "
                "10 steps a second. Bodies neither overlap nor enter the wall, and all get through.",
            .reference = "no overlap",
            .spacings = {0},
            .quick = true,
            .run = run_pushed};
}

}  // namespace wade::validation
