// People take from the water what they got, and nothing else: from particles, from a grid, from both.

#include <omp.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/mixed/model.hpp"
#include "fluid_server/people/pushes.hpp"
#include "fluid_server/shallow_water/people.hpp"
#include "frame_arrays.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;
using wade::fluid::test::FrameArrays;

namespace {

constexpr double frame_time = 1.0 / 30;

// A river of 1 m/s, 1 m deep, 12 x 6 m, periodic along x; particles of 0.25 m, cells of 0.5 m, a window from 4 to 8 m.
Scene river(ModelKind model) {
    Scene scene;
    scene.world->length = 12, scene.world->width = 6;
    scene.channel->x = {0, 12}, scene.channel->z = {0, 6};
    scene.channel->flow = Flow::recirculating;
    scene.channel->initial_river = InitialRiver::filled;
    scene.channel->depth = 1, scene.channel->velocity = 1;
    scene.fluid = test::fluid_of(0.25, 20000);
    scene.fluid->model = model;
    scene.fluid->shallow_water.cell_size = 0.5;
    if (model == ModelKind::mixed) scene.fluid->mixed.x_min = 4, scene.fluid->mixed.x_max = 8;
    return scene;
}

// Two people with overlapping cones, one at the periodic boundary, one at the edge of the window of `river(mixed)`.
std::vector<Push> four_people() {
    return {{{6, 3}, {}, {-3, 0.5}, 1, 0.5},
            {{6.25, 3.125}, {-0.25, 0}, {-2, -1}, 1, 0.5},
            {{0.125, 2}, {}, {-4, 0}, 1, 0.75},
            {{4.0625, 5}, {}, {-1.5, 0.25}, 1, 0.5}};
}

GroundVector sum_of(const std::vector<Push>& pushes) {
    GroundVector sum{};
    for (const Push& push : pushes) sum[0] += push.impulse[0], sum[1] += push.impulse[1];
    return sum;
}

// The same as the agents of a frame.
struct Senders {
    std::array<std::vector<float>, 14> fields;
    explicit Senders(const std::vector<Push>& pushes) {
        for (const Push& p : pushes) {
            const std::array<double, 14> values{
                65,   p.velocity[0], 0, p.velocity[1], p.place[0],   0,           p.place[1],
                0.25, 1.7,           0, p.impulse[0],  p.impulse[1], p.submerged, p.spread};
            for (std::size_t i = 0; i < fields.size(); ++i) fields[i].push_back(static_cast<float>(values[i]));
        }
    }
    [[nodiscard]] AgentsView view() const {
        const auto& f = fields;
        return {1, 0, f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9], f[10], f[11], f[12], f[13]};
    }
};

GroundVector momentum(const Particles& p, double mass) {
    GroundVector sum{};
    for (std::size_t i = 0; i < p.count; ++i) {
        sum[0] += mass * static_cast<double>(p.vx[i]), sum[1] += mass * static_cast<double>(p.vz[i]);
    }
    return sum;
}

GroundVector momentum(const shallow_water::ShallowWater& world) {
    const shallow_water::Grid& grid = world.grid;
    GroundVector sum{};
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = c; i < c + grid.nx; ++i) sum[0] += world.water.qx[i], sum[1] += world.water.qz[i];
    }
    const double mass_of_depth = world.scene.fluid->rest_density * grid.cell_area();
    return {mass_of_depth * sum[0], mass_of_depth * sum[1]};
}

// What a frame with these people leaves, in bits.
std::array<std::vector<float>, 7> frame_after(const Scene& scene, const std::vector<Push>& pushes, int threads,
                                              bool one_way = false) {
    omp_set_num_threads(threads);
    const std::unique_ptr<FluidModel> model = make_fluid_model(scene);
    Senders senders(pushes);
    for (std::size_t i = 10; one_way && i < senders.fields.size(); ++i) senders.fields[i].clear();
    FrameArrays arrays(*model);
    for (std::uint64_t f = 1; f <= 3; ++f) {
        model->take_agents(senders.view());
        model->advance_frame({f - 1, f, 30});
    }
    arrays.take(*model);
    omp_set_num_threads(omp_get_num_procs());
    return arrays.particles();
}

const std::array models{ModelKind::dfsph, ModelKind::shallow_water, ModelKind::mixed};

// A dense crowd, spread evenly by the multiples of two irrational numbers, that pushes as it stands.
std::vector<Push> crowd_of(int people) {
    std::vector<Push> pushes;
    for (int k = 0; k < people; ++k) {
        const double along = std::fmod(k * 0.7548776662, 1.0), across = std::fmod(k * 0.5698402910, 1.0);
        pushes.push_back({{12 * along, 6 * across}, {}, {-1 - along, across - 0.5}, 1, 0.5});
    }
    return pushes;
}

}  // namespace

