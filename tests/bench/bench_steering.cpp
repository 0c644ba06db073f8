// bench_steering: particle-steps of the steering water over those of DFSPH, in the same scene with as many neighbours.

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/steering/steering_world.hpp"
#include "tests/bench/bench_options.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/scenes.hpp"

namespace {

using namespace wade;
using namespace wade::bench;
using fluid::steering::SteeringWorld;

struct Work {
    double particle_steps = 0, steps = 0, cpu = 0, new_lists = 0;
    [[nodiscard]] double rate() const { return particle_steps / cpu; }
};

// Advances by `time` s of the water in whole frames.
template <typename World, typename OnStep>
Work run_for(World& world, double time, OnStep&& on_step) {
    const double frame = 1 / world.scene().frame_rate;
    const auto frames = std::max<std::int64_t>(1, std::llround(time / frame));
    Work work;
    const Times start = Times::now();
    for (std::int64_t f = 0; f < frames; ++f) {
        double remaining = frame;
        while (remaining > 1e-9 * frame) {
            const auto step = world.step(remaining);
            remaining -= step.dt;
            work.steps += 1;
            work.particle_steps += static_cast<double>(world.particles().count);
            on_step(step, work);
        }
    }
    work.cpu = Times::now().since(start).cpu;
    return work;
}

Work run(fluid::FluidWorld& world, double time) {
    return run_for(world, time, [](const fluid::StepReport&, Work&) {});
}
Work run(SteeringWorld& world, double time) {
    return run_for(world, time, [](const fluid::steering::SteeringStep& step, Work& work) {
        work.new_lists += step.new_lists ? 1 : 0;
    });
}

// Returns the scene with steering water and an outer radius that holds about `wanted` neighbours, mirror particles
// included: as many as in DFSPH.
Scene with_as_many_neighbours(Scene scene, double wanted, double warm_up) {
    scene.fluid->model = wade::ModelKind::steering;
    scene.fluid->steering.cohesion.weight = 0.01;  // off it would need no neighbours
    for (int turn = 0; turn < 3; ++turn) {
        SteeringWorld world(scene);
        run(world, warm_up);
        const double factor = std::cbrt(wanted / world.neighbours());
        scene.fluid->steering.cohesion.radius = std::min(3.0, scene.fluid->steering.cohesion.radius * factor);
    }
    return scene;
}

void compare(const std::string& name, const Scene& scene, double warm_up, double round, int rounds, int threads,
             std::vector<Result>& results) {
    omp_set_num_threads(threads);
    fluid::FluidWorld dfsph(scene);
    run(dfsph, warm_up);
    const double pairs = static_cast<double>(dfsph.pairs()) / static_cast<double>(dfsph.particles().count) - 1;
    SteeringWorld steering(with_as_many_neighbours(scene, pairs, warm_up / 4));
    run(steering, warm_up);
    // The two take turns, so that both meet the same machine.
    std::vector<double> ratios, of_dfsph, of_steering, per_second;
    Work all;
    double cpu_dfsph = 0;
    for (int k = 0; k < rounds; ++k) {
        const Work a = run(dfsph, round);
        const Work b = run(steering, round);
        of_dfsph.push_back(a.rate());
        of_steering.push_back(b.rate());
        ratios.push_back(b.rate() / a.rate());
        per_second.push_back(a.cpu / b.cpu);
        cpu_dfsph += a.steps;
        all.steps += b.steps;
        all.new_lists += b.new_lists;
    }
    const auto size = static_cast<std::uint64_t>(dfsph.particles().count);
    Result result = result_of(name, size, threads, ratios, "times_the_particle_steps_of_dfsph");
    result.extra = {{"particle_steps_per_cpu_s", quantile(of_steering, 0.5)},
                    {"particle_steps_per_cpu_s_of_dfsph", quantile(of_dfsph, 0.5)},
                    {"times_the_simulated_time_of_dfsph", quantile(per_second, 0.5)},
                    {"neighbours", steering.neighbours()},
                    {"neighbours_of_dfsph", pairs},
                    {"steps", all.steps},
                    {"steps_of_dfsph", cpu_dfsph},
                    {"steps_with_new_lists", all.new_lists}};
    print(result);
    results.push_back(std::move(result));
}

void run_all(const Options& options, std::vector<Result>& results) {
    const int rounds = options.quick ? 3 : 7;
    for (const int threads : options.thread_counts()) {
        if (options.wanted("steering/column_at_rest"))
            compare("steering/column_at_rest", scene_of("column_at_rest.json"), 1, 0.2, rounds, threads, results);
        if (options.wanted("steering/river")) {
            compare("steering/river", river_scene(river_2_layers), 2, 1, rounds, threads, results);
            if (!options.quick)
                compare("steering/river", river_scene(river_4_layers), 1, 0.2, rounds, threads, results);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_steering", argc, argv, run_all);
}
