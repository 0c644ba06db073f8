// The model as the server sees it: what it publishes, and its diagnostics.

#include <omp.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <numbers>
#include <set>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/shallow_water/model.hpp"
#include "tests/unit/fluid_server/frame_arrays.hpp"
#include "waters.hpp"

using namespace wade;
using namespace wade::fluid::shallow_water;
using wade::fluid::FrameInterval;
using wade::fluid::test::FrameArrays;

namespace {

Scene with_room(Scene scene) {
    scene.fluid->max_particles = 100000;
    scene.fluid->rest_density = 1000;
    return scene;
}

// A dam that breaks askew over an uneven, partly dry bed, round an obstacle.
Scene uneven_dam() {
    Scene scene = with_room(basin(20, 12, 0.5));
    scene.channel->bed_points = {{3, 0}, {6, 0.4}, {9, 0}, {18, 0.5}};
    scene.obstacles = {{{6, 7}, {3, 5}, 2.0}};
    scene.channel->water_blocks = {{{11, 20}, {4, 12}, 1.5}};
    return scene;
}

FrameInterval frame(std::uint64_t number) {
    return {number - 1, number, 30};
}

// Mass and momentum of the particles and of the grid, kg and kg m/s.
struct Totals {
    double mass = 0, px = 0, pz = 0;
};
Totals of(const FrameArrays& arrays) {
    Totals sum;
    const auto p = arrays.particles();
    for (std::size_t i = 0; i < p[0].size(); ++i) {
        const auto m = static_cast<double>(p[0][i]);
        sum.mass += m, sum.px += m * static_cast<double>(p[1][i]), sum.pz += m * static_cast<double>(p[3][i]);
    }
    return sum;
}
Totals of(const ShallowWater& world) {
    Totals sum;
    for_each_cell(world.grid, [&](double, double, std::size_t c) {
        sum.mass += world.water.h[c], sum.px += world.water.qx[c], sum.pz += world.water.qz[c];
    });
    const double mass = 1000 * world.grid.cell_area();
    return {mass * sum.mass, mass * sum.px, mass * sum.pz};
}

}  // namespace

TEST_CASE("the particles carry mass and momentum of the grid to rounding", "[shallow_water][particles]") {
    const double spacing = GENERATE(0.4642, 0.15, 0.9);
    Scene scene = uneven_dam();
    scene.fluid->particle_spacing = spacing;
    ShallowWaterModel model(scene);
    FrameArrays arrays(model);
    for (std::uint64_t f = 1; f <= 60; ++f) {
        model.advance_frame(frame(f));
        if (f % 10 != 0) continue;
        arrays.take(model);
        const Totals sent = of(arrays), kept = of(model.world());
        // Each value is rounded to 24 bits, at random: far below 2^-24 of the sum of the absolute values.
        const double largest = kept.mass * 6;
        CHECK(std::abs(sent.mass - kept.mass) <= 1e-7 * kept.mass);
        CHECK(std::abs(sent.px - kept.px) <= 1e-7 * largest);
        CHECK(std::abs(sent.pz - kept.pz) <= 1e-7 * largest);
        CHECK(kept.mass == Approx(of(ShallowWater(scene)).mass).epsilon(1e-13));
    }
}

TEST_CASE("particles lie in the water of their cell, and none is heavier than those of the solver",
          "[shallow_water][particles]") {
    ShallowWaterModel model(uneven_dam());
    FrameArrays arrays(model);
    for (std::uint64_t f = 1; f <= 40; ++f) model.advance_frame(frame(f));
    arrays.take(model);
    const ShallowWater& world = model.world();
    std::vector<double> mass(world.water.h.size(), 0);
    const auto p = arrays.particles();
    std::size_t outside = 0, above = 0, heavy = 0;
    for (std::size_t i = 0; i < p[0].size(); ++i) {
        const auto x = static_cast<double>(p[4][i]), y = static_cast<double>(p[5][i]), z = static_cast<double>(p[6][i]);
        if (!(x >= 0 && x < 20 && z >= 0 && z < 12)) ++outside;
        const std::size_t c = world.grid.row(static_cast<std::ptrdiff_t>(z / 0.5)) + static_cast<std::size_t>(x / 0.5);
        mass[c] += static_cast<double>(p[0][i]);
        if (y < world.bed.height[c] || y > world.primitive.surface()[c] + 1e-6) ++above;
        if (p[0][i] > 100.03F) ++heavy;
    }
    CHECK(outside == 0);
    CHECK(above == 0);
    CHECK(heavy == 0);
    double worst = 0;
    for_each_cell(world.grid, [&](double, double, std::size_t c) {
        if (world.water.h[c] <= world.constants.dry) return;
        worst = std::max(worst, std::abs(mass[c] / (250 * world.water.h[c]) - 1));
    });
    CHECK(worst <= 2e-5);  // the films' mass
}

