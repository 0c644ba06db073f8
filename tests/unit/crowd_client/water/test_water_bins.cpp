#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "configs/scene/coupling.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/water_bins.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::MadeUpWater;

namespace {

WaterBins bins_of(const MadeUpWater& water, const std::vector<Vector2d>& agents) {
    WaterBins bins;
    bins.grid = GroundGrid::over(World{});
    bin_water(bins, water.view(), agents);
    return bins;
}

Contact contact_of(const MadeUpWater& water, const Vector2d& agent, double distance) {
    std::vector<WaterParticle> touching;
    return find_contact(bins_of(water, {agent}), agent, distance, touching);
}

}  // namespace

TEST_CASE("The contact distance follows the rule") {
    Coupling coupling;
    CHECK(contact_distance(coupling) == 0.25);
    coupling.contact_rule = ContactRule::sum;
    CHECK(contact_distance(coupling) == 0.75);
    coupling.contact_rule = ContactRule::difference;
    std::swap(coupling.agent_radius, coupling.particle_radius);
    CHECK(contact_distance(coupling) == 0.25);
}

TEST_CASE("A particle touches if it is closer than the contact distance in the ground plane") {
    MadeUpWater water;
    water.add(10.25, 10, 100, -1, 2);  // exactly at the distance: no contact
    water.add(10.249, 10, 100, -1, 2);
    water.add(10, 9.751, 50, -2, 0);
    water.add(10.2, 10.2, 100, -1, 2);  // 0.283 m
    for (float& y : water.py) y = 7;    // height does not matter
    const Contact c = contact_of(water, {10, 10}, 0.25);
    CHECK(c.mass == 150);
    CHECK(c.momentum == Vector2d(-200, 200));
}

TEST_CASE("Contacts by cells are those of a search over all particles") {
    MadeUpWater water;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        water.add(104 * counter_uniform(1, 0, i) - 2, 54 * counter_uniform(1, 1, i) - 2, 1 + counter_uniform(1, 2, i),
                  counter_uniform(1, 3, i), counter_uniform(1, 4, i));
    }
    std::vector<Vector2d> agents{{0, 0}, {100, 50}, {0, 25}, {75, 50}, {2, 2}, {3.999, 4}, {100, 0}};
    for (std::uint64_t k = 0; k < 40; ++k)
        agents.emplace_back(100 * counter_uniform(2, 0, k), 50 * counter_uniform(2, 1, k));
    const WaterBins bins = bins_of(water, agents);
    for (const double distance : {0.25, 0.75, 2.0}) {
        for (const Vector2d& a : agents) {
            std::vector<WaterParticle> touching;
            const Contact c = find_contact(bins, a, distance, touching);
            std::size_t count = 0;
            double mass = 0;
            for (std::size_t i = 0; i < water.mass.size(); ++i) {
                const double dx = static_cast<double>(water.px[i]) - a.x();
                const double dz = static_cast<double>(water.pz[i]) - a.y();
                if (dx * dx + dz * dz >= distance * distance) continue;
                ++count;
                mass += static_cast<double>(water.mass[i]);
            }
            REQUIRE(touching.size() == count);
            // The same terms in another order.
            REQUIRE(c.mass == Approx(mass).epsilon(1e-12));
        }
    }
}

TEST_CASE("Only particles near an agent are kept, and a NaN position is left out") {
    MadeUpWater water;
    water.add(10, 10, 1, 0, 0);
    water.add(50, 10, 1, 0, 0);  // far from the agent
    water.add(std::numeric_limits<double>::quiet_NaN(), 10, 1, 0, 0);
    water.add(10, std::numeric_limits<double>::infinity(), 1, 0, 0);
    water.add(-1e30, 1e30, 1, 0, 0);
    const WaterBins bins = bins_of(water, {{10, 10}});
    CHECK(bins.mass.size() == 1);
    CHECK(bins.x[0] == 10);
}

TEST_CASE("The contact mass in a river does not depend on the resolution") {
    // rho h pi r^2 = 196.3 kg for r = 0.25 m in 1 m of water. An agent on a lattice of spacing d samples a disc by
    // about (r/d)^2 pi columns; the mean over positions is exact for a lattice.
    const double expected = 1000 * std::numbers::pi * 0.25 * 0.25;
    for (const double d : {0.5, 0.25, 0.125}) {
        const MadeUpWater water = testing::uniform_water(8, 16, 8, 16, 1, d, -1.5, 0);
        std::vector<Vector2d> agents;
        const int n = 20;  // positions along each side of one cell of the lattice
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) agents.emplace_back(12 + (i + 0.5) * d / n, 12 + (j + 0.5) * d / n);
        }
        const WaterBins bins = bins_of(water, agents);
        std::vector<WaterParticle> touching;
        double sum = 0;
        for (const Vector2d& a : agents) sum += find_contact(bins, a, 0.25, touching).mass;
        // 400 sample points resolve the area of the disc to the circumference over the point spacing, 1-2 %.
        CHECK(sum / (n * n) == Approx(expected).epsilon(0.02));
    }
}

