// bench_kernels: the kernels of water and crowd by themselves, on one core, with Google Benchmark.
//
// The water is that of a river without the lattice of its start, the crowd stands all over a river.

#include <benchmark/benchmark.h>
#include <omp.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/felt_water.hpp"
#include "crowd_client/water/water_view.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "tests/bench/scenes.hpp"

namespace {

using namespace wade;
using namespace wade::bench;

// Of 8 lanes where WADE_NARROW_VECTORS is set, as fluid_server has them.
fluid::NeighbourLists lists_as_asked(std::size_t capacity) {
    fluid::use_widest_vectors(std::getenv("WADE_NARROW_VECTORS") == nullptr);
    return fluid::NeighbourLists(capacity);
}

// Water as the solver has it in the middle of a step.
struct Water {
    Scene scene;
    fluid::Kernel kernel;
    float support_radius, volume;
    fluid::Particles particles;
    fluid::CellGrid grid;
    fluid::Solids solids;
    fluid::NeighbourLists lists;
    fluid::ParticleFields fields;

    Water(const Scene& its_scene, const fluid::Particles& its_particles)
        : scene(its_scene),
          kernel(fluid::make_kernel(scene.fluid)),
          support_radius(static_cast<float>(2 * scene.fluid->particle_spacing)),
          volume(static_cast<float>(std::pow(scene.fluid->particle_spacing, 3))),
          particles(its_particles),
          grid(scene, support_radius),
          solids(scene),
          lists(lists_as_asked(particles.capacity())),
          fields(particles.capacity()) {
        grid.sort(particles, -1e30F);
        fluid::find_neighbours(grid, solids, particles, support_radius, lists);
        fluid::compute_density_and_diagonal(particles, kernel, volume, true, lists, fields);
    }
    [[nodiscard]] std::size_t blocks() const { return fluid::block_count(particles.count); }
};

// Moves particles by up to `most`, m, along each axis, so that the lattice of the start is gone, as after many steps.
void shake(fluid::Particles& particles, float most) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> by(-most, most);
    for (std::size_t i = 0; i < particles.count; ++i)
        particles.x[i] += by(random), particles.y[i] += by(random), particles.z[i] += by(random);
}

Water& water_of(std::int64_t size) {
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    static std::map<std::int64_t, std::unique_ptr<Water>> waters;
    std::unique_ptr<Water>& water = waters[size];
    if (!water) {
        const River river = size == 21'600 ? river_2_layers : size == 100'000 ? river_4_layers : river_10_layers;
        const Scene scene = river_scene(river);
        fluid::FluidWorld world(scene);
        for (int k = 0; k < 10; ++k) world.step(1 / scene.frame_rate);
        fluid::Particles particles = world.particles();
        shake(particles, 0.2F * static_cast<float>(river.spacing));
        water = std::make_unique<Water>(scene, particles);
        omp_set_num_threads(1);
    }
    return *water;
}

