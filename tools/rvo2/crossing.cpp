// Lets RVO2 walk the crossing crowd of tests/bench, for `tools/wade bench --rvo2 PROGRAM`.
//
// RVO2 (https://gamma.cs.unc.edu/RVO2, Apache-2.0) is a library without a program of its own; nothing of it is part of this
// repository. Compile this file against one that you have installed or built, in its Release build:
//
//   g++ -std=c++17 -O3 -march=native -I RVO2/src tools/rvo2/crossing.cpp -L RVO2/build/src -lRVO -Wl,-rpath,RVO2/build/src -o crossing
//
// Standard input: one line `PEOPLE GOALS SECONDS STEP_S RADIUS_M SPEED_M_S REACH_M`, then a line a person: start, then GOALS
// goals, as x z pairs in m; who is within REACH_M of a goal takes the next. Standard output: one line `CPU_S MEAN_SPEED_M_S
// GOALS_REACHED OVERLAPPING_PAIR_STEPS DEEPEST_OVERLAP_M`; CPU_S is that of the steps, without measuring.
//
// Options: --neighbours N, --distance M and --horizon S of RVO2's agents [10, 5, 2]: as many neighbours as in its own examples,
// and their distance and time in units of a body and of a walker's speed.

#include <RVO.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iostream>
#include <vector>

namespace {

struct Options {
    std::size_t neighbours = 10;
    float distance = 5;  // m
    float horizon = 2;   // s
};

struct Task {
    std::size_t people = 0, goals = 0;
    double seconds = 0;
    float step = 0, radius = 0, speed = 0, reach = 0;
    std::vector<RVO::Vector2> start, goal;  // goal: `goals` of each person in turn
};

struct Overlaps {
    unsigned long long pairs = 0;
    double deepest = 0;  // m
};

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

RVO::Vector2 read_place() {
    float x = 0, z = 0;
    std::cin >> x >> z;
    return {x, z};
}

Task read_task() {
    Task task;
    std::cin >> task.people >> task.goals >> task.seconds >> task.step >> task.radius >> task.speed >> task.reach;
    for (std::size_t i = 0; std::cin && i < task.people; ++i) {
        task.start.push_back(read_place());
        for (std::size_t k = 0; k < task.goals; ++k) task.goal.push_back(read_place());
    }
    if (!std::cin || !(task.step > 0) || task.goals == 0) {
        std::cerr << "crossing: standard input is no task; it is meant for tools/wade bench --rvo2\n";
        std::exit(2);
    }
    return task;
}

void add_overlaps(const RVO::RVOSimulator& crowd, double radius, Overlaps& sum) {
    std::vector<RVO::Vector2> places;
    for (std::size_t i = 0; i < crowd.getNumAgents(); ++i) places.push_back(crowd.getAgentPosition(i));
    std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t j = i + 1; j < places.size() && places[j].x() - places[i].x() < 2 * radius; ++j) {
            const double distance = std::hypot(places[j].x() - places[i].x(), places[j].y() - places[i].y());
            if (distance >= 2 * radius) continue;
            ++sum.pairs;
            sum.deepest = std::max(sum.deepest, 2 * radius - distance);
        }
    }
}

Options read_options(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; i += 2) {
        const double value = i + 1 < argc ? std::atof(argv[i + 1]) : 0;
        if (value > 0 && std::strcmp(argv[i], "--neighbours") == 0)
            options.neighbours = static_cast<std::size_t>(value);
        else if (value > 0 && std::strcmp(argv[i], "--distance") == 0)
            options.distance = static_cast<float>(value);
        else if (value > 0 && std::strcmp(argv[i], "--horizon") == 0)
            options.horizon = static_cast<float>(value);
        else {
            std::cerr << "crossing: allowed: --neighbours N, --distance M, --horizon S, each above 0\n";
            std::exit(2);
        }
    }
    return options;
}

}  // namespace

int main(int argc, char** argv) {
    const Options options = read_options(argc, argv);
    const Task task = read_task();
    RVO::RVOSimulator crowd(task.step, options.distance, options.neighbours, options.horizon, options.horizon,
                            task.radius, task.speed);
    for (const RVO::Vector2& place : task.start) crowd.addAgent(place);
    std::vector<std::size_t> reached(task.people, 0);
    const auto goal_of = [&](std::size_t i) { return task.goal[i * task.goals + reached[i] % task.goals]; };
    const auto steps = static_cast<long>(std::lround(task.seconds / task.step));
    double cpu = 0, speed = 0;
    Overlaps overlaps;
    for (long k = 0; k < steps; ++k) {
        const double start = cpu_seconds();
        for (std::size_t i = 0; i < task.people; ++i) {
            if (RVO::abs(goal_of(i) - crowd.getAgentPosition(i)) < task.reach) ++reached[i];
            crowd.setAgentPrefVelocity(i, task.speed * RVO::normalize(goal_of(i) - crowd.getAgentPosition(i)));
        }
        crowd.doStep();
        cpu += cpu_seconds() - start;
        for (std::size_t i = 0; i < task.people; ++i) speed += RVO::abs(crowd.getAgentVelocity(i));
        add_overlaps(crowd, task.radius, overlaps);
    }
    std::size_t goals = 0;
    for (const std::size_t of_one : reached) goals += of_one;
    std::printf("%.6g %.6g %zu %llu %.6g\n", cpu, speed / static_cast<double>(task.people) / static_cast<double>(steps),
                goals, overlaps.pairs, overlaps.deepest);
}
