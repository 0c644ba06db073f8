#include "other_models.hpp"

#include <algorithm>
#include <string>

#include "configs/exit_code.hpp"

namespace wade::validation {

namespace {

std::string name_of(FluidModel model) {
    switch (model) {
        case FluidModel::dfsph:
            return "dfsph";
        case FluidModel::kinematic:
            return "kinematic";
        case FluidModel::steering:
            return "steering";
        default:
            return "another";
    }
}

}  // namespace

void refuse_other_models(const Scene& scene, std::initializer_list<FluidModel> allowed) {
    if (std::find(allowed.begin(), allowed.end(), scene.fluid.model) != allowed.end()) return;
    std::string names;
    for (const FluidModel model : allowed) names += (names.empty() ? "" : ", ") + name_of(model);
    throw ConfigurationError(scene.name + ": /fluid/model is " + name_of(scene.fluid.model) +
                             "; allowed in this case: " + names);
}

void advance_frame(fluid::steering::SteeringWorld& world, Cost& cost) {
    const double duration = 1 / world.scene().frame_rate;
    const double cpu = process_cpu_time();
    const double wall = wall_time();
    double remaining = duration;
    while (remaining > 1e-9 * duration) {
        remaining -= world.step(remaining).dt;
        ++cost.steps;
        cost.particle_steps += static_cast<double>(world.particles().count);
    }
    cost.simulated_time += duration;
    cost.cpu_time += process_cpu_time() - cpu;
    cost.wall_time += wall_time() - wall;
}

void note_cost(const Cost& cost, const fluid::steering::SteeringWorld& world, Result& result) {
    result.model = "steering";
    result.particles = world.particles().count;
    result.steps = cost.steps;
    result.particle_steps = cost.particle_steps;
    result.simulated_time = cost.simulated_time;
    result.solver_cpu_time = cost.cpu_time;
    result.solver_wall_time = cost.wall_time;
}

}  // namespace wade::validation