// Time of an item: per particle, or per agent.
void count_items(benchmark::State& state, std::size_t items) {
    state.counters["ns_per_item"] =
        benchmark::Counter(1e-9 * static_cast<double>(items) * static_cast<double>(state.iterations()),
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// Counts pairs with a kernel above zero, the fraction of lanes in use, and the bytes of the neighbour lists.
void count_pairs(benchmark::State& state, const Water& water) {
    double pairs = 0, entries = 0;
    for (std::size_t b = 0; b < water.blocks(); ++b) {
        const fluid::NeighbourBlock& block = water.lists.blocks[b];
        const std::size_t used = block.segments.empty() ? 0 : block.segments.back().end;
        entries += static_cast<double>(used);
        for (std::size_t k = 0; k < used; ++k) pairs += std::popcount(fluid::lanes_of_entry(block, k));
    }
    const auto n = static_cast<double>(water.particles.count), lanes = static_cast<double>(water.lists.cluster_size);
    const auto same_for_all = [](double value) { return benchmark::Counter(value, benchmark::Counter::kAvgThreads); };
    state.counters["pairs_per_particle"] = same_for_all(pairs / n);
    state.counters["lanes_in_use_percent"] = same_for_all(100 * pairs / (entries * lanes));
    // An entry is a particle and a mask of lanes, a pair a factor.
    const double bytes_of_mask = lanes > 8 ? 2 : 1;
    const double bytes = entries * (sizeof(std::uint32_t) + bytes_of_mask) + pairs * sizeof(std::uint16_t);
    state.counters["list_bytes_per_particle"] = same_for_all(bytes / n);
    state.counters["useful_pairs_per_s"] =
        benchmark::Counter(pairs * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void sort(benchmark::State& state) {
    Water& water = water_of(state.range(0));
    for (auto _ : state) water.grid.sort(water.particles, -1e30F);
    count_items(state, water.particles.count);
}

void list_build(benchmark::State& state) {
    Water& water = water_of(state.range(0));
    for (auto _ : state)
        fluid::find_neighbours(water.grid, water.solids, water.particles, water.support_radius, water.lists);
    fluid::compute_density_and_diagonal(water.particles, water.kernel, water.volume, true, water.lists, water.fields);
    count_items(state, water.particles.count);
    count_pairs(state, water);
}

void kernel_sweep(benchmark::State& state) {
    Water& water = water_of(state.range(0));
    for (auto _ : state)
        fluid::compute_density_and_diagonal(water.particles, water.kernel, water.volume, true, water.lists,
                                            water.fields);
    count_items(state, water.particles.count);
    count_pairs(state, water);
}

void pressure_sweep(benchmark::State& state) {
    Water& water = water_of(state.range(0));
    fluid::ParticleFields& f = water.fields;
    for (auto _ : state) {
        for (std::size_t b = 0; b < water.blocks(); ++b)
            fluid::sum_gradients(b, water.particles, water.lists, water.particles.pressure.data(),
                                 {f.ax.data(), f.ay.data(), f.az.data()});
    }
    count_items(state, water.particles.count);
    count_pairs(state, water);
}

void rate_sweep(benchmark::State& state) {
    Water& water = water_of(state.range(0));
    const fluid::Particles& p = water.particles;
    std::array<float, fluid::block_size> sums;
    for (auto _ : state) {
        for (std::size_t b = 0; b < water.blocks(); ++b)
            fluid::sum_divergence(b, p, water.lists, {p.vx.data(), p.vy.data(), p.vz.data()}, sums.data());
        benchmark::DoNotOptimize(sums.data());
    }
    count_items(state, p.count);
    count_pairs(state, water);
}

// What a step asks of the lists of a river, on lists that were searched wider than the support radius by a skin: it would
// spare the next step its search as long as no two particles have come nearer than that. One first sweep and five of both
// kinds of a solve, as many as the river's steps have.
void sweeps_with_skin(benchmark::State& state, double spacings) {
    Water& water = water_of(state.range(0));
    const float skin = static_cast<float>(spacings * water.scene.fluid->particle_spacing);
    fluid::find_neighbours(water.grid, water.solids, water.particles, water.support_radius + skin, water.lists);
    const fluid::Particles& p = water.particles;
    fluid::ParticleFields& f = water.fields;
    std::array<float, fluid::block_size> sums;
    for (auto _ : state) {
        fluid::compute_density_and_diagonal(p, water.kernel, water.volume, true, water.lists, f);
        for (int k = 0; k < 5; ++k) {
            for (std::size_t b = 0; b < water.blocks(); ++b) {
                fluid::sum_gradients(b, p, water.lists, p.pressure.data(), {f.ax.data(), f.ay.data(), f.az.data()});
                fluid::sum_divergence(b, p, water.lists, {p.vx.data(), p.vy.data(), p.vz.data()}, sums.data());
            }
        }
        benchmark::DoNotOptimize(sums.data());
    }
    count_items(state, p.count);
    count_pairs(state, water);
    fluid::find_neighbours(water.grid, water.solids, water.particles, water.support_radius, water.lists);
    fluid::compute_density_and_diagonal(p, water.kernel, water.volume, true, water.lists, f);
}

// A crowd all over a river, and the water round it.
struct Flood {
    Scene scene;
    std::vector<float> mass;
    std::optional<fluid::FluidWorld> world;
    crowd::CrowdWorld crowd;
    crowd::WaterView view;
    std::vector<Eigen::Vector2d> places;

    Flood() : scene(river_with_crowd(100'000, 100, 50)), world(scene), crowd(crowd::make_crowd(scene)) {
        for (int frame = 0; frame < 3; ++frame) world->step(1 / scene.frame_rate);
        const fluid::Particles& p = world->particles();
        mass.assign(p.count, world->particle_mass());
        const auto of = [&](const std::vector<float>& v) { return std::span<const float>(v.data(), p.count); };
        view.mass = mass;
        view.px = of(p.x), view.py = of(p.y), view.pz = of(p.z);
        view.vx = of(p.vx), view.vy = of(p.vy), view.vz = of(p.vz);
        places = crowd.agents.position;
        crowd::bin_water(crowd.water, view, places);
    }
};

Flood& flood() {
    static Flood one;
    return one;
}

void bins(benchmark::State& state) {
    Flood& f = flood();
    for (auto _ : state) crowd::bin_water(f.crowd.water, f.view, f.places);
    count_items(state, f.view.size());
}

void contacts(benchmark::State& state) {
    Flood& f = flood();
    const double distance = crowd::contact_distance(f.scene.coupling);
    std::size_t touching = 0;
    for (auto _ : state) {
        touching = 0;
        for (const Eigen::Vector2d& place : f.places) {
            benchmark::DoNotOptimize(crowd::find_contact(f.crowd.water, place, distance, f.crowd.touching));
            touching += f.crowd.touching.size();
        }
    }
    count_items(state, f.places.size());
    state.counters["touching_per_agent"] = static_cast<double>(touching) / static_cast<double>(f.places.size());
}

// Depth-averaged water 0.8 m deep all over the river of the crowd: a particle at the centre of each square cell.
struct Sheet {
    std::vector<float> mass, px, pz, vx, still;

    Sheet(const Channel& channel, double cell) {
        for (double x = channel.x.lo + 0.5 * cell; x < channel.x.hi; x += cell) {
            for (double z = channel.z.lo + 0.5 * cell; z < channel.z.hi; z += cell) {
                px.push_back(static_cast<float>(x));
                pz.push_back(static_cast<float>(z));
            }
        }
        mass.assign(px.size(), static_cast<float>(1000 * 0.8 * cell * cell));
        vx.assign(px.size(), -1.2F);
        still.assign(px.size(), 0);
    }
    [[nodiscard]] crowd::WaterView view(double width) const {
        crowd::WaterView view;
        view.mass = mass;
        view.px = px;
        view.pz = pz;
        view.vx = vx;
        view.py = view.vy = view.vz = still;
        view.column = {width, width};
        return view;
    }
};

// What people of `measured` sample of a frame, with sorting its water; width: of the columns, m, 0 for points.
void sampled_water(benchmark::State& state, double cell, double width) {
    const Flood& f = flood();
    Scene scene = f.scene;
    scene.fluid->particle_spacing = cell;
    const crowd::Feeling feeling = crowd::make_feeling(scene, {width, width});
    const Sheet sheet(scene.channel, cell);
    crowd::WaterBins water = crowd::empty_bins(scene);
    std::vector<crowd::FeltWater> felt;
    for (auto _ : state) {
        crowd::bin_water(water, sheet.view(width), f.places);
        crowd::feel_water(feeling, water, f.places, 1, felt);
    }
    double error = 0;
    for (std::size_t k = 0; k < felt.size(); ++k) {
        const bool amid = std::abs(f.places[k].y() - 0.5 * (scene.channel->z.lo + scene.channel->z.hi)) < 10;
        if (amid) error = std::max(error, std::abs(felt[k].depth / 0.8 - 1));
    }
    count_items(state, f.places.size());
    state.counters["largest_error"] = error;
}

// The crowd's step without water: markers claimed and velocities chosen.
void dry_crowd_step(benchmark::State& state) {
    Flood& f = flood();
    crowd::CrowdWorld crowd = f.crowd;
    for (auto _ : state) {
        crowd::step(crowd, {});
        if (crowd.active.size() * 10 < f.places.size() * 9) {  // many have arrived
            state.PauseTiming();
            crowd = f.crowd;
            state.ResumeTiming();
        }
    }
    count_items(state, f.places.size());
}

void add_sizes(benchmark::internal::Benchmark* b) {
    b->Arg(21'600)->Arg(100'000);
    if (std::getenv("WADE_BENCH_QUICK") == nullptr) b->Arg(1'000'000);
}

BENCHMARK(sort)->Name("kernels/sort")->Apply(add_sizes);
BENCHMARK(list_build)->Name("kernels/list_build")->Apply(add_sizes);
BENCHMARK(kernel_sweep)->Name("kernels/kernel_sweep")->Apply(add_sizes);
BENCHMARK(pressure_sweep)->Name("kernels/pressure_sweep")->Apply(add_sizes);
// Two at once, which share what they read and wait for nothing: what a second thread can gain at most.
BENCHMARK(rate_sweep)->Name("kernels/rate_sweep")->Apply(add_sizes)->UseRealTime()->Threads(1)->Threads(2);
BENCHMARK_CAPTURE(sweeps_with_skin, none, 0.0)->Name("kernels/sweeps_without_skin")->Arg(100'000);
BENCHMARK_CAPTURE(sweeps_with_skin, tenth, 0.1)->Name("kernels/sweeps_with_skin_of_0.1")->Arg(100'000);
BENCHMARK_CAPTURE(sweeps_with_skin, fifth, 0.2)->Name("kernels/sweeps_with_skin_of_0.2")->Arg(100'000);
BENCHMARK_CAPTURE(sweeps_with_skin, two_fifths, 0.4)->Name("kernels/sweeps_with_skin_of_0.4")->Arg(100'000);
BENCHMARK(bins)->Name("kernels/bins")->Arg(100'000);
BENCHMARK(contacts)->Name("kernels/contacts")->Arg(5'000);
BENCHMARK_CAPTURE(sampled_water, points, 0.25, 0.0)->Name("kernels/sampled_points_0.25")->Arg(5'000);
BENCHMARK_CAPTURE(sampled_water, quarter, 0.25, 0.25)->Name("kernels/sampled_columns_0.25")->Arg(5'000);
BENCHMARK_CAPTURE(sampled_water, half, 0.5, 0.5)->Name("kernels/sampled_columns_0.5")->Arg(5'000);
BENCHMARK_CAPTURE(sampled_water, one, 1.0, 1.0)->Name("kernels/sampled_columns_1")->Arg(5'000);
BENCHMARK_CAPTURE(sampled_water, two, 2.0, 2.0)->Name("kernels/sampled_columns_2")->Arg(5'000);
BENCHMARK(dry_crowd_step)->Name("kernels/dry_crowd_step")->Arg(5'000);

}  // namespace

BENCHMARK_MAIN();
