// bench_shallow_water: cell-steps per second of the shallow-water model. A cell-step is one cell over one whole time step,
// the choice of its length and the ghost cells included.

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "fluid_server/shallow_water/column_particles.hpp"
#include "fluid_server/shallow_water/step.hpp"
#include "tests/bench/bench_options.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/scenes.hpp"

namespace {

using namespace wade;
using namespace wade::bench;
namespace swe = fluid::shallow_water;

// The river of the scenes in cells of half a metre, and wider and longer ones.
struct Size {
    double length, width;
    int steps;  // of a round
};
constexpr Size sizes[] = {{100, 27, 1000}, {500, 50, 100}, {1000, 250, 10}};

// What a scene may have besides.
struct Kind {
    const char* name;
    bool friction, obstacles;
};
constexpr Kind kinds[] = {{"shallow_water/river", false, false},
                          {"shallow_water/friction", true, false},
                          {"shallow_water/obstacles", false, true}};

Scene scene_of(const Size& size, const Kind& kind) {
    const auto particles = static_cast<std::uint64_t>(size.length * size.width * 8);  // 0.5 m apart
    Scene scene = river_scene({particles, size.length, size.width, 0.5});
    scene.fluid->model = ModelKind::shallow_water;
    scene.channel->flow = Flow::periodic;
    if (kind.friction) scene.channel->manning_n = 0.03;
    if (kind.obstacles) scene.obstacles = {{{40, 46}, {10, 14}, 3}, {{60, 66}, {15, 20}, 0.5}};
    return scene;
}

// Waves in all directions, so that no cell is like the next.
void make_waves(swe::ShallowWater& world) {
    const auto wave = [](double v, double length) { return std::sin(2 * std::numbers::pi * v / length); };
    // Over a box there is what stands above it.
    const auto bed = [&](double x, double z) {
        double height = 0;
        for (const Obstacle& o : world.scene.obstacles) {
            if (o.x.contains(x) && o.z.contains(z)) height = o.height;
        }
        return height;
    };
    swe::set_water(
        world, [&](double x, double z) { return std::max(0.0, 1 + 0.2 * wave(x, 10) * wave(z, 9) - bed(x, z)); },
        [&](double x, double z) { return -1.5 + 0.3 * wave(x + z, 20); },
        [&](double x, double z) { return 0.3 * wave(x - z, 25); });
}

void bench(const Size& size, const Kind& kind, const Options& options, std::vector<Result>& results) {
    std::map<int, std::vector<double>> rates, cpu_rates;
    std::map<int, swe::StepStages::Seconds> stages;  // s, by number of threads
    std::map<int, double> taken;                     // cell-steps
    const PeakMemory memory;
    swe::ShallowWater world(scene_of(size, kind));
    swe::ColumnParticles particles(world);
    make_waves(world);
    const auto cells = static_cast<double>(world.grid.cells());
    const int steps = options.quick ? std::max(1, size.steps / 10) : size.steps;
    for (int round = 0; round < (options.quick ? 3 : 9); ++round) {
        for (const int threads : options.thread_counts()) {
            omp_set_num_threads(threads);
            const Times start = Times::now();
            for (int k = 0; k < steps; ++k) {
                const swe::StepReport step = swe::step(world, 1);
                for (std::size_t s = 0; s < step.stages.size(); ++s) stages[threads][s] += step.stages[s];
            }
            taken[threads] += cells * steps;
            const Times times = Times::now().since(start);
            rates[threads].push_back(cells * steps / times.wall);
            cpu_rates[threads].push_back(cells * steps / times.cpu);
        }
    }
    const double bytes = static_cast<double>(memory.bytes()) / cells;
    for (const int threads : options.thread_counts()) {
        Result result = result_of(kind.name, world.grid.cells(), threads, rates[threads], "cell_steps_per_s");
        result.extra = {{"cell_steps_per_cpu_s", quantile(cpu_rates[threads], 0.5)},
                        {"best_cell_steps_per_cpu_s", quantile(cpu_rates[threads], 1)},
                        {"bytes_per_cell", bytes}};
        for (std::size_t s = 0; s < swe::stage_names.size(); ++s)
            result.extra.emplace_back(std::string(swe::stage_names[s]) + "_ns_per_cell_step",
                                      1e9 * stages[threads][s] / taken[threads]);
        print(result);
        results.push_back(std::move(result));
    }
}

// Streets of a town in a flood that has filled them, and the same ground without its houses. Here a cell-step is one wet cell
// over one time step: what is done for dry cells, walls and what comes and goes is its cost.
struct SiteKind {
    const char* name;
    bool houses;
};
constexpr SiteKind site_kinds[] = {{"shallow_water/site_houses", true}, {"shallow_water/site_open", false}};
constexpr double filled_after = 240;  // s of the flood

std::size_t wet_cells(const swe::ShallowWater& world) {
    std::size_t wet = 0;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t c = world.grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = c; i < c + world.grid.nx; ++i) {
            wet += world.water.h[i] > world.constants.dry && world.openings.share_of(i) > 0 ? 1U : 0U;
        }
    }
    return wet;
}

