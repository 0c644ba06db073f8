#include "run.hpp"

#include <chrono>
#include <cmath>
#include <ctime>

#include "configs/errors/exit_code.hpp"

namespace wade::validation {

double process_cpu_time() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_time() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void check_is_dfsph(const Scene& scene) {
    if (scene.fluid.model == ModelKind::dfsph) return;
    throw ConfigurationError(scene.name + ": /fluid/model: this case measures particles of DFSPH; allowed: \"dfsph\".");
}

void note_cost(const Cost& cost, const fluid::FluidWorld& world, Result& result) {
    result.particles = world.particles().count;
    result.steps = cost.steps;
    result.particle_steps = cost.particle_steps;
    result.simulated_time = cost.simulated_time;
    result.solver_cpu_time = cost.cpu_time;
    result.solver_wall_time = cost.wall_time;
}

int frames_in(const Scene& scene, double time) {
    return static_cast<int>(std::lround(time * scene.frame_rate));
}

}  // namespace wade::validation
