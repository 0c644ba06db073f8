// Ends of a world: a world periodic along x, and people between the end walls of a closed channel, at any position and
// in either direction.

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;
using wade::crowd::testing::uniform_water;

namespace {

constexpr double ring_length = 20;

Scene ring_scene(double start_x, double start_z, double goal_x, double goal_z, double tau = 0) {
    Scene scene = one_agent_scene(start_x, start_z, goal_x, goal_z, tau);
    scene.world->length = ring_length;
    scene.world->width = 10;
    scene.world->ends = Ends::periodic;
    return scene;
}

double distance_on_ring(double x1, double z1, double x2, double z2) {
    const double dx = x1 - x2;
    return std::hypot(dx - ring_length * std::round(dx / ring_length), z1 - z2);
}

}  // namespace

TEST_CASE("Markers of a periodic world stand once and keep their distance across the joint") {
    const Markers markers = place_markers(ring_scene(1, 1, 2, 2));
    CHECK(markers.size() == 64 * 10 * static_cast<std::size_t>(markers.grid.rows));
    double smallest = 1e9;
    for (std::size_t i = 0; i < markers.size(); ++i) {
        REQUIRE((markers.x[i] >= 0 && markers.x[i] < ring_length));
        for (std::size_t j = i + 1; j < markers.size(); ++j) {
            smallest = std::min(smallest, distance_on_ring(markers.x[i], markers.z[i], markers.x[j], markers.z[j]));
        }
    }
    CHECK(smallest >= 0.1);
}

TEST_CASE("On a ring each marker belongs to the nearest walker, also across the joint") {
    const Scene scene = ring_scene(1, 1, 2, 2);
    const Markers markers = place_markers(scene);
    std::vector<Vector2d> walkers{{0, 3}, {std::nextafter(ring_length, 0.0), 5}};  // the ends themselves
    for (int i = 0; i < 40; ++i) {
        walkers.emplace_back(std::fmod(i * ring_length * 0.6180339887, ring_length),
                             std::fmod(i * 10 * 0.7548776662, 10.0));
    }
    Motion motion;
    MarkerMemory memory;
    const std::vector<Vector2d> goal_offsets(walkers.size(), Vector2d(10, 0));
    Walkers w;
    w.position = walkers;
    w.goal_offset = goal_offsets;
    find_motion(motion, memory, markers, w, 1.7, ring_length);
    std::vector<std::uint32_t> count(walkers.size(), 0);
    for (std::size_t m = 0; m < markers.size(); ++m) {
        std::size_t owner = walkers.size();
        double best = 1.7;
        for (std::size_t k = 0; k < walkers.size(); ++k) {
            const double d = distance_on_ring(markers.x[m], markers.z[m], walkers[k].x(), walkers[k].y());
            if (d < best) {
                best = d;
                owner = k;
            }
        }
        if (owner < walkers.size()) ++count[owner];
    }
    CHECK(motion.owned == count);
    for (const Vector2d& m : motion.vector) CHECK(m.norm() <= 1.7);
}

TEST_CASE("A run on a ring does not know where the joint is") {
    // Markers and people are moved along the ring, by a number of cells so that all coordinates stay exact in pairs.
    Scene scene = ring_scene(2, 2, 100000, 5);
    AgentGroup& group = scene.crowd->groups[0];
    group.columns = 9;
    group.rows = 6;
    group.count = 54;
    group.pitch_x = 2;
    group.pitch_z = 1;
    CrowdWorld still = make_crowd(scene);
    for (std::size_t m = 0; m < still.markers.size(); ++m) {
        still.markers.x[m] = std::ldexp(std::round(std::ldexp(still.markers.x[m], 20)), -20);
    }
    CrowdWorld moved = still;
    constexpr int cells = 3;
    const GroundGrid& grid = still.markers.grid;
    moved.markers.x.clear();
    moved.markers.z.clear();
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            moved.markers.cell_start[grid.index(column, row)] = static_cast<std::uint32_t>(moved.markers.x.size());
            if (column == 0 || column > 10) continue;
            const int from = (column - 1 + 10 - cells) % 10 + 1;
            const std::size_t cell = grid.index(from, row);
            for (std::size_t m = still.markers.cell_start[cell]; m < still.markers.cell_start[cell + 1]; ++m) {
                const double x = still.markers.x[m] + 2 * cells;
                moved.markers.x.push_back(from > 10 - cells ? x - ring_length : x);
                moved.markers.z.push_back(still.markers.z[m]);
            }
        }
    }
    for (Vector2d& p : moved.agents.position) p.x() = std::fmod(p.x() + 2 * cells, ring_length);
    for (std::size_t id = 0; id < still.agents.size(); ++id) {
        if (still.agents.position[id].x() + 2 * cells >= ring_length) moved.agents.laps[id] = 1;
        moved.agents.goal[id].x() += 2 * cells;
    }
    for (int i = 0; i < 300; ++i) {
        step(still, {});
        step(moved, {});
    }
    double worst = 0;
    for (std::size_t id = 0; id < still.agents.size(); ++id) {
        const double x = still.agents.position[id].x() + still.agents.laps[id] * ring_length + 2 * cells;
        worst = std::max(worst, std::abs(moved.agents.position[id].x() + moved.agents.laps[id] * ring_length - x));
        worst = std::max(worst, std::abs(moved.agents.position[id].y() - still.agents.position[id].y()));
    }
    CHECK(still.agents.laps != std::vector<std::int32_t>(54, 0));
    CHECK(worst <= 1e-9);  // sums in another order round at 1e-16 m a step
}

