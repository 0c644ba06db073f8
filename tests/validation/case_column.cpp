// Water at rest: pressure, weight, density and stillness are known.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "run.hpp"

namespace wade::validation {

namespace {

// Sums over the last frames of the run.
struct Rest {
    std::vector<double> pressure, height;  // of each layer: Pa, m
    double impulse = 0;                    // of the force on the bed, N s
    double time = 0;                       // s
    double rms_speed = 0;                  // m/s, largest of all frames
    double fastest = 0;                    // m/s
};

// The column rests in layers: sorts the particles by height and takes an equal share of them for each layer.
void sample_layers(const fluid::Particles& p, double density, double frames, Rest& rest) {
    std::vector<std::size_t> order(p.count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p.y[a] < p.y[b]; });
    const std::size_t layers = rest.pressure.size();
    const double share = static_cast<double>(layers) / static_cast<double>(p.count) / frames;
    for (std::size_t k = 0; k < p.count; ++k) {
        const std::size_t layer = k * layers / p.count;
        const std::size_t i = order[k];
        rest.pressure[layer] += density * static_cast<double>(p.pressure[i]) * share;
        rest.height[layer] += static_cast<double>(p.y[i]) * share;
    }
}

void sample_speeds(const fluid::Particles& p, Rest& rest) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const double v2 = static_cast<double>(p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
        sum += v2;
        rest.fastest = std::max(rest.fastest, std::sqrt(v2));
    }
    rest.rms_speed = std::max(rest.rms_speed, std::sqrt(sum / static_cast<double>(p.count)));
}

Result run_column(const Request& request) {
    const Scene scene = scene_for(request, "validation/column.json");
    fluid::FluidWorld world(scene);
    const double depth = scene.channel->water_blocks.at(0).depth;
    const double g = scene.world->gravity;
    const int frames = frames_in(scene, scene.duration);
    const int averaged = std::min(frames_in(scene, 2), frames);  // the last two seconds

    Rest rest;
    const auto layers = static_cast<std::size_t>(std::lround(depth / scene.fluid->particle_spacing));
    rest.pressure.assign(layers, 0);
    rest.height.assign(layers, 0);
    Cost cost;
    for (int f = 1; f <= frames; ++f) {
        const bool average = f > frames - averaged;
        advance_frame(world, cost, [&](const fluid::StepReport& step) {
            if (average) {
                rest.impulse += (world.bed_pressure_force() + step.contact_force) * step.dt;
                rest.time += step.dt;
            }
        });
        if (average) {
            sample_layers(world.particles(), scene.fluid->rest_density, averaged, rest);
            sample_speeds(world.particles(), rest);
        }
    }

    Result result;
    note_cost(cost, world, result);
    Curve curve{"pressure", {"y_m", "pressure_Pa", "exact_pressure_Pa"}, {}};
    double squares = 0;
    const double whole = scene.fluid->rest_density * g * depth;
    for (std::size_t k = 0; k < layers; ++k) {
        const double exact = scene.fluid->rest_density * g * (depth - rest.height[k]);
        curve.rows.push_back({rest.height[k], rest.pressure[k], exact});
        if (k > 0 && k + 1 < layers) {
            squares += std::pow((rest.pressure[k] - exact) / whole, 2);
        }
    }
    const double weight = static_cast<double>(world.particles().count) * static_cast<double>(world.particle_mass()) * g;
    const double mean_height =
        std::accumulate(rest.height.begin(), rest.height.end(), 0.0) / static_cast<double>(layers);
    const double wave = std::sqrt(g * depth);
    result.metrics = {
        {"pressure_rms", std::sqrt(squares / static_cast<double>(layers - 2)), "1"},
        {"bed_force", std::abs(rest.impulse / rest.time / weight - 1), "1"},
        {"surface_drop", std::abs(2 * mean_height / depth - 1), "1"},
        {"rms_speed", rest.rms_speed / wave, "1"},
        {"fastest_particle", rest.fastest / wave, "1"},
        {"max_density_error", cost.max_density_error, "1"},
        {"density_iterations", cost.density_iterations / static_cast<double>(cost.steps), "1"},
        {"position_clamps", static_cast<double>(world.position_clamps()), "1"},
    };
    result.curves = {curve};
    return result;
}

}  // namespace

Case column_case() {
    return {
        .name = "column",
        .truth =
            "Water at rest, 1 m deep, for 10 s: the pressure is rho g (H - y), the force on the bed the weight, and "
            "nothing moves. Means of the last 2 s; pressure by layers without the first and the last, RMS over "
            "rho g H; speeds over sqrt(g H).",
        .reference = "rho g (H - y)",
        .spacings = {0.1, 0.05, 0.025},
        .quick = true,
        .run = run_column};
}

}  // namespace wade::validation