TEST_CASE("Strips of people that push at once share no water, in a period, too") {
    const std::vector<Push> pushes = crowd_of(200);
    for (const double period : {0.0, 6.0, 3.1, 1.5}) {
        PushStrips strips;
        find_strips(pushes, period, strips);
        CAPTURE(period, strips.count());
        CHECK(strips.people.size() == pushes.size());
        CHECK(strips.begin.back() == pushes.size());
        CHECK((strips.count() == 1 || period == 0 || strips.count() % 2 == 0));
        std::vector<std::size_t> strip_of(pushes.size(), strips.count());
        for (std::size_t s = 0; s < strips.count(); ++s) {
            for (std::size_t n = strips.begin[s]; n < strips.begin[s + 1]; ++n) {
                CHECK((n == strips.begin[s] || strips.people[n - 1] < strips.people[n]));
                strip_of[strips.people[n]] = s;
            }
        }
        for (std::size_t a = 0; a < pushes.size(); ++a) {
            CHECK(strip_of[a] < strips.count());
            for (std::size_t b = 0; b < a; ++b) {
                if (strip_of[a] == strip_of[b] || strip_of[a] % 2 != strip_of[b] % 2) continue;
                double apart = std::abs(pushes[a].place[1] - pushes[b].place[1]);
                if (period > 0) apart = std::abs(std::remainder(apart, period));
                CHECK(apart > pushes[a].spread + pushes[b].spread);
            }
        }
    }
}

TEST_CASE("Particles lose what people take to the rounding of their velocities, and keep their weight") {
    const FluidWorld world(river(ModelKind::dfsph));
    Particles particles = world.particles();
    CellGrid grid(world.scene(), static_cast<float>(support_radius_of(world.scene().fluid)));
    grid.sort(particles, -1);
    const auto mass = static_cast<double>(world.particle_mass());
    const GroundVector before = momentum(particles, mass);
    PeopleInWater people;
    people.pushes = four_people();
    push_particles(people, 0.5, 1, grid, {}, 0.25, mass, particles);
    const GroundVector after = momentum(particles, mass), all = sum_of(people.pushes);
    for (std::size_t axis = 0; axis < 2; ++axis) {
        // float32: each of some 200 velocities of 1 m/s is rounded by 3e-8 m/s of 16 kg.
        CHECK(before[axis] - after[axis] == Approx(0.5 * all[axis]).margin(1e-5 * 10));
        CHECK(people.account.taken[axis] == Approx(before[axis] - after[axis]).margin(1e-9));
        CHECK(people.account.missing[axis] == 0);
    }
}

TEST_CASE("Particles above the depth in which a person stands, and those of an emitter, are left alone") {
    const FluidWorld world(river(ModelKind::dfsph));
    Particles particles = world.particles();
    CellGrid grid(world.scene(), static_cast<float>(support_radius_of(world.scene().fluid)));
    grid.sort(particles, -1);
    for (std::size_t i = 0; i < particles.count; ++i) {
        if (particles.x[i] > 6) particles.kind[i] = Kind::inflow;
    }
    PeopleInWater people;
    people.pushes = {{{6, 3}, {}, {-3, 0}, 0.5, 0.75}};
    push_particles(people, 1, 1, grid, {}, 0.25, 15.625, particles);
    int changed = 0;
    for (std::size_t i = 0; i < particles.count; ++i) {
        if (particles.vx[i] == -1) continue;
        ++changed;
        CHECK(particles.y[i] < 0.5F + 0.125F);
        CHECK(particles.x[i] <= 6);
    }
    CHECK(changed > 5);
}

TEST_CASE("The column of a person begins at the bed below, which changes along the channel") {
    Channel channel;
    channel.x = {0, 20}, channel.z = {0, 8};
    channel.bed_points = {{0, 0}, {10, 0}, {20, 2}};
    const std::vector<BedFacet> bed = bed_facets(channel);
    const Push push{{15, 3}, {}, {}, 0.5, 0.75};
    CHECK(top_of_column(push, ground_of_bed(bed), 0.2) == Approx(1 + 0.5 + 0.1));
    CHECK(top_of_column(push, {}, 0.2) == Approx(0.5 + 0.1));
}

TEST_CASE("Cells lose what people take to 1e-13 of it") {
    shallow_water::ShallowWater world(river(ModelKind::shallow_water));
    const GroundVector before = momentum(world);
    PeopleInWater people;
    people.pushes = four_people();
    shallow_water::push_cells(world, people, 1);
    const GroundVector all = sum_of(people.pushes), after = momentum(world);
    for (std::size_t axis = 0; axis < 2; ++axis) {
        CHECK(people.account.taken[axis] == Approx(all[axis]).margin(1e-13 * 72000));  // kg m/s of the whole river
        CHECK(before[axis] - after[axis] == Approx(all[axis]).margin(1e-13 * 72000));
        CHECK(people.account.missing[axis] == 0);
    }
}

