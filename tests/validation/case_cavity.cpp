// Lid-driven cavity: a steady vortex in a closed box that is full, after many turns of the water.

#include <algorithm>
#include <array>
#include <cmath>

#include "cases.hpp"
#include "ghia_cavity.hpp"
#include "run.hpp"
#include "viscous_measures.hpp"

namespace wade::validation {

namespace {

constexpr double side = 1;       // m
constexpr double lid_speed = 1;  // m/s

// Time until the vortex is steady to within the limits, and over how much of it profiles are averaged, s. The wall layers
// spin up in a few turns of the vortex (about 2 pi / 0.4 s at Re 1000), the core by diffusion.
struct Schedule {
    double duration = 0;
    double averaged = 0;
};
constexpr std::array<Schedule, 3> schedules{{{15, 3}, {30, 5}, {50, 10}}};  // Re 100, 400, 1000

// Root of the mean square of velocity minus Ghia's over the points inside; rows go to the curve.
double compare(const PointSamples& samples, const std::array<GhiaRow, 17>& table, std::size_t column, Curve& curve) {
    double squares = 0;
    double n = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double truth = table[i].velocity[column];
        const double velocity = samples.velocity(i) / lid_speed;
        curve.rows.push_back({table[i].place, velocity, truth});
        const bool on_wall = i == 0 || i + 1 == table.size();
        if (!on_wall && !std::isnan(truth)) {
            squares += (velocity - truth) * (velocity - truth);
            n += 1;
        }
    }
    return std::sqrt(squares / n);
}

template <std::size_t column>
Result run(const Request& request) {
    const Schedule schedule = schedules[column];
    std::vector<std::string> sizes = slice_overrides(request, false);
    sizes.push_back(assign("/channel/water_blocks/0/z_max_m", slice_thickness(request)));
    sizes.push_back(assign("/fluid/viscosity_m2_s", side * lid_speed / ghia_reynolds_numbers[column]));
    sizes.push_back(assign("/duration_s", schedule.duration));
    const Scene scene = scene_for(request, "validation/cavity.json", sizes);
    fluid::FluidWorld world(scene);

    std::vector<std::array<double, 2>> vertical;
    std::vector<std::array<double, 2>> horizontal;
    for (const GhiaRow& row : ghia_u) vertical.push_back({side / 2, side * row.place});
    for (const GhiaRow& row : ghia_v) horizontal.push_back({side * row.place, side / 2});
    const double reach = 2 * scene.fluid.particle_spacing;
    PointSamples u(vertical, 0, reach);
    PointSamples v(horizontal, 1, reach);

    Result result;
    Cost cost;
    Curve energy{"kinetic_energy", {"time_s", "energy_per_mass_m2_s2"}, {}};
    const int frames = frames_in(scene, scene.duration);
    const int averaged = std::min(frames, frames_in(scene, schedule.averaged));
    double before = 0;
    for (int frame = 1; frame <= frames; ++frame) {
        advance_frame(world, cost);
        const double kinetic = specific_kinetic_energy(world.particles());
        if (frame % static_cast<int>(std::max(1.0, scene.frame_rate / 4)) == 0) {
            energy.rows.push_back({frame / scene.frame_rate, kinetic});
        }
        if (frame == frames - averaged) {
            before = kinetic;
        }
        if (frame > frames - averaged) {
            u.add(world.particles());
            v.add(world.particles());
        }
    }
    Curve curve_u{"u_on_vertical_centre_line", {"y_over_side", "u_over_lid_speed", "measured_ghia"}, {}};
    Curve curve_v{"v_on_horizontal_centre_line", {"x_over_side", "v_over_lid_speed", "measured_ghia"}, {}};
    result.metrics.push_back({"u_rms", compare(u, ghia_u, column, curve_u), "1"});
    result.metrics.push_back({"v_rms", compare(v, ghia_v, column, curve_v), "1"});
    // How steady the flow is that was averaged.
    result.metrics.push_back({"energy_change", std::abs(specific_kinetic_energy(world.particles()) / before - 1), "1"});
    note_solver(cost, world, result);
    note_cost(cost, world, result);
    result.curves = {curve_u, curve_v, energy};
    return result;
}

Case make_case(std::size_t column, Result (*run_case)(const Request&), std::size_t long_from) {
    const std::string number = std::to_string(ghia_reynolds_numbers[column]);
    Case c;
    c.name = "cavity_" + number;
    c.truth = "Steady flow in a square cavity with a moving lid at Reynolds number " + number +
              ", tables of Ghia, Ghia and Shin (1982): RMS of the difference over their points between the walls, in "
              "units of the lid's speed.";
    c.reference = "Ghia et al. 1982";
    c.spacings = {1.0 / 32, 1.0 / 64, 1.0 / 128};
    c.long_from = long_from;
    c.run = run_case;
    return c;
}

}  // namespace

Case cavity_100_case() {
    return make_case(0, run<0>, 2);
}

Case cavity_400_case() {
    return make_case(1, run<1>, 2);
}

Case cavity_1000_case() {
    return make_case(2, run<2>, 2);
}

}  // namespace wade::validation
