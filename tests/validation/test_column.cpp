// Water at rest: pressure, weight, density and stillness are known.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <vector>

#include "run_frames.hpp"

using namespace wade;
using namespace wade::fluid;

TEST_CASE("a column of ten layers rests for ten seconds under its own weight", "[validation][column]") {
    const Scene scene = test::shipped_scene("validation/column.json");
    FluidWorld world(scene);
    const double depth = 1;
    const double g = scene.world.gravity;
    const double rho = scene.fluid.rest_density;
    const double d = scene.fluid.particle_spacing;
    const int frames = static_cast<int>(std::lround(scene.duration * scene.frame_rate));
    const int averaged = static_cast<int>(std::lround(2 * scene.frame_rate));  // the last two seconds

    const auto layers = static_cast<std::size_t>(std::lround(depth / d));
    std::vector<double> pressure(layers, 0);
    std::vector<double> height(layers, 0);
    double force = 0;
    double time = 0;
    double speed = 0;    // m/s, RMS over particles and averaged frames
    double fastest = 0;  // m/s, of any particle in any averaged frame
    double density_error = 0;
    int steps = 0;
    int iterations = 0;
    for (int f = 1; f <= frames; ++f) {
        const bool average = f > frames - averaged;
        test::advance_one_frame(world, [&](const StepReport& step) {
            density_error = std::max(density_error, step.max_density_error);
            ++steps;
            iterations += step.density.iterations;
            if (average) {
                force += (world.bed_pressure_force() + step.contact_force) * step.dt;
                time += step.dt;
            }
        });
        if (!average) {
            continue;
        }
        // The column rests in layers: sort by height, a tenth of the particles each.
        const Particles& p = world.particles();
        std::vector<std::size_t> order(p.count);
        for (std::size_t i = 0; i < p.count; ++i) {
            order[i] = i;
            const double v2 = static_cast<double>(p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
            speed += v2 / static_cast<double>(p.count) / averaged;
            fastest = std::max(fastest, std::sqrt(v2));
        }
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p.y[a] < p.y[b]; });
        for (std::size_t k = 0; k < p.count; ++k) {
            const std::size_t layer = k * layers / p.count;
            const double share = static_cast<double>(layers) / static_cast<double>(p.count) / averaged;
            const std::size_t i = order[k];
            pressure[layer] += rho * static_cast<double>(p.density_pressure[i] + p.divergence_pressure[i]) * share;
            height[layer] += static_cast<double>(p.y[i]) * share;
        }
    }
    speed = std::sqrt(speed);
    double squares = 0;
    double mean_height = 0;
    for (std::size_t k = 0; k < layers; ++k) {
        mean_height += height[k] / static_cast<double>(layers);
        if (k > 0 && k + 1 < layers) {
            squares += std::pow((pressure[k] - rho * g * (depth - height[k])) / (rho * g * depth), 2);
        }
    }
    const double rms = std::sqrt(squares / static_cast<double>(layers - 2));
    const double weight = static_cast<double>(world.particles().count) * static_cast<double>(world.particle_mass()) * g;
    std::cout << "column: pressure RMS " << 100 * rms << " % of rho g H, bed force / weight " << force / time / weight
              << ", surface " << 2 * mean_height << " m, max density error " << 100 * density_error << " %, RMS speed "
              << 100 * speed / std::sqrt(g * depth) << " % of sqrt(g H), fastest particle "
              << 100 * fastest / std::sqrt(g * depth) << " %, " << steps << " steps, "
              << static_cast<double>(iterations) / steps << " iterations a step\n";

    // Thresholds: 3 % pressure is what other SPH codes report for hydrostatic plates (3 to 4.5 %); weight is a momentum
    // balance and exact but for what still moves; the rest is what a viewer would notice.
    CHECK(rms <= 0.03);
    CHECK(force / time == Approx(weight).epsilon(0.005));
    CHECK(2 * mean_height == Approx(depth).epsilon(0.01));
    CHECK(density_error <= 0.01);
    CHECK(speed <= 0.01 * std::sqrt(g * depth));
    // Single particles still change places as the packing ages, see the limits in README.md. SPlisHSPlasH shows 1 to 11 %
    // for the fastest particle after 4 s, depending on its boundaries.
    CHECK(fastest <= 0.05 * std::sqrt(g * depth));
    CHECK(world.position_clamps() == 0);
}
