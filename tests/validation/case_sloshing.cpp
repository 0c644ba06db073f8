// Standing wave in a tank: the first mode of potential flow.

#include <cmath>
#include <numbers>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/world.hpp"
#include "damped_cosine.hpp"
#include "run.hpp"
#include "slice.hpp"

namespace wade::validation {

namespace {

// Height of the first crest, of the depth. Small enough for linear theory: above k h = 1.058 the period of a standing
// wave rises with its amplitude (Tadjbakhsh and Keller 1960), here, k h = 1.57, by 0.097 (k a)^2 = 0.06 %. Large enough
// for the particles: its velocities are seven times those of still water that creeps (1 % of sqrt(g H)).
constexpr double amplitude = 0.05;

double centroid(const fluid::Particles& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        sum += static_cast<double>(p.x[i]);
    }
    return sum / static_cast<double>(p.count);
}

Result run_sloshing(const Request& request) {
    const Scene scene = scene_for(request, "validation/sloshing.json", slice_sizes(request, 1));
    fluid::FluidWorld world(scene);
    const double h = scene.channel->water_blocks.at(0).depth;
    const double length = scene.channel->x.length();
    const double k = std::numbers::pi / length;
    const double omega = std::sqrt(scene.world->gravity * k * std::tanh(k * h));
    // The surface is level at t = 0 and rises at a omega cos(k x): u = -grad phi with
    // phi = -a omega cos(k x) cosh(k y) / (k sinh(k h)).
    const double rise = amplitude * h * omega / std::sinh(k * h);
    world.set_velocity([&](const std::array<double, 3>& place) {
        const double x = place[0] - scene.channel->x.lo;
        return std::array<double, 3>{-rise * std::sin(k * x) * std::cosh(k * place[1]),
                                     rise * std::cos(k * x) * std::sinh(k * place[1]), 0};
    });

    std::vector<double> times, places;
    Cost cost;
    const double rest = centroid(world.particles());
    const int frames = frames_in(scene, scene.duration);
    for (int f = 1; f <= frames; ++f) {
        advance_frame(world, cost);
        times.push_back(f / scene.frame_rate);
        places.push_back(centroid(world.particles()) - rest);
    }

    const DampedCosine fit = fit_damped_cosine(times, places, omega);
    // The centroid of the wave: x of (1 / (h L)) integral of a cos(k x) x dx = -2 a L / (pi^2 h).
    const double exact = -2 * amplitude * length / (std::numbers::pi * std::numbers::pi);
    Result result;
    note_cost(cost, world, result);
    Curve curve{"centroid", {"t_s", "x_m", "exact_x_m"}, {}};
    for (std::size_t i = 0; i < times.size(); ++i) {
        curve.rows.push_back({times[i], places[i], exact * std::sin(omega * times[i])});
    }
    result.metrics = {
        {"period", std::abs(omega / fit.omega - 1), "1"},
        {"damping_per_period", 1 - std::exp(-fit.damping * 2 * std::numbers::pi / fit.omega), "1"},
        {"amplitude", std::abs(std::hypot(fit.a, fit.b) / std::abs(exact) - 1), "1"},
        {"fit_residual", fit.residual, "1"},
        {"max_density_error", cost.max_density_error, "1"},
    };
    result.curves = {curve};
    return result;
}

}  // namespace

Case sloshing_case() {
    return {.name = "sloshing",
            .truth =
                "First mode of a standing wave in a tank 1 m long with 0.5 m of water, potential flow: omega^2 = g k "
                "tanh(k h), k = pi/L, a period of 1.1818 s. It starts with the mode's velocity, 5 % of the depth high; "
                "period and damping from a least-squares fit of the centroid over eight periods. damping_per_period: "
                "part of the amplitude lost in a period; potential flow loses nothing. amplitude: error of the fitted "
                "one.",
            .reference = "potential flow",
            .spacings = {0.05, 0.025, 0.0125},
            .quick = true,
            .starts = 5,
            .run = run_sloshing};
}

}  // namespace wade::validation
