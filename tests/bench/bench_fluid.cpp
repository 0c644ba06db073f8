// bench_fluid: particle-steps per second of the water, with what the steps did and how exact they were beside them.
// bench_fluid --frames SCENE OUT EVERY_S: one run of a scene for `wade speed-vs-error --splishsplash`.

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "configs/json/json.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "tests/bench/bench_options.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/scenes.hpp"

namespace {

using namespace wade;
using namespace wade::bench;

// What a stretch of steps did.
struct Work {
    Times times;
    std::uint64_t steps = 0;
    double simulated = 0;  // s
    double particle_steps = 0;
    double divergence = 0, density = 0;  // iterations, summed
    double sweeps = 0;                   // over all pairs
    double mean_error = 0;               // of the density, summed over steps
    double max_error = 0;
    fluid::StepStages::Seconds stages{};

    void add(const fluid::StepReport& step, std::size_t particles) {
        ++steps;
        simulated += step.dt;
        particle_steps += static_cast<double>(particles);
        divergence += step.divergence.iterations;
        density += step.density.iterations;
        sweeps += step.sweeps;
        for (std::size_t k = 0; k < stages.size(); ++k) stages[k] += step.stages[k];
        mean_error += step.mean_density_error;
        max_error = std::max(max_error, step.max_density_error);
    }
    void add(const Work& other) {
        steps += other.steps;
        simulated += other.simulated;
        particle_steps += other.particle_steps;
        divergence += other.divergence;
        density += other.density;
        sweeps += other.sweeps;
        for (std::size_t k = 0; k < stages.size(); ++k) stages[k] += other.stages[k];
        mean_error += other.mean_error;
        max_error = std::max(max_error, other.max_error);
    }
};

// Runs whole frames, as the server does, until `time` seconds of the water are over.
Work run_for(fluid::FluidWorld& world, double time) {
    Work work;
    const double frame = 1 / world.scene().frame_rate;
    const Times start = Times::now();
    const auto frames = std::max<std::int64_t>(1, std::llround(time / frame));
    for (std::int64_t f = 0; f < frames; ++f) {
        double remaining = frame;
        while (remaining > 1e-9 * frame) {
            const fluid::StepReport step = world.step(remaining);
            remaining -= step.dt;
            work.add(step, world.particles().count);
        }
    }
    work.times = Times::now().since(start);
    return work;
}

// The rounds of one thread count.
struct Series {
    std::vector<double> rates, cpu_rates;  // particle-steps per second of wall and of processor time
    Work all;
    double pairs = 0, list_bytes = 0;  // of a particle, at the end of the last round

    void add(const Work& work, const fluid::FluidWorld& world) {
        const auto n = static_cast<double>(world.particles().count);
        pairs = static_cast<double>(world.pairs()) / n;
        list_bytes = static_cast<double>(world.list_bytes()) / n;
        rates.push_back(work.particle_steps / work.times.wall);
        cpu_rates.push_back(work.particle_steps / work.times.cpu);
        all.add(work);
    }
    [[nodiscard]] Result result(const std::string& name, std::uint64_t size, int threads) const {
        Result r = result_of(name, size, threads, rates, "particle_steps_per_s");
        std::vector<double> cpu = cpu_rates;
        const auto n = static_cast<double>(all.steps);
        r.extra = {{"particle_steps_per_cpu_s", quantile(cpu, 0.5)},
                   {"rounds", static_cast<double>(rates.size())},
                   {"steps", n},
                   {"mean_dt_ms", 1e3 * all.simulated / n},
                   {"divergence_iterations_per_step", all.divergence / n},
                   {"density_iterations_per_step", all.density / n},
                   {"mean_density_error_percent", 100 * all.mean_error / n},
                   {"max_density_error_percent", 100 * all.max_error},
                   {"pairs_per_particle", pairs},
                   {"sweeps_per_step", all.sweeps / n},
                   {"list_bytes_per_particle", list_bytes}};
        for (std::size_t k = 0; k < all.stages.size(); ++k)
            r.extra.emplace_back(std::string(fluid::stage_names[k]) + "_ns_per_particle_step",
                                 1e9 * all.stages[k] / all.particle_steps);
        return r;
    }
};

void finish(Result result, std::vector<Result>& results) {
    print(result);
    results.push_back(std::move(result));
}

double largest_speed(const fluid::Particles& p) {
    double v2 = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const auto x = static_cast<double>(p.vx[i]), y = static_cast<double>(p.vy[i]), z = static_cast<double>(p.vz[i]);
        v2 = std::max(v2, x * x + y * y + z * z);
    }
    return std::sqrt(v2);
}

double mean_height(const fluid::Particles& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) sum += static_cast<double>(p.y[i]);
    return sum / static_cast<double>(p.count);
}

