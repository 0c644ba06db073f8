#include "tests/bench/beside_rvo2.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "configs/scene/crowd.hpp"
#include "tests/bench/crossing_crowd.hpp"

namespace wade::bench {
namespace {

constexpr double density = 0.7;            // people per m2
constexpr double radius = 0.25;            // m
constexpr std::size_t goals_written = 64;  // a person; more than any person reaches

// What a run gives, of either side.
struct Outcome {
    double cpu = 0;         // of the steps, s
    double mean_speed = 0;  // m/s
    double goals = 0;       // reached by all
    double overlaps = 0;    // pairs of discs, summed over steps
    double deepest = 0;     // m
};

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Crossing crossing_of(std::size_t people, BodyRule bodies, double step_rate) {
    Crowd settings;
    settings.markers = MarkerRule::redrawn;
    settings.bodies = bodies;
    settings.step_rate = step_rate;
    return make_crossing(people, density, settings);
}

Outcome run_ours(std::size_t people, BodyRule bodies, double step_rate, double seconds) {
    Crossing crossing = crossing_of(people, bodies, step_rate);
    const auto steps = static_cast<int>(std::lround(seconds * step_rate));
    Outcome outcome;
    Overlaps overlaps;
    for (int k = 0; k < steps; ++k) {
        const double start = cpu_seconds();
        walk(crossing);
        outcome.cpu += cpu_seconds() - start;
        for (const crowd::Vector2d& v : crossing.crowd.agents.velocity) outcome.mean_speed += v.norm();
        add_overlaps(crossing.crowd.agents, radius, overlaps);
    }
    outcome.mean_speed /= static_cast<double>(people) * steps;
    for (const std::uint32_t reached : crossing.goals_reached) outcome.goals += reached;
    outcome.overlaps = static_cast<double>(overlaps.pairs);
    outcome.deepest = overlaps.deepest;
    return outcome;
}

// A file that goes with the object.
struct TemporaryFile {
    std::string name = "/tmp/wade-rvo2-XXXXXX";
    TemporaryFile() {
        const int file = mkstemp(name.data());
        if (file < 0) throw std::runtime_error("cannot write " + name);
        close(file);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() { std::remove(name.c_str()); }
};

void write_task(const std::string& file, std::size_t people, double step, double seconds) {
    const Crossing crossing = crossing_of(people, BodyRule::human, 30);
    const crowd::Agents& agents = crossing.crowd.agents;
    std::ofstream out(file);
    out.precision(9);
    out << people << ' ' << goals_written << ' ' << seconds << ' ' << step << ' ' << radius << ' '
        << agents.desired_speed[0] << ' ' << goal_reach << '\n';
    for (std::size_t id = 0; id < people; ++id) {
        out << agents.position[id].x() << ' ' << agents.position[id].y();
        for (std::uint32_t draw = 0; draw < goals_written; ++draw) {
            const crowd::Vector2d goal = goal_drawn(crossing, id, draw);
            out << ' ' << goal.x() << ' ' << goal.y();
        }
        out << '\n';
    }
    if (!out.flush()) throw std::runtime_error("cannot write " + file + ": is the disk full?");
}

Outcome run_rvo2(const std::string& program, const std::string& options, std::size_t people, double step,
                 double seconds) {
    const TemporaryFile task, answer;
    write_task(task.name, people, step, seconds);
    const std::string command = "'" + program + "' " + options + " < '" + task.name + "' > '" + answer.name + "'";
    if (std::system(command.c_str()) != 0) {
        throw std::runtime_error("--rvo2 " + program + " failed; it is to be built from tools/rvo2/crossing.cpp");
    }
    std::ifstream in(answer.name);
    Outcome outcome;
    if (!(in >> outcome.cpu >> outcome.mean_speed >> outcome.goals >> outcome.overlaps >> outcome.deepest)) {
        throw std::runtime_error("--rvo2 " + program +
                                 " printed no result; it is to be built from tools/rvo2/crossing.cpp");
    }
    return outcome;
}

void show(const std::string& who, std::size_t people, double step_rate, double seconds, const Outcome& outcome,
          std::vector<Result>& results) {
    const double cost = outcome.cpu / seconds;
    const double goals = outcome.goals / static_cast<double>(people) / (seconds / 60);
    std::printf("  %8zu  %-18s %7.4g Hz %14.4g %12.3f %14.2f %12.0f %12.3f\n", people, who.c_str(), step_rate, cost,
                outcome.mean_speed, goals, outcome.overlaps, outcome.deepest);
    std::fflush(stdout);
    std::ostringstream name;
    name << "crowd/crossing " << who << ' ' << step_rate << " Hz";
    results.push_back({name.str(),
                       people,
                       1,
                       cost,
                       cost,
                       cost,
                       "cpu_s_per_simulated_s",
                       {{"mean_speed_m_s", outcome.mean_speed},
                        {"goals_per_agent_and_minute", goals},
                        {"overlapping_pair_steps", outcome.overlaps},
                        {"deepest_overlap_m", outcome.deepest}}});
}

}  // namespace

void show_beside_rvo2(const std::string& program, bool quick, std::vector<Result>& results) {
    std::printf("\nBeside RVO2: crossing goals, %.1f people/m2, the same starts and goals, one thread\n", density);
    std::printf("  %8s  %-18s %10s %14s %12s %14s %12s %12s\n", "agents", "who", "steps", "CPU s / s", "speed m/s",
                "goals a min.", "overlaps", "deepest m");
    for (const std::size_t people : {std::size_t{1000}, std::size_t{10000}}) {
        if (quick && people > 1000) break;
        const double seconds = quick ? 30 : people > 1000 ? 60 : 300;
        // Its usual step, with the neighbours of its examples and with fewer, which get it further at first; its examples' step.
        const std::string few = "--neighbours 5 --horizon 1";
        show("RVO2", people, 10, seconds, run_rvo2(program, "", people, 0.1, seconds), results);
        show("RVO2, 5 neighbours", people, 10, seconds, run_rvo2(program, few, people, 0.1, seconds), results);
        show("RVO2, 5 neighbours", people, 4, seconds, run_rvo2(program, few, people, 0.25, seconds), results);
        for (const double rate : {30.0, 15.0, 10.0, 8.5}) {
            show("fast", people, rate, seconds, run_ours(people, BodyRule::fast, rate, seconds), results);
            show("human", people, rate, seconds, run_ours(people, BodyRule::human, rate, seconds), results);
        }
    }
}

}  // namespace wade::bench