void bench_site(const SiteKind& kind, const Options& options, std::vector<Result>& results) {
    Scene scene = bench::scene_of("../sites/merewether/merewether.json");
    if (!kind.houses) scene.site->houses.clear();
    swe::ShallowWater world(scene);
    const double begin = options.quick ? filled_after / 4 : filled_after;
    while (world.time < begin) swe::step(world, begin - world.time);
    std::map<int, std::vector<double>> rates, cpu_rates;
    std::map<int, swe::StepStages::Seconds> stages;  // s, by number of threads
    std::map<int, double> taken;                     // wet cells times steps
    std::size_t wet = wet_cells(world);
    for (int round = 0; round < (options.quick ? 3 : 9); ++round) {
        for (const int threads : options.thread_counts()) {
            omp_set_num_threads(threads);
            swe::step(world, 1);  // shares the rows among the threads anew
            const int steps = options.quick ? 50 : 300;
            const Times start = Times::now();
            for (int k = 0; k < steps; ++k) {
                const swe::StepReport step = swe::step(world, 1);
                for (std::size_t s = 0; s < step.stages.size(); ++s) stages[threads][s] += step.stages[s];
            }
            const Times times = Times::now().since(start);
            wet = wet_cells(world);
            const double cell_steps = static_cast<double>(wet) * steps;
            taken[threads] += cell_steps;
            rates[threads].push_back(cell_steps / times.wall);
            cpu_rates[threads].push_back(cell_steps / times.cpu);
        }
    }
    for (const int threads : options.thread_counts()) {
        Result result = result_of(kind.name, wet, threads, rates[threads], "cell_steps_per_s");
        result.extra = {
            {"cell_steps_per_cpu_s", quantile(cpu_rates[threads], 0.5)},
            {"cells", static_cast<double>(world.grid.cells())},
            {"worked_per_wet_cell", static_cast<double>(swe::active_cells(world)) / static_cast<double>(wet)}};
        for (std::size_t s = 0; s < swe::stage_names.size(); ++s)
            result.extra.emplace_back(std::string(swe::stage_names[s]) + "_ns_per_cell_step",
                                      1e9 * stages[threads][s] / taken[threads]);
        print(result);
        results.push_back(std::move(result));
    }
}

void run(const Options& options, std::vector<Result>& results) {
    for (const Kind& kind : kinds) {
        if (!options.wanted(kind.name)) continue;
        for (const Size& size : sizes) bench(size, kind, options, results);
    }
    for (const SiteKind& kind : site_kinds) {
        if (options.wanted(kind.name)) bench_site(kind, options, results);
    }
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_shallow_water", argc, argv, run);
}
