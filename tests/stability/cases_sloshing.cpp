// Waves in a tank: left alone for long, and driven.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "stability_case.hpp"
#include "water_run.hpp"

namespace wade::stability {

namespace {

using fluid::FluidWorld;

Result sloshing(const Request& request) {
    return run_water(scene_for(request, "sloshing", {"/duration_s=4"}));
}

// Gives all particles the same change of velocity along x; returns the work that it does, J.
double push(FluidWorld& world, double change) {
    fluid::FluidState state;
    world.capture(state);
    double momentum = 0;  // of unit masses
    for (std::size_t i = 0; i < state.particles.count; ++i) {
        momentum += static_cast<double>(state.particles.vx[i]) + change / 2;
        state.particles.vx[i] += static_cast<float>(change);
    }
    world.restore(state, "push");
    return static_cast<double>(world.particle_mass()) * momentum * change;
}

// Seen from a tank that moves by A sin(w t), A w^2 sin(w t) acts on the water, here as a push a frame. At w = sqrt(g k
// tanh(k H)), k = pi / L, linear theory (Faltinsen and Timokha 2009, ch. 5) lets the first mode grow as
// P A w t / 2, P = 4 tanh(k H) / pi, at the walls. Half of it after 4 s, before it breaks, shows that the tank is shaken.
Result sloshing_resonance(const Request& request) {
    const Scene scene = scene_for(request, "sloshing_resonance", {"/duration_s=4"});
    const WaterBlock& water = scene.channel->water_blocks.at(0);
    const double k = std::numbers::pi / scene.channel->x.length();
    const double w = std::sqrt(scene.world->gravity * k * std::tanh(k * water.depth));
    const double amplitude = 0.05;
    const double frame = 1 / scene.frame_rate;
    const double d = scene.fluid->particle_spacing;
    double run_up = 0;
    Hooks hooks;
    hooks.before_frame = [&](FluidWorld& world, double t) {
        return push(world, amplitude * w * w * std::sin(w * t) * frame);
    };
    hooks.after_frame = [&](const FluidWorld& world, double, Result&) {
        const fluid::Particles& p = world.particles();
        for (std::size_t i = 0; i < p.count; ++i) {
            const auto x = static_cast<double>(p.x[i]);
            if (x > scene.channel->x.lo + d && x < scene.channel->x.hi - d) continue;
            run_up = std::max(run_up, static_cast<double>(p.y[i]) + d / 2 - water.depth);
        }
    };
    Result result = run_water(scene, hooks);
    const double linear = 4 * std::tanh(k * water.depth) / std::numbers::pi * amplitude * w * 4 / 2;
    check_at_least(result, "run_up_over_linear", run_up / linear, 0.5);
    return result;
}

}  // namespace

std::vector<Case> sloshing_cases() {
    return {
        {"sloshing", "water that sloshes in its first mode for long", sloshing},
        {"sloshing_resonance", "a tank that is shaken near resonance until its waves break", sloshing_resonance},
    };
}

}  // namespace wade::stability
