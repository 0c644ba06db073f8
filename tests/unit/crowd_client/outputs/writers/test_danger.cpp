#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <sstream>

#include "configs/scene/channel.hpp"
#include "crowd_client/outputs/writers/danger.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;
using wade::crowd::testing::one_agent_scene;

namespace {

// A channel of two cells of 2 x 2 m, side by side along x from (10, 20), and an agent in the first cell.
Scene two_cells() {
    Scene scene = one_agent_scene(11, 21, 75, 50, 0.5);
    scene.channel->x = {10, 14};
    scene.channel->z = {20, 22};
    return scene;
}

// depth: m; speed: m/s, towards -x; in the first cell.
MadeUpWater water_of(double depth, double speed) {
    MadeUpWater water;
    water.add(10.5, 20.5, 4000 * depth, -speed, 0);
    return water;
}

struct Recorded {
    Agents agents;
    DangerRecord record;
    std::vector<std::uint32_t> active{0};

    Recorded(const Scene& scene, double window) : agents(make_agents(scene)), record(scene, agents.size(), window) {}
    void add(const MadeUpWater& water, int times = 1) {
        for (int i = 0; i < times; ++i) record.add(agents, active, water.view());
    }
};

}  // namespace

TEST_CASE("Levels of danger begin at the bounds of Table 2, inclusive") {
    CHECK(danger_level(0, 0) == DangerLevel::none);
    CHECK(danger_level(0.01, 0) == DangerLevel::low);
    CHECK(danger_level(1, 0.499) == DangerLevel::low);
    CHECK(danger_level(1, 0.5) == DangerLevel::moderate);
    CHECK(danger_level(1, 0.749) == DangerLevel::moderate);
    CHECK(danger_level(1, 0.75) == DangerLevel::high);
    CHECK(danger_level(1, 0.999) == DangerLevel::high);
    CHECK(danger_level(1, 1) == DangerLevel::very_high);
    CHECK(danger_level(2, 50) == DangerLevel::very_high);
    CHECK(danger_name(DangerLevel::very_high) == "very_high");
}

TEST_CASE("A level is that of the mean over a block, not of its worst step") {
    Recorded run(two_cells(), 2.0 / 30);  // blocks of two steps
    run.add(water_of(1.25, 0.8));         // 1 m2/s
    run.add(water_of(0.75, 0.8));         // 0.6 m2/s: the mean is 0.8
    run.record.close();
    const Exposure& cell = run.record.cells()[0];
    CHECK(cell.largest == DangerLevel::high);
    CHECK(cell.max_depth == Approx(1));  // rounding of floats in the water
    CHECK(cell.max_speed == Approx(0.8));
    CHECK(cell.max_depth_speed == Approx(0.8));
    CHECK(run.record.agents()[0].largest == DangerLevel::high);
    CHECK(run.record.agents()[0].steps == cell.steps);
    CHECK(cell.steps == std::array<std::uint64_t, danger_levels>{0, 0, 0, 2, 0});
    CHECK(run.record.cells()[1].largest == DangerLevel::none);
}

TEST_CASE("Water that goes to and fro within a block has no discharge") {
    Recorded run(two_cells(), 2.0 / 30);
    run.add(water_of(1, 2));
    run.add(water_of(1, -2));
    CHECK(run.record.cells()[0].largest == DangerLevel::low);
    CHECK(run.record.cells()[0].max_depth_speed == 0);
}

TEST_CASE("The largest level stays, and time is counted in each") {
    Recorded run(two_cells(), 1.0 / 30);
    run.add(water_of(0, 0), 5);
    run.add(water_of(1, 2), 4);
    run.add(water_of(1, 0.25), 3);
    const Exposure& met = run.record.agents()[0];
    CHECK(met.largest == DangerLevel::very_high);
    CHECK(met.steps == std::array<std::uint64_t, danger_levels>{5, 3, 0, 0, 4});
    CHECK(exposure_times(met, 0.5) == "2.5,1.5,0,0,2");
}

TEST_CASE("A short last block has the level of the block before, or its own if it is alone") {
    Recorded run(two_cells(), 3.0 / 30);
    run.add(water_of(1, 0.25), 3);
    run.add(water_of(1, 2), 2);
    run.record.close();
    CHECK(run.record.agents()[0].largest == DangerLevel::low);
    CHECK(run.record.agents()[0].steps == std::array<std::uint64_t, danger_levels>{0, 5, 0, 0, 0});

    Recorded brief(two_cells(), 3.0 / 30);
    brief.add(water_of(1, 2));
    brief.record.close();
    brief.record.close();  // nothing is counted twice
    CHECK(brief.record.agents()[0].steps == std::array<std::uint64_t, danger_levels>{0, 0, 0, 0, 1});
}

TEST_CASE("An agent meets the water where it stands, none on the bank, and nothing more once it has ended") {
    Recorded run(two_cells(), 1.0 / 30);
    run.agents.position[0] = {13, 21};  // the second cell
    run.add(water_of(1, 2));
    run.agents.position[0] = {11, 22.01};  // the bank
    run.add(water_of(1, 2));
    CHECK(run.record.agents()[0].steps == std::array<std::uint64_t, danger_levels>{2, 0, 0, 0, 0});
    run.active.clear();
    run.agents.position[0] = {11, 21};
    run.add(water_of(1, 2));
    CHECK(run.record.agents()[0].largest == DangerLevel::none);
}