TEST_CASE("Depth and speed of the water met are those of the agent's cell") {
    MadeUpWater water;
    water.add(10.5, 10.5, 1000, -3, 0);
    water.add(11.5, 11.5, 1000, 0, -4);
    water.add(12.5, 11.5, 1000, 9, 9);  // another cell
    const WaterBins bins = bins_of(water, {{11, 11}});
    const CellWater met = water_at(bins, {11, 11}, 1000);
    CHECK(met.depth == Approx(0.5).epsilon(1e-14));  // 2 m3 on 4 m2
    CHECK(met.speed == Approx(2.5).epsilon(1e-14));  // |(-1.5, -2)|
    CHECK(water_at(bins, {9, 9}, 1000).depth == 0);
    CHECK(water_at(bins, {9, 9}, 1000).speed == 0);
}

TEST_CASE("Stored units, offset and axes are turned into those of the world") {
    MadeUpWater water;
    water.add(1.5, -2.5, 7, 0.5, -0.25);
    water.py[0] = 4;
    water.vy[0] = 3;
    shm::StreamInfo info;
    info.metres_per_unit = 10;
    info.origin = {100, 5, 2};
    info.axes = {-2, 3, -3};  // x from the mirrored stored y, z from the mirrored stored z
    const WaterView view = ground_view(water.frame(1), info);
    CHECK(view.origin_x + view.scale_x * static_cast<double>(view.px[0]) == 100 - 40);
    CHECK(view.origin_z + view.scale_z * static_cast<double>(view.pz[0]) == 2 + 25);
    CHECK(view.scale_x * static_cast<double>(view.vx[0]) == -30);
    CHECK(view.scale_z * static_cast<double>(view.vz[0]) == 2.5);
}

TEST_CASE("Contacts are summed in the order of rows, columns and particles, to the bit") {
    MadeUpWater water;
    for (std::uint64_t i = 0; i < 30000; ++i) {
        water.add(20 * counter_uniform(1, 0, i), 20 * counter_uniform(1, 1, i), 1 + counter_uniform(1, 2, i),
                  counter_uniform(1, 3, i), counter_uniform(1, 4, i));
    }
    std::vector<Vector2d> agents{{2, 2}, {3.999, 4}, {10, 10}};
    for (std::uint64_t k = 0; k < 40; ++k)
        agents.emplace_back(20 * counter_uniform(2, 0, k), 20 * counter_uniform(2, 1, k));
    const WaterBins bins = bins_of(water, agents);
    for (const double distance : {0.25, 0.75, 2.0}) {
        for (const Vector2d& a : agents) {
            Contact expected;
            const int column = GroundGrid::line_of(a.x()), row = GroundGrid::line_of(a.y());
            for (int r = row - 1; r <= row + 1; ++r) {
                for (int c = column - 1; c <= column + 1; ++c) {
                    for (std::size_t i = 0; i < water.mass.size(); ++i) {
                        const double x = static_cast<double>(water.px[i]), z = static_cast<double>(water.pz[i]);
                        const double dx = x - a.x(), dz = z - a.y();
                        if (GroundGrid::line_of(x) != c || GroundGrid::line_of(z) != r) continue;
                        if (!(dx * dx + dz * dz < distance * distance)) continue;
                        const double mass = static_cast<double>(water.mass[i]);
                        expected.mass += mass;
                        expected.momentum +=
                            mass * Vector2d(static_cast<double>(water.vx[i]), static_cast<double>(water.vz[i]));
                    }
                }
            }
            std::vector<WaterParticle> touching;
            const Contact c = find_contact(bins, a, distance, touching);
            REQUIRE(c.mass == expected.mass);
            REQUIRE(c.momentum == expected.momentum);
        }
    }
}

TEST_CASE("The water met is the same to the bit, whether its cell was summed up beforehand or not") {
    const MadeUpWater water = testing::uniform_water(0, 20, 0, 20, 1, 0.23, -1.3, 0.7);
    const std::vector<Vector2d> agents{{2, 2}, {3.999, 4}, {10.3, 10}};
    const WaterBins near = bins_of(water, agents);
    WaterBins all;
    all.grid = GroundGrid::over(World{});
    bin_all_water(all, water.view());
    for (const Vector2d& a : agents) {
        REQUIRE(near.use[near.grid.cell_of(a.x(), a.y())] == WaterBins::summed);
        REQUIRE(all.use[all.grid.cell_of(a.x(), a.y())] == WaterBins::kept);
        CHECK(water_at(near, a, 1000).depth == water_at(all, a, 1000).depth);
        CHECK(water_at(near, a, 1000).speed == water_at(all, a, 1000).speed);
    }
}