TEST_CASE("The weight of cells changes smoothly as a person walks, and is a whole cone wherever it stands") {
    Scene scene = river(ModelKind::shallow_water);
    scene.fluid->shallow_water.cell_size = 0.25;
    const shallow_water::ShallowWater world(scene);
    double last = 0;
    for (int k = 0; k <= 50; ++k) {
        shallow_water::NearCells near;
        shallow_water::find_near(world, {{6 + 0.005 * k, 3}, {}, {}, 1, 0.5}, 0, 0, near);
        NearWater water;
        shallow_water::add_cells(world, near, water);
        const double cone = 1000 * 3.14159265358979 * 0.25 / 3;  // rho h pi R^2 / 3
        CHECK(water.weight == Approx(cone).epsilon(0.01));       // 16 points a cell
        const double theta = water.squares / water.weight;       // 0.5 of a cone, less as cells smooth it
        CHECK((theta > 0.4 && theta < 0.5));
        if (k > 0) CHECK(std::abs(water.weight - last) < 2e-3 * cone);
        last = water.weight;
    }
}

TEST_CASE("A film of water is stopped by people, not thrown back, and what is missing is booked") {
    shallow_water::ShallowWater world(river(ModelKind::shallow_water));
    shallow_water::set_water(
        world, [](double, double) { return 0.01; }, [](double, double) { return -1.0; },
        [](double, double) { return 0.0; });
    PeopleInWater people;
    people.pushes = {{{6, 3}, {-0.25, 0}, {-50, 0}, 0.01, 0.5}};
    shallow_water::push_cells(world, people, 1);
    CHECK(people.account.taken[0] + people.account.missing[0] == Approx(-50).epsilon(1e-12));
    CHECK(people.account.missing[0] < -40);
    shallow_water::NearCells near;
    shallow_water::find_near(world, people.pushes[0], 0, 0, near);
    NearWater water;
    shallow_water::add_cells(world, near, water);
    CHECK(water.momentum[0] / water.weight == Approx(-0.25).epsilon(1e-9));  // U = V

    PeopleInWater dry;
    dry.pushes = {{{6, 3}, {}, {-50, 4}, 0.01, 0.5}};
    shallow_water::set_water(
        world, [](double, double) { return 0.0; }, [](double, double) { return 0.0; },
        [](double, double) { return 0.0; });
    shallow_water::push_cells(world, dry, 1);
    CHECK(dry.account.missing == GroundVector{-50, 4});
    CHECK(dry.account.taken == GroundVector{});
}

TEST_CASE("Each model takes the impulses of a frame over its sub-steps, and says so") {
    for (const ModelKind kind : models) {
        const Scene scene = river(kind);
        const std::unique_ptr<FluidModel> model = make_fluid_model(scene);
        const std::vector<Push> pushes = four_people();
        const Senders senders(pushes);
        const GroundVector all = sum_of(pushes);
        INFO(model->name());
        shm::Diagnostics d = model->advance_frame({0, 1, 30});  // parallel coupling: frame 1 without agents
        CHECK(std::isnan(d.taken_by_people_x_n_s));
        for (std::uint64_t f = 2; f <= 4; ++f) {
            model->take_agents(senders.view());
            d = model->advance_frame({f - 1, f, 30});
            const auto frames = static_cast<double>(f - 1);
            CHECK(d.taken_by_people_x_n_s == Approx(frames * all[0]).epsilon(1e-5));
            CHECK(d.taken_by_people_z_n_s == Approx(frames * all[1]).epsilon(1e-4));
            CHECK(d.missing_for_people_x_n_s == 0);
        }
        d = model->advance_frame({4, 5, 30});  // no agents any more: nothing is taken twice
        CHECK(d.taken_by_people_x_n_s == Approx(3 * all[0]).epsilon(1e-5));
    }
}

TEST_CASE("A river with people has the same bits for any threads, and people who push nothing change none") {
    for (const ModelKind kind : models) {
        const Scene scene = river(kind);
        CHECK((frame_after(scene, four_people(), 1) == frame_after(scene, four_people(), 2)));
        CHECK((frame_after(scene, crowd_of(200), 1) == frame_after(scene, crowd_of(200), 2)));
        std::vector<Push> idle = four_people();
        for (Push& push : idle) push.impulse = {};
        const auto alone = frame_after(scene, four_people(), 1, true);
        CHECK((frame_after(scene, idle, 1) == alone));
        CHECK_FALSE((frame_after(scene, four_people(), 1) == alone));
    }
}