TEST_CASE("Cells fill the channel exactly") {
    Channel channel;
    channel.x = {0, 100};
    channel.z = {11.5, 38.5};
    const GroundCells grid = danger_grid(channel);
    CHECK(grid.columns == 50);
    CHECK(grid.rows == 14);
    CHECK(grid.step_x == 2);
    CHECK(grid.step_z * 14 == Approx(27));
    CHECK(grid.cell_of(0, 11.5) == 0);
    CHECK(grid.cell_of(99.9, 38.4) == 50 * 14 - 1);
    for (const Vector2d& p : {Vector2d(-0.1, 20), Vector2d(100, 20), Vector2d(5, 11.4), Vector2d(5, 38.5)}) {
        CHECK(grid.cell_of(p.x(), p.y()) == grid.columns * grid.rows);
    }
    channel.x.hi = channel.z.hi = 100000;
    const GroundCells large = danger_grid(channel);
    CHECK(large.columns * large.rows <= 1001000);  // a million up to the rounding of rows and columns
}

TEST_CASE("An obstacle takes its share of a cell") {
    Scene scene = two_cells();
    scene.obstacles.push_back({{11, 12}, {20, 22}, 1});
    Recorded half(scene, 1.0 / 30);
    half.add(water_of(0.5, 0.5));  // all of it in the half that is free: 1 m
    CHECK(half.record.cells()[0].max_depth == Approx(1));
    scene.obstacles[0].x = {10.1, 12};
    Recorded sliver(scene, 1.0 / 30);
    sliver.add(water_of(0.5, 0.5));
    CHECK(sliver.record.cells()[0].max_depth == Approx(0.5));
}

TEST_CASE("A lattice has its depth in every cell, whatever its spacing") {
    Scene scene = two_cells();
    scene.channel->x = {10, 22};
    scene.channel->z = {20, 26};
    const double d = 0.4;  // 5 particles along a cell
    for (const double offset : {0.05, 0.2, 0.37}) {
        Recorded run(scene, 1.0 / 30);
        MadeUpWater water;
        for (double x = 10 + offset; x < 22; x += d) {
            for (double z = 20 + 0.5 * d; z < 26; z += d) water.add(x, z, 1000 * d * d * d, -2, 0);
        }
        run.add(water);
        const GroundCells& grid = run.record.grid();
        for (std::size_t c = 0; c < grid.cells(); ++c) {
            const std::size_t column = c % grid.columns;
            if (column == 0 || column + 1 == grid.columns) continue;  // the lattice may end anywhere in it
            CHECK(run.record.cells()[c].max_depth == Approx(d));
            CHECK(run.record.cells()[c].max_depth_speed == Approx(2 * d));
        }
    }
}

TEST_CASE("A particle counts in the cells that it covers, and its water beside an obstacle not under it") {
    Scene scene = two_cells();
    scene.channel->x = {10, 16};
    scene.channel->z = {20, 24};
    MadeUpWater water;
    water.add(11.875, 21.75, 125, 0, 1);  // 0.5 m wide: 3/4 of it along x, all across in the first cell
    Recorded run(scene, 1.0 / 30);
    run.add(water);
    CHECK(run.record.cells()[0].max_depth == Approx(0.75 * 0.125 / 4));
    CHECK(run.record.cells()[1].max_depth == Approx(0.25 * 0.125 / 4));
    CHECK(run.record.cells()[1].max_depth_speed == Approx(0.25 * 0.125 / 4));
    for (std::size_t dry = 2; dry < 6; ++dry) CHECK(run.record.cells()[dry].largest == DangerLevel::none);

    scene.obstacles.push_back({{12, 14}, {20, 22}, 1});
    Recorded beside(scene, 1.0 / 30);
    beside.add(water);
    CHECK(beside.record.cells()[0].max_depth == Approx(0.125 / 4));
    CHECK(beside.record.cells()[1].largest == DangerLevel::none);
}

TEST_CASE("A particle of whatever mass at the corner of the channel counts in its cells, and no further") {
    Recorded run(two_cells(), 1.0 / 30);
    MadeUpWater water;
    for (const double mass : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) water.add(10, 20, mass, 1, 1);
    run.add(water);  // the sums of that cell alone are not finite
    CHECK(run.record.cells()[1].largest == DangerLevel::none);

    Scene scene = two_cells();
    scene.channel->x = {10, 90};
    Recorded heavy(scene, 1.0 / 30);
    MadeUpWater lump;
    lump.add(50, 21, 1e12, 0, 0);
    heavy.add(lump);
    const auto& cells = heavy.record.cells();
    CHECK(std::count_if(cells.begin(), cells.end(), [](const Exposure& e) { return e.max_depth > 0; }) == 8);
}

TEST_CASE("danger.csv has a line for each cell") {
    Recorded run(two_cells(), 1.0 / 30);
    run.add(water_of(1, 2), 30);
    CHECK(danger_csv(run.record) ==
          "x_min_m,x_max_m,z_min_m,z_max_m,danger_level,max_depth_m,max_speed_m_s,max_dv_m2_s,none_s,low_s,moderate_s,"
          "high_s,very_high_s\n"
          "10,12,20,22,very_high,1,2,2,0,0,0,0,1\n"
          "12,14,20,22,none,0,0,0,1,0,0,0,0\n");
}
