#include "fluid_server/dfsph/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"

namespace wade::fluid {

namespace {

// Returns the time to travel the distance `way` at `speed`, s; infinity if the speed is 0.
double time_for(double way, double speed) {
    return speed > 0 ? way / speed : std::numeric_limits<double>::infinity();
}

}  // namespace

double fastest_plane(const Channel& channel) {
    double fastest = 0;
    for (const NoSlip& wall : channel.no_slip) {
        const auto& v = wall.velocity;
        fastest = std::max(fastest, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return fastest;
}

TimeStep longest_step(const Fluid& fluid, const WaterSpeeds& speeds, double remaining) {
    const double d = fluid.particle_spacing, v = speeds.fastest, wave = speeds.wave;
    const double deep = std::min(1.0, std::pow(layers_of_pressure_limit / speeds.layers, power_of_pressure_limit));
    double dt = std::min({remaining, time_for(fluid.cfl * d, v + wave),
                          time_for(deep * pressure_limit * d, speeds.pressure), time_for(way_limit * d, v)});
    if (fluid.kinematic_viscosity > 0) {
        dt = std::min(dt, viscous_limit * d * d / fluid.kinematic_viscosity);
    }
    dt = remaining / std::ceil(remaining / dt);
    const double reference = time_for(reference_cfl * d, v + wave);
    return {dt, std::isinf(reference) ? 1 : static_cast<float>(std::min(1.0, dt / reference))};
}

}  // namespace wade::fluid