TEST_CASE("A goal beyond the end is reached after as many laps") {
    for (const double goal_x : {2 * ring_length + 15, -2 * ring_length + 5}) {
        CrowdWorld crowd = make_crowd(ring_scene(10, 5, goal_x, 5));
        while (!crowd.active.empty() && crowd.steps < 30 * 60) step(crowd, {});
        REQUIRE(crowd.agents.outcome[0] == Outcome::arrived);
        CHECK(crowd.agents.laps[0] == (goal_x > 0 ? 2 : -2));
        const double way = std::abs(goal_x - 10) - 3;  // it arrives 3 m before
        CHECK(crowd.agents.path_length[0] >= way - 1e-9);
        const double time = static_cast<double>(crowd.last_arrival_step) / 30;
        CHECK(time >= way / 1.3 - 1e-9);
        CHECK(time <= way / 1.3 * 1.2);
        CHECK((crowd.agents.position[0].x() >= 0 && crowd.agents.position[0].x() < ring_length));
    }
}

TEST_CASE("A block at the joint stops people from both sides") {
    for (const bool at_start : {true, false}) {
        Scene scene = ring_scene(10, 5, at_start ? 60 : -60, 5);
        scene.obstacles.push_back({at_start ? Interval{0, 1} : Interval{ring_length - 1, ring_length}, {0, 10}, 3});
        CrowdWorld crowd = make_crowd(scene);
        for (int i = 0; i < 900; ++i) {
            step(crowd, {});
            const double x = crowd.agents.position[0].x();
            REQUIRE((at_start ? x >= 1 : x <= ring_length - 1));
        }
        CHECK(crowd.agents.laps[0] == 0);
        CHECK(crowd.agents.path_length[0] > 5);
    }
}

TEST_CASE("Water carries an agent over the end of a ring, and touches it across the joint") {
    CrowdWorld crowd = make_crowd(ring_scene(0.5, 5, 15, 5, 1));
    const MadeUpWater stream = uniform_water(0, ring_length, 0, 10, 1, 0.25, -6, 0);
    const WaterView view = stream.view();
    for (int i = 0; i < 30; ++i) step(crowd, view);
    CHECK(crowd.agents.outcome[0] == Outcome::active);
    CHECK(crowd.agents.laps[0] == -1);

    // The same contact at the joint as in the middle: the lattice repeats after 0.25 m.
    WaterBins bins;
    bins.grid = GroundGrid::over(crowd.scene.world);
    bins.period = ring_length;
    std::vector<WaterParticle> touching;
    const std::vector<Vector2d> places{{0.01, 5}, {10.01, 5}, {19.99, 5}, {9.99, 5}};
    bin_water(bins, view, places);
    const auto mass = [&](std::size_t k) { return find_contact(bins, places[k], 0.75, touching).mass; };
    CHECK(mass(0) == mass(1));
    CHECK(mass(2) == mass(3));
    CHECK(mass(0) > 0);
    CHECK(water_at(bins, places[0], 1000).depth == Approx(water_at(bins, places[1], 1000).depth).epsilon(1e-12));
}

