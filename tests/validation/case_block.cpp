// A block in a stream: the force that drives the stream must be the force on the block and the change of momentum.

#include <cmath>
#include <string>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "run.hpp"

namespace wade::validation {

namespace {

constexpr double block_settling = 10;  // s: ten times as long as the stream takes past the block

// Momentum of the water towards -x, kg m/s.
double momentum(const fluid::FluidWorld& world) {
    const fluid::Particles& p = world.particles();
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        sum -= static_cast<double>(p.vx[i]);
    }
    return sum * static_cast<double>(world.particle_mass());
}

Result run_block(const Request& request) {
    const Scene scene = scene_for(request, "validation/block.json");
    fluid::FluidWorld world(scene);
    const double mass = static_cast<double>(world.particles().count) * static_cast<double>(world.particle_mass());
    Cost cost;
    advance(world, block_settling, cost);

    const double before = momentum(world);
    double driving = 0;  // N s
    double drag = 0;     // N s, on the block, towards -x
    Curve curve{"force", {"t_s", "drag_n", "driving_n"}, {}};
    const int frames = frames_in(scene, scene.duration - block_settling);
    for (int frame = 1; frame <= frames; ++frame) {
        const double driving_before = driving;
        const double drag_before = drag;
        advance_frame(world, cost, [&](const fluid::StepReport& step) {
            driving += mass * step.driving_acceleration * step.dt;
            drag -= world.obstacle_force(0)[0] * step.dt;
        });
        curve.rows.push_back({block_settling + frame / scene.frame_rate, (drag - drag_before) * scene.frame_rate,
                              (driving - driving_before) * scene.frame_rate});
    }
    const double change = momentum(world) - before;
    const double duration = frames / scene.frame_rate;

    const Channel& channel = scene.channel;
    const double area = scene.obstacles.at(0).z.length() * channel.depth;
    const double stagnation = 0.5 * scene.fluid->rest_density * channel.velocity * channel.velocity;
    Result result;
    note_cost(cost, world, result);
    result.metrics = {{"closure", std::abs((driving - change) / drag - 1), "1"},
                      {"drag_coefficient", drag / duration / (stagnation * area), "1"},
                      {"drag", drag / duration, "N"},
                      {"momentum_change", std::abs(change / drag), "1"},
                      {"max_density_error", cost.max_density_error, "1"}};
    result.curves.push_back(curve);
    return result;
}

}  // namespace

Case block_case() {
    Case c;
    c.name = "block";
    c.truth =
        "Momentum: what the driving force gives to the water and the water does not keep is the force on the block, "
        "F = M a - dP/dt, each integrated over 10 s; bed and sides are frictionless. The drag coefficient, for the "
        "bulk speed and the wet front of the block, is reported.";
    c.reference = "momentum budget";
    c.spacings = {0.2, 0.1, 1.0 / 15};
    c.run = run_block;
    return c;
}

}  // namespace wade::validation