// How a river is measured.
struct Plan {
    double warm_up;  // s: the lattice of the start becomes water
    double round;    // s
    int rounds;
};

void bench_river(const std::string& name, const River& river, const Plan& plan, const Options& options,
                 std::vector<Result>& results, const std::map<std::string, std::string>& values = {}) {
    const Scene scene = river_scene(river, values);
    const std::vector<int> counts = options.thread_counts();
    const PeakMemory memory;
    fluid::FluidWorld world(scene);
    omp_set_num_threads(counts.back());
    run_for(world, plan.warm_up);
    // The numbers of threads take turns, so that each meets the same water and the same machine.
    std::map<int, Series> series;
    for (int round = 0; round < (options.quick ? 3 : plan.rounds); ++round) {
        for (const int threads : counts) {
            omp_set_num_threads(threads);
            const Work work = run_for(world, plan.round);
            series[threads].add(work, world);
        }
    }
    const double bytes = static_cast<double>(memory.bytes()) / static_cast<double>(river.size);
    for (const int threads : counts) {
        Result result = series[threads].result(name, river.size, threads);
        result.extra.emplace_back("bytes_per_particle", bytes);
        finish(std::move(result), results);
    }
}

// The whole run from the start, `rounds` times: the water changes all the while.
void bench_run(const std::string& name, const Scene& scene, int rounds, const Options& options,
               std::vector<Result>& results) {
    const auto size = static_cast<std::uint64_t>(scene.fluid->max_particles);
    std::map<int, Series> series;
    double bytes = 0;
    std::vector<std::pair<std::string, double>> end;
    for (int round = 0; round < rounds; ++round) {
        for (const int threads : options.thread_counts()) {
            omp_set_num_threads(threads);
            const PeakMemory memory;
            fluid::FluidWorld world(scene);
            const double height = mean_height(world.particles());
            const double last = std::min(1.0, scene.duration / 2);
            const Work first = run_for(world, scene.duration - last);
            const Work second = run_for(world, last);
            Work both = first;
            both.add(second);
            both.times = {first.times.wall + second.times.wall, first.times.cpu + second.times.cpu};
            series[threads].add(both, world);
            bytes = std::max(bytes, static_cast<double>(memory.bytes()) / static_cast<double>(size));
            const double n = static_cast<double>(second.steps);
            end = {{"iterations_per_step_at_the_end", (second.divergence + second.density) / n},
                   {"largest_speed_at_the_end_m_s", largest_speed(world.particles())},
                   {"mean_height_change_percent", 100 * (mean_height(world.particles()) / height - 1)}};
        }
    }
    for (const int threads : options.thread_counts()) {
        Result result = series[threads].result(name, size, threads);
        result.extra.emplace_back("steps_per_run", static_cast<double>(series[threads].all.steps) / rounds);
        result.extra.emplace_back("bytes_per_particle", bytes);
        result.extra.emplace_back("cfl", scene.fluid->cfl);
        if (name == "fluid/column_at_rest") result.extra.insert(result.extra.end(), end.begin(), end.end());
        finish(std::move(result), results);
    }
}

// SPlisHSPlasH takes dt = 0.4 CFL diameter / largest speed, at most 5 ms, and 733 steps for the 3 s of this run. Here the
// speed of waves counts as well, so that no CFL number makes the two rules one; this one makes as many steps, to 2 %.
constexpr const char* cfl_of_733_steps = "0.73";

