// bench_crowd [--quick] [--quality | --boxes | --rvo2 PROGRAM] [--json FILE]: steps of agents a second on a plane with
// crossing goals, and how well they get on there; with --boxes, among 0 to 1,000 boxes; with --rvo2, cost and quality beside
// RVO2 (tools/rvo2/crossing.cpp).
//
// Times are those of the process on its processors, so that other work on the machine disturbs them little; shown are
// medians over rounds.

#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <stdexcept>
#include <string>

#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "tests/bench/bench_report.hpp"
#include "tests/bench/beside_rvo2.hpp"
#include "tests/bench/crossing_crowd.hpp"

namespace {

using namespace wade;
using namespace wade::bench;

constexpr double density = 0.7;  // people per m2

struct Options {
    bool quick = false;
    bool quality = false;
    bool boxes = false;
    std::string json, rvo2;
};

struct Variant {
    const char* name;  // behind crowd/open_plane
    const char* title;
    Crowd settings;
};

std::vector<Variant> variants() {
    Crowd redrawn;
    redrawn.markers = MarkerRule::redrawn;
    Crowd fast = redrawn, human = redrawn;
    fast.bodies = BodyRule::fast;
    human.bodies = BodyRule::human;
    return {{"", "BioCrowds, markers redrawn", redrawn},
            {" fixed markers", "BioCrowds, fixed markers", {}},
            {" bodies fast", "Bodies: fast", fast},
            {" bodies human", "Bodies: human", human}};
}

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Agent-steps a second of each round, after the crowd has left its start grid.
std::vector<double> measure(Crossing& crossing, const Options& options) {
    const int warm_up = 60, rounds = options.quick ? 3 : 9;
    const double least_time = options.quick ? 0.1 : 0.4;  // s a round
    for (int k = 0; k < warm_up; ++k) walk(crossing);
    std::vector<double> rates;
    for (int round = 0; round < rounds; ++round) {
        const double start = cpu_seconds();
        double steps = 0;
        while (cpu_seconds() - start < least_time || steps < 3) {
            walk(crossing);
            ++steps;
        }
        rates.push_back(steps * static_cast<double>(crossing.crowd.agents.size()) / (cpu_seconds() - start));
    }
    return rates;
}

void show_speed(const Variant& variant, const Options& options, std::vector<Result>& results) {
    std::printf("\n%s, %.1f people/m2, crossing goals, one thread\n", variant.title, density);
    std::printf("  %8s %18s %14s %14s %22s\n", "agents", "agent-steps/s", "smallest", "largest",
                "pair tests/agent-step");
    for (const std::size_t people : {std::size_t{50}, std::size_t{1000}, std::size_t{10000}, std::size_t{100000}}) {
        Crossing crossing = make_crossing(people, density, variant.settings);
        const Result r = result_of(std::string("crowd/open_plane") + variant.name, people, 1,
                                   measure(crossing, options), "agent_steps_per_s");
        const double tests = static_cast<double>(crossing.crowd.motion.pair_tests) / static_cast<double>(people);
        std::printf("  %8zu %18.4g %14.4g %14.4g %22.0f\n", people, r.median, r.min, r.max, tests);
        std::fflush(stdout);
        results.push_back(r);
        results.push_back({r.name + " pair tests", people, 1, tests, tests, tests, "1/agent_step"});
    }
}

// Distance to the goal, m.
double rest_of_way(const Crossing& crossing, std::size_t id) {
    return (crossing.crowd.agents.goal[id] - crossing.crowd.agents.position[id]).norm();
}

void show_quality(const Variant& variant, std::vector<Result>& results) {
    constexpr std::size_t people = 1000;
    constexpr double time = 300, last = 60, radius = 0.25;
    Crossing crossing = make_crossing(people, density, variant.settings);
    const double dt = crossing.crowd.dt;
    const auto steps = static_cast<int>(time / dt + 0.5), late = static_cast<int>((time - last) / dt + 0.5);
    double speed = 0, speed_late = 0, progress = 0;
    Overlaps overlaps;
    std::vector<double> before(people);
    std::vector<crowd::Vector2d> goal_before;
    for (int k = 0; k < steps; ++k) {
        for (std::size_t id = 0; id < people; ++id) before[id] = rest_of_way(crossing, id);
        goal_before = crossing.crowd.agents.goal;
        walk(crossing);
        for (std::size_t id = 0; id < people; ++id) {
            const double v = crossing.crowd.agents.velocity[id].norm();
            speed += v;
            if (k >= late) speed_late += v;
            progress += (before[id] - (goal_before[id] - crossing.crowd.agents.position[id]).norm()) / dt;
        }
        add_overlaps(crossing.crowd.agents, radius, overlaps);
    }
    double goals = 0;
    for (const std::uint32_t reached : crossing.goals_reached) goals += reached;
    const double samples = static_cast<double>(people) * steps;
    const std::string name = std::string("crowd/open_plane") + variant.name + " ";
    const auto show = [&](const char* what, double value, const char* unit) {
        std::printf("  %-34s %12.4g %s\n", what, value, unit);
        results.push_back({name + what, people, 1, value, value, value, unit});
    };
    std::printf("\n%s, %zu agents, %.1f people/m2, crossing goals, %.0f s\n", variant.title, people, density, time);
    show("mean speed", speed / samples, "m/s");
    show("mean speed in the last minute", speed_late / (people * last / dt), "m/s");
    show("progress to the goal", progress / samples, "m/s");
    show("goals per agent and minute", goals / people / (time / 60), "1/min");
    show("overlapping pair-steps", static_cast<double>(overlaps.pairs), "");
    show("deepest overlap", overlaps.deepest, "m");
}

// Leads all agents to one corner, by routes round the boxes.
void lead_round(Crossing& crossing) {
    Scene scene = crossing.crowd.scene;
    scene.crowd->navigation.rule = NavigationRule::automatic;
    scene.crowd->groups[0].goal_x = scene.world->length;
    scene.crowd->groups[0].goal_z = scene.world->width;
    crossing.crowd = crowd::make_crowd(scene);
}

// What a step costs among more and more boxes; the speed of the people at the end, and how many of them are inside a box.
void show_boxes(const Variant& variant, bool led, const Options& options, std::vector<Result>& results) {
    constexpr std::size_t people = 10'000;
    const std::string name = std::string("crowd/boxes") + variant.name + (led ? " led round" : "");
    std::printf("\n%s, %zu agents, %.1f people/m2, %s among boxes of 1 x 1 m\n", variant.title, people, density,
                led ? "led to one goal" : "straight to crossing goals");
    std::printf("  %8s %16s %10s %10s %12s %18s %8s\n", "boxes", "ns/agent-step", "smallest", "largest", "times none",
                "speed, m/s", "inside");
    const std::size_t counts[] = {0, 25, 100, 1000};
    std::vector<Crossing> crossings;
    for (const std::size_t boxes : counts)
        crossings.push_back(make_crossing(people, density, variant.settings, 1, boxes));
    for (Crossing& crossing : crossings)
        if (led) lead_round(crossing);
    // In turns, so that a disturbed moment disturbs all.
    std::vector<std::vector<double>> costs(crossings.size());
    for (Crossing& crossing : crossings)
        for (int k = 0; k < 30; ++k) walk(crossing);
    for (int round = 0; round < (options.quick ? 3 : 15); ++round) {
        for (std::size_t i = 0; i < crossings.size(); ++i) {
            constexpr int steps = 10;
            const double start = cpu_seconds();
            for (int k = 0; k < steps; ++k) walk(crossings[i]);
            costs[i].push_back(1e9 * (cpu_seconds() - start) / (steps * people));
        }
    }
    for (std::size_t i = 0; i < crossings.size(); ++i) {
        const Crossing& crossing = crossings[i];
        Result r = result_of(name, counts[i], 1, costs[i], "ns_per_agent_step");
        double speed = 0, inside = 0;
        for (const crowd::Vector2d& v : crossing.crowd.agents.velocity) speed += v.norm() / people;
        for (const crowd::Vector2d& p : crossing.crowd.agents.position)
            for (const Obstacle& box : crossing.crowd.scene.obstacles)
                if (box.x.lo < p.x() && p.x() < box.x.hi && box.z.lo < p.y() && p.y() < box.z.hi) ++inside;
        const double ratio = r.median / (i == 0 ? r.median : results[results.size() - i].median);
        r.extra = {{"times_none", ratio}, {"speed_m_s", speed}, {"inside", inside}};
        std::printf("  %8zu %16.1f %10.1f %10.1f %12.2f %18.2f %8.0f\n", counts[i], r.median, r.min, r.max, ratio,
                    speed, inside);
        results.push_back(r);
    }
}

Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--quick") == 0)
            options.quick = true;
        else if (std::strcmp(argv[i], "--quality") == 0)
            options.quality = true;
        else if (std::strcmp(argv[i], "--boxes") == 0)
            options.boxes = true;
        else if (std::strcmp(argv[i], "--json") == 0 && i + 1 < argc)
            options.json = argv[++i];
        else if (std::strcmp(argv[i], "--rvo2") == 0 && i + 1 < argc)
            options.rvo2 = argv[++i];
        else
            throw std::invalid_argument(std::string("unexpected argument ") + argv[i] +
                                        "; allowed: --quick, --quality, --boxes, --rvo2 PROGRAM, --json FILE");
    }
    return options;
}

void run(const Options& options) {
    std::vector<Result> results;
    std::printf("%s\n", machine().c_str());
    if (!options.rvo2.empty()) show_beside_rvo2(options.rvo2, options.quick, results);
    for (const Variant& variant : variants()) {
        if (!options.rvo2.empty()) break;
        if (options.boxes)
            show_boxes(variant, false, options, results);
        else if (options.quality)
            show_quality(variant, results);
        else
            show_speed(variant, options, results);
    }
    if (options.boxes) show_boxes(variants()[0], true, options, results);
    if (!options.json.empty()) write_json(options.json, results);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(parse(argc, argv));
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_crowd: %s\n", error.what());
        return dynamic_cast<const std::invalid_argument*>(&error) != nullptr ? 2 : 1;
    }
}
