// The same flow at another scale, or cut into other frames, must be the same.

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "stability_case.hpp"
#include "water_run.hpp"

namespace wade::stability {

namespace {

using fluid::FluidWorld;
using fluid::Particles;

// Of a dam break, in units of the depth H of the reservoir, sqrt(g H), and the energy at the start.
struct Likeness {
    double front = 0;   // position of the foremost particle
    double height = 0;  // mean height of the particles
    double x = 0;       // mean position along x
    double speed = 0;   // root of the mean square
};

Likeness measure(const FluidWorld& world) {
    const Particles& p = world.particles();
    const double depth = world.scene().channel->water_blocks.at(0).depth;
    const double wave = std::sqrt(world.scene().world->gravity * depth);
    const double share = 1 / static_cast<double>(std::max<std::size_t>(p.count, 1));
    Likeness l{1e9, 0, 0, 0};
    double squares = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const double x = static_cast<double>(p.x[i]) / depth;
        l.front = std::min(l.front, x);
        l.x += x * share;
        l.height += static_cast<double>(p.y[i]) / depth * share;
        squares += (std::pow(static_cast<double>(p.vx[i]), 2) + std::pow(static_cast<double>(p.vy[i]), 2) +
                    std::pow(static_cast<double>(p.vz[i]), 2)) *
                   share;
    }
    l.speed = std::sqrt(squares) / wave;
    return l;
}

Result run_to_likeness(const Scene& scene, Likeness& likeness) {
    Hooks hooks;
    hooks.after_frame = [&](const FluidWorld& world, double, Result&) { likeness = measure(world); };
    return run_water(scene, hooks);
}

// 1 %: of a flow that is not yet chaotic (t sqrt(g / H) = 2) only rounding differs, or the cut into steps. The foremost
// particle is one single one and may differ by a spacing.
void compare(Result& result, const Likeness& a, const Likeness& b, double spacing_over_depth) {
    check_at_most(result, "front_differs_by_spacings", std::abs(a.front - b.front) / spacing_over_depth, 1);
    check_at_most(result, "mean_x_differs", std::abs(a.x / b.x - 1), 0.01);
    check_at_most(result, "mean_height_differs", std::abs(a.height / b.height - 1), 0.01);
    check_at_most(result, "rms_speed_differs", std::abs(a.speed / b.speed - 1), 0.01);
}

// Froude's law: lengths by s, times by sqrt(s), the viscosity by s^1.5.
Scene scaled(Scene scene, double s) {
    const auto scale = [s](Interval& i) { i = {i.lo * s, i.hi * s}; };
    scene.world->length *= s;
    scene.world->width *= s;
    scale(scene.channel->x);
    scale(scene.channel->z);
    for (WaterBlock& block : scene.channel->water_blocks) {
        scale(block.x);
        scale(block.z);
        block.depth *= s;
    }
    scene.channel->depth *= s;
    scene.channel->height *= s;
    scene.fluid->particle_spacing *= s;
    scene.fluid->kinematic_viscosity *= std::pow(s, 1.5);
    scene.duration *= std::sqrt(s);
    scene.frame_rate /= std::sqrt(s);
    return scene;
}

Result scaled_by(const Request& request, double s) {
    const Scene scene = scene_for(request, "dam");
    Likeness original;
    Likeness other;
    const Result first = run_to_likeness(scene, original);
    Result result = run_to_likeness(scaled(scene, s), other);
    if (result.failure.empty()) result.failure = first.failure;
    compare(result, other, original, scene.fluid->particle_spacing / scene.channel->water_blocks.at(0).depth);
    return result;
}

Result scale_small(const Request& request) {
    return scaled_by(request, 1e-2);
}
Result scale_large(const Request& request) {
    return scaled_by(request, 1e3);
}

// Between two steps the centre of mass moves by what the velocities say and by the little that the density solve moves the
// particles away from a wall, at frame borders too, and a run that is cut into other frames ends alike.
Result frame_borders(const Request& request) {
    Scene scene = scene_for(request, "dam");
    const double d = scene.fluid->particle_spacing;
    double worst = 0;
    double last = 0;
    Hooks hooks;
    const auto mean_x = [](const Particles& p, const std::vector<float>& field) {
        double sum = 0;
        for (std::size_t i = 0; i < p.count; ++i) sum += static_cast<double>(field[i]);
        return sum / static_cast<double>(p.count);
    };
    hooks.start = [&](FluidWorld& world) { last = mean_x(world.particles(), world.particles().x); };
    hooks.after_step = [&](const FluidWorld& world, const fluid::StepReport& step, Result&) {
        const Particles& p = world.particles();
        const double now = mean_x(p, p.x);
        worst = std::max(worst, std::abs(now - last - step.dt * mean_x(p, p.vx)) / d);
        last = now;
    };
    Likeness coarse;
    Likeness fine;
    hooks.after_frame = [&](const FluidWorld& world, double, Result&) { coarse = measure(world); };
    Result result = run_water(scene, hooks);
    scene.frame_rate *= 4;
    const Result other = run_to_likeness(scene, fine);
    if (result.failure.empty()) result.failure = other.failure;
    // The density solve holds the mean density to 5e-4, here of a block 10 spacings long: it moves the centre by about
    // 5e-4 * 10 / 2 spacings at most.
    check_at_most(result, "jump_over_spacing", worst, 2.5e-3);
    compare(result, coarse, fine, d / scene.channel->water_blocks.at(0).depth);
    return result;
}

}  // namespace

std::vector<Case> likeness_cases() {
    return {
        {"scale_0.01", "lengths in centimetres: constants with hidden units", scale_small},
        {"scale_1000", "lengths in kilometres: constants with hidden units", scale_large},
        {"frame_borders", "jumps at the borders of steps and files (SPlisHSPlasH #191)", frame_borders},
    };
}

}  // namespace wade::stability
