#pragma once
// Advances a water and counts what it costs.

#include <algorithm>
#include <cstddef>

#include "fluid_server/dfsph/fluid_world.hpp"
#include "validation_case.hpp"

namespace wade::validation {

// CPU time of this process with all its threads, s.
double process_cpu_time();

// Wall time since some fixed moment, s.
double wall_time();

// Cost of a run, without set-up and measurement.
struct Cost {
    std::size_t steps = 0;
    double particle_steps = 0;
    double simulated_time = 0;     // s
    double cpu_time = 0;           // s
    double wall_time = 0;          // s
    double max_density_error = 0;  // of any particle in any step
    double density_iterations = 0;
    double divergence_iterations = 0;
};

// Writes the cost and the number of particles into the result.
void note_cost(const Cost& cost, const fluid::FluidWorld& world, Result& result);

// Frames in a time, rounded. time: s
int frames_in(const Scene& scene, double time);

// Throws ConfigurationError if the scene names another model: cases that measure what only DFSPH has would run it unasked.
void check_is_dfsph(const Scene& scene);

// Advances by `duration` seconds and calls on_step(report) after each sub-step. What on_step does is counted as solver
// time: keep it short, and measure between the frames.
template <typename OnStep>
void advance(fluid::FluidWorld& world, double duration, Cost& cost, OnStep&& on_step) {
    check_is_dfsph(world.scene());
    const double cpu = process_cpu_time();
    const double wall = wall_time();
    double remaining = duration;
    while (remaining > 1e-9 * duration) {
        const fluid::StepReport report = world.step(remaining);
        remaining -= report.dt;
        ++cost.steps;
        cost.particle_steps += static_cast<double>(world.particles().count);
        cost.max_density_error = std::max(cost.max_density_error, report.max_density_error);
        cost.density_iterations += report.density.iterations;
        cost.divergence_iterations += report.divergence.iterations;
        on_step(report);
    }
    cost.simulated_time += duration;
    cost.cpu_time += process_cpu_time() - cpu;
    cost.wall_time += wall_time() - wall;
}

inline void advance(fluid::FluidWorld& world, double duration, Cost& cost) {
    advance(world, duration, cost, [](const fluid::StepReport&) {});
}

// One frame of the scene.
template <typename OnStep>
void advance_frame(fluid::FluidWorld& world, Cost& cost, OnStep&& on_step) {
    advance(world, 1 / world.scene().frame_rate, cost, on_step);
}

inline void advance_frame(fluid::FluidWorld& world, Cost& cost) {
    advance(world, 1 / world.scene().frame_rate, cost);
}

}  // namespace wade::validation