TEST_CASE("in a uniform stream the particles drift with it", "[shallow_water][particles]") {
    Scene scene = with_room(river(20, 4, 0.5, 1, 1.5));
    ShallowWaterModel model(scene);
    FrameArrays arrays(model);
    const auto places = [&] {
        std::set<std::pair<long, long>> all;  // mm
        arrays.take(model);
        const auto p = arrays.particles();
        for (std::size_t i = 0; i < p[0].size(); ++i) {
            all.insert(
                {std::lround(1000 * static_cast<double>(p[4][i])), std::lround(1000 * static_cast<double>(p[6][i]))});
        }
        return all;
    };
    model.advance_frame({0, 1, 10});
    const auto before = places();
    model.advance_frame({1, 2, 10});
    const auto after = places();
    std::size_t found = 0, looked = 0;
    for (const auto& [x, z] : before) {
        if (x < 1000) continue;
        ++looked;
        for (long e = -1; e <= 1; ++e) found += after.count({x - 150 + e, z});
    }
    CHECK(found == looked);
    CHECK(looked > 500);
}

TEST_CASE("the mass in contact with an agent is that of its column, wherever it stands", "[shallow_water][particles]") {
    const double depth = 1, radius = 0.25;
    ShallowWaterModel model(with_room(river(20, 4, 0.5, depth, 1.5)));
    FrameArrays arrays(model);
    constexpr std::size_t agents = 40;
    std::array<double, agents> mean{};
    double sum = 0, squares = 0;
    constexpr int frames = 3000;
    for (std::uint64_t f = 1; f <= frames; ++f) {
        model.advance_frame(frame(f));
        arrays.take(model);
        const auto p = arrays.particles();
        for (std::size_t a = 0; a < agents; ++a) {
            // No common measure with the cells.
            const double x = 5 + 0.137 * static_cast<double>(a), z = 1.1 + 0.0431 * static_cast<double>(a);
            double mass = 0;
            for (std::size_t i = 0; i < p[0].size(); ++i) {
                const double dx = static_cast<double>(p[4][i]) - x, dz = static_cast<double>(p[6][i]) - z;
                if (dx * dx + dz * dz < radius * radius) mass += static_cast<double>(p[0][i]);
            }
            mean[a] += mass / frames, sum += mass, squares += mass * mass;
        }
    }
    const double column = 1000 * std::numbers::pi * radius * radius * depth;
    const double all = sum / (frames * agents), scatter = std::sqrt(squares / (frames * agents) - all * all) / all;
    const auto [least, most] = std::minmax_element(mean.begin(), mean.end());
    CAPTURE(column, all, *least / column, *most / column, scatter);
    CHECK(all == Approx(column).epsilon(0.01));
    // 150 m of stream pass in the time, 300 cells. If each were at random, with a scatter of a third, the means would
    // scatter by 2 %.
    CHECK(*least / column > 0.96);
    CHECK(*most / column < 1.04);
    // The solved river of two layers has 0.32.
    CHECK(scatter < 0.4);
}

TEST_CASE("frames have the same bits for any number of threads, and another seed makes others",
          "[shallow_water][particles]") {
    const auto run = [](int threads, std::uint64_t seed) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        Scene scene = with_room(river(60, 45, 0.5, 1, 1.5));
        scene.seed = seed;
        scene.channel->bed_points = {{20, 0}, {30, 0.5}, {40, 0}};
        ShallowWaterModel model(scene);
        FrameArrays arrays(model);
        for (std::uint64_t f = 1; f <= 5; ++f) model.advance_frame(frame(f));
        arrays.take(model);
        omp_set_num_threads(before);
        return arrays.particles();
    };
    const auto one = run(1, 1);
    CHECK(one == run(2, 1));
    CHECK(one == run(3, 1));
    CHECK(one != run(1, 2));
}

TEST_CASE("more water than max_particles makes larger particles", "[shallow_water][particles]") {
    Scene scene = uneven_dam();
    scene.fluid->particle_spacing = 0.1;
    scene.fluid->max_particles = 3000;
    ShallowWaterModel model(scene);
    FrameArrays arrays(model);
    arrays.take(model);
    CHECK(arrays.count <= model.capacity());
    CHECK(arrays.count > 1500);
    CHECK(arrays.mass() == Approx(of(model.world()).mass).epsilon(1e-6));
}

TEST_CASE("the diagnostics of a driven river are those of its water", "[shallow_water]") {
    Scene scene = with_room(river(20, 4, 0.5, 1, 1.5));
    scene.channel->flow = Flow::recirculating;
    const std::unique_ptr<fluid::FluidModel> model = fluid::make_fluid_model(scene);
    CHECK(model->name() == "shallow_water");
    const shm::Diagnostics d = model->advance_frame(frame(1));
    CHECK(d.sub_steps >= 1);
    CHECK(d.last_dt_s == Approx(1.0 / 30 / d.sub_steps));
    CHECK(d.mean_depth_m == Approx(1).epsilon(1e-12));
    CHECK(d.mean_speed_m_s == Approx(1.5).epsilon(1e-12));
    CHECK(d.kinetic_energy_j == Approx(0.5 * 80000 * 2.25).epsilon(1e-12));
    CHECK(d.potential_energy_j == Approx(80000 * 9.81 * 0.5).epsilon(1e-12));
    CHECK(std::abs(d.driving_acceleration_m_s2) < 1e-9);
    CHECK(model->state() == nullptr);
}

TEST_CASE("a dry channel publishes no particles, and has no depth", "[shallow_water]") {
    ShallowWaterModel model(with_room(basin(10, 4, 0.5)));
    FrameArrays arrays(model);
    const shm::Diagnostics d = model.advance_frame(frame(1));
    arrays.take(model);
    CHECK(arrays.count == 0);
    CHECK(std::isnan(d.mean_depth_m));
    CHECK(d.kinetic_energy_j == 0);
}