namespace {

constexpr double length = 12, width = 4;  // of the channel, m

// A channel that begins at `x` in a world that ends as far behind it, and its mirror image.
struct Twin {
    double x = 0;
    bool mirrored = false;
    [[nodiscard]] double place(double along) const { return mirrored ? x + length - along : x + along; }
};

// Nine people near the end at position 0 walk to the other end.
Scene scene_of(const Twin& twin, BodyRule bodies, CouplingRule rule, std::uint64_t seed) {
    Scene scene;
    scene.seed = seed;
    scene.world = {.length = 2 * twin.x + length, .width = width};
    scene.channel->x = {twin.x, twin.x + length};
    scene.channel->z = {0, width};
    scene.channel->flow = Flow::closed;
    scene.coupling->rule = rule;
    scene.crowd->bodies = bodies;
    scene.crowd->markers = MarkerRule::redrawn;
    scene.crowd->goal_radius = 1.5;
    AgentGroup group;
    group.columns = group.rows = 3;
    group.count = 9;
    group.start_x = twin.place(0.3);
    group.pitch_x = twin.mirrored ? -1 : 1;
    group.start_z = 1;
    group.goal_x = twin.place(length - 1.5);
    group.goal_z = 0.5 * width;
    group.tau = 1;
    scene.crowd->groups.push_back(group);
    return scene;
}

// For the first seconds a wave of 3 m/s against the end; then the channel is dry.
std::vector<double> arrival_times(const Twin& twin, BodyRule bodies, CouplingRule rule, std::uint64_t seed) {
    CrowdWorld crowd = make_crowd(scene_of(twin, bodies, rule, seed));
    const MadeUpWater wave = uniform_water(twin.x, twin.x + length, 0, width, 1, 0.5, twin.mirrored ? 3 : -3, 0);
    const MadeUpWater none;
    for (int i = 0; i < 900 && !crowd.active.empty(); ++i) {
        step(crowd, i < 60 ? wave.view() : none.view());
        REQUIRE(crowd.dead == 0);
        for (const Vector2d& p : crowd.agents.position) REQUIRE(crowd.scene.channel->x.contains(p.x()));
    }
    REQUIRE(crowd.arrived == 9);
    std::vector<double> times;
    for (const std::uint64_t end : crowd.agents.end_step) times.push_back(static_cast<double>(end) * crowd.dt);
    return times;
}

struct Sample {
    double mean = 0, variance_of_mean = 0;
};

// Of the runs' mean times over ten seeds, s.
Sample sample_of(const Twin& twin, BodyRule bodies, CouplingRule rule) {
    constexpr int seeds = 10;
    double sum = 0, squares = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        double mean = 0;
        for (const double time : arrival_times(twin, bodies, rule, static_cast<std::uint64_t>(seed))) mean += time / 9;
        sum += mean;
        squares += mean * mean;
    }
    const double mean = sum / seeds;
    return {mean, (squares / seeds - mean * mean) / (seeds - 1)};
}

}  // namespace

TEST_CASE("A wave in a closed channel drowns nobody at its ends, and mirrored or moved it costs as much time") {
    const BodyRule bodies = GENERATE(BodyRule::none, BodyRule::fast, BodyRule::human);
    const CouplingRule rule = GENERATE(CouplingRule::per_frame, CouplingRule::continuous);
    const Sample first = sample_of({0, false}, bodies, rule);
    CHECK(first.mean > 2 + (length - 5) / 1.3);  // the wave held them up
    for (const Twin& twin : {Twin{0, true}, Twin{5, false}, Twin{5, true}}) {
        const Sample other = sample_of(twin, bodies, rule);
        // Two means of ten seeds differ by more than 3.9 times their standard error once in a thousand (Student's t with
        // 18 degrees of freedom); the first also by a step.
        const double scatter = std::sqrt(first.variance_of_mean + other.variance_of_mean);
        INFO("channel at " << twin.x << " m, mirrored " << twin.mirrored << ", standard error " << scatter << " s");
        CHECK(other.mean == Approx(first.mean).margin(3.9 * scatter));
    }
}

TEST_CASE("Where the water flows on, the same wave carries people over the fall") {
    Scene scene = scene_of({0, false}, GENERATE(BodyRule::none, BodyRule::fast), CouplingRule::per_frame, 1);
    scene.channel->flow = GENERATE(Flow::emitter, Flow::recirculating, Flow::periodic);
    CrowdWorld crowd = make_crowd(scene);
    const MadeUpWater wave = uniform_water(0, length, 0, width, 1, 0.5, -3, 0);
    for (int i = 0; i < 60; ++i) step(crowd, wave.view());
    CHECK(crowd.dead > 0);
}