void run(const Options& options, std::vector<Result>& results) {
    const int rounds = options.quick ? 1 : 5;
    if (options.wanted("fluid/dam_break"))
        bench_run("fluid/dam_break", scene_of("dam_break.json"), rounds, options, results);
    if (options.wanted("fluid/dam_break_733_steps"))
        bench_run("fluid/dam_break_733_steps", scene_of("dam_break.json", {{"/fluid/cfl", cfl_of_733_steps}}), rounds,
                  options, results);
    if (options.wanted("fluid/column_at_rest"))
        bench_run("fluid/column_at_rest", scene_of("column_at_rest.json"), options.quick ? 1 : 3, options, results);
    if (options.wanted("fluid/river")) {
        bench_river("fluid/river", river_2_layers, {4, 4, 9}, options, results);
        bench_river("fluid/river", river_4_layers, {2, 1, 7}, options, results);
        if (!options.quick) bench_river("fluid/river", river_10_layers, {0.3, 0.1, 5}, options, results);
    }
    if (options.wanted("fluid/river_quartic_spline")) {
        const std::map<std::string, std::string> quartic{{"/fluid/kernel", "\"quartic_spline\""}};
        bench_river("fluid/river_quartic_spline", river_2_layers, {4, 4, 5}, options, results, quartic);
        bench_river("fluid/river_quartic_spline", river_4_layers, {2, 1, 5}, options, results, quartic);
    }
    if (options.wanted("fluid/river_boxes")) {
        struct Grid {
            int columns, rows;
        };
        for (const auto& [columns, rows] : {Grid{0, 0}, Grid{5, 2}, Grid{10, 5}, Grid{20, 10}}) {
            const std::string boxes = boxes_on_grid(river_2_layers, columns, rows);
            bench_river("fluid/river_boxes_" + std::to_string(columns * rows), river_2_layers, {4, 2, 5}, options,
                        results, {{"/obstacles", boxes}});
        }
    }
    if (options.wanted("fluid/dry_channel")) {
        for (const River& channel : dry_channels) {
            const std::string size = std::to_string(std::lround(channel.length)) + "x";
            bench_river("fluid/dry_channel_" + size + std::to_string(std::lround(channel.width)), channel,
                        {0.3, 0.2, 5}, options, results, block_in_the_corner());
        }
    }
    if (options.wanted("fluid/growth")) {
        // As much work in each round, and in the warm-up whole frames.
        bench_river("fluid/growth", wide_rivers[0], {2, 3, 5}, options, results);
        bench_river("fluid/growth", wide_rivers[1], {2, 0.3, 5}, options, results);
        if (!options.quick) bench_river("fluid/growth", wide_rivers[2], {0.3, 0.03, 5}, options, results);
    }
}

// Time, number of particles, then x, y, z, vx, vy, vz, m and m/s, and the pressure, Pa, of all.
void write_frame(std::ofstream& file, const fluid::FluidWorld& world) {
    const fluid::Particles& p = world.particles();
    const double time = world.time();
    const std::uint64_t count = p.count;
    file.write(reinterpret_cast<const char*>(&time), sizeof time);
    file.write(reinterpret_cast<const char*>(&count), sizeof count);
    std::vector<float> pressure(p.pressure.begin(), p.pressure.begin() + static_cast<std::ptrdiff_t>(count));
    for (float& value : pressure) value *= static_cast<float>(world.scene().fluid->rest_density);
    for (const std::vector<float>* values : {&p.x, &p.y, &p.z, &p.vx, &p.vy, &p.vz, &std::as_const(pressure)}) {
        file.write(reinterpret_cast<const char*>(values->data()), static_cast<std::streamsize>(count * sizeof(float)));
    }
}

// Writes OUT/frames.bin, the first step at or after each multiple of `every` seconds, and OUT/cost.json. One thread. Frames
// do not shorten the steps, as in the program that stands beside.
void write_run(const std::string& scene_file, const std::string& out, double every) {
    const Scene scene = load_scene(scene_file, {}).scene;
    omp_set_num_threads(1);
    fluid::FluidWorld world(scene);
    std::ofstream frames(out + "/frames.bin", std::ios::binary);
    Work work;
    std::int64_t frame = 0;
    while (world.time() < scene.duration - 1e-6 * every) {
        const Times start = Times::now();
        const fluid::StepReport step = world.step(scene.duration - world.time());
        const Times spent = Times::now().since(start);
        work.times = {work.times.wall + spent.wall, work.times.cpu + spent.cpu};
        work.add(step, world.particles().count);
        if (world.time() >= (static_cast<double>(frame) + 1 - 1e-6) * every) {
            frame = static_cast<std::int64_t>(world.time() / every + 1e-6);
            write_frame(frames, world);
        }
    }
    const auto steps = static_cast<double>(work.steps);
    std::ofstream cost(out + "/cost.json");
    cost << Json{{"engine", "Wade"},
                 {"particles", world.particles().count},
                 {"particle_mass_kg", world.particle_mass()},
                 {"rest_density_kg_m3", scene.fluid->rest_density},
                 {"steps", work.steps},
                 {"particle_steps", work.particle_steps},
                 {"simulated_s", work.simulated},
                 {"solver_cpu_s", work.times.cpu},
                 {"solver_wall_s", work.times.wall},
                 {"density_iterations", work.density / steps},
                 {"divergence_iterations", work.divergence / steps},
                 {"mean_density_error", work.mean_error / steps},
                 {"max_density_error", work.max_error}}
                .dump()
         << '\n';
    if (!frames.flush() || !cost.flush()) throw std::runtime_error("--frames: " + out + " cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 5 && std::strcmp(argv[1], "--frames") == 0) {
        try {
            write_run(argv[2], argv[3], std::stod(argv[4]));
        } catch (const std::exception& error) {
            std::fprintf(stderr, "bench_fluid: %s\n", error.what());
            return 1;
        }
        return 0;
    }
    return run_program("bench_fluid", argc, argv, run);
}
