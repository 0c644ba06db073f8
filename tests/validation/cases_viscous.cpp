// Laminar flows.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "run.hpp"
#include "viscous_exact.hpp"
#include "viscous_measures.hpp"

namespace wade::validation {
namespace {

// Start-up of Poiseuille and of Couette flow between no-slip planes: tests viscosity and no-slip boundaries.

// s; the profiles that Morris et al. (1997) show, the last is steady.
constexpr std::array couette_times{0.0225, 0.045, 0.1125, 0.225, 1.0};

// Exact velocity along +x at height y and time t, m/s.
using Profile = std::function<double(double y, double t)>;

struct ProfileError {
    double relative = 0;   // RMS of the error over RMS of the exact velocity
    double of_peak = 0;    // RMS of the error over the steady peak
    double amplitude = 0;  // of the exact profile that fits best; 1 is exact
};

ProfileError profile_error(const fluid::Particles& p, const Profile& exact, double t, double peak) {
    double errors = 0, squares = 0, products = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const double truth = exact(static_cast<double>(p.y[i]), t);
        const auto u = static_cast<double>(p.vx[i]);
        errors += (u - truth) * (u - truth);
        squares += truth * truth;
        products += u * truth;
    }
    return {std::sqrt(errors / squares), std::sqrt(errors / static_cast<double>(p.count)) / peak, products / squares};
}

// Mean velocity of each layer beside the exact one there.
void add_profile(const fluid::Particles& p, const Profile& exact, double t, double height, double spacing,
                 Curve& curve) {
    const auto layers = static_cast<std::size_t>(std::lround(height / spacing));
    std::vector<double> sum(layers), y(layers), n(layers);
    for (std::size_t i = 0; i < p.count; ++i) {
        const double at = static_cast<double>(p.y[i]);
        const auto layer =
            std::min(layers - 1, static_cast<std::size_t>(std::max(at, 0.0) / height * static_cast<double>(layers)));
        sum[layer] += static_cast<double>(p.vx[i]);
        y[layer] += at;
        n[layer] += 1;
    }
    for (std::size_t k = 0; k < layers; ++k) {
        if (n[k] > 0) {
            curve.rows.push_back({y[k] / n[k], std::abs(sum[k] / n[k]), std::abs(exact(y[k] / n[k], t))});
        }
    }
}

// peak: largest speed of the steady flow, m/s
Result run_start_up(const Scene& scene, const Profile& exact, double peak) {
    fluid::FluidWorld world(scene);
    Result result;
    Cost cost;
    double now = 0;
    double worst = 0;
    double worst_of_peak = 0;
    ProfileError error;
    for (const double t : couette_times) {
        advance(world, t - now, cost);
        now = t;
        error = profile_error(world.particles(), exact, t, peak);
        worst = std::max(worst, error.relative);
        worst_of_peak = std::max(worst_of_peak, error.of_peak);
        const std::string place = "at_" + std::to_string(std::lround(1e4 * t)) + "e-4_s";
        result.metrics.push_back({"profile_l2_" + place, error.relative, "1"});
        Curve curve{"profile_" + place, {"y_m", "speed_m_s", "exact_speed_m_s"}, {}};
        add_profile(world.particles(), exact, t, scene.channel->height, scene.fluid->particle_spacing, curve);
        result.curves.push_back(curve);
    }
    result.metrics.insert(result.metrics.begin(), {{"profile_l2", worst, "1"},
                                                   {"profile_l2_of_peak", worst_of_peak, "1"},
                                                   {"steady_amplitude_error", std::abs(error.amplitude - 1), "1"}});
    note_solver(cost, world, result);
    note_cost(cost, world, result);
    return result;
}

Result run_poiseuille(const Request& request) {
    const Scene scene = scene_for(request, "validation/poiseuille.json", slice_overrides(request, true));
    // The slope tilts gravity; the stream runs along -x.
    const double drive = scene.world->gravity * std::sin(std::atan(scene.channel->slope));
    const double nu = scene.fluid->kinematic_viscosity;
    const double height = scene.channel->height;
    return run_start_up(
        scene, [=](double y, double t) { return -poiseuille_velocity(y, t, drive, nu, height); },
        drive * height * height / (8 * nu));
}

Result run_couette(const Request& request) {
    const Scene scene = scene_for(request, "validation/couette.json", slice_overrides(request, true));
    double speed = 0;
    for (const NoSlip& plane : scene.channel->no_slip) {
        speed = plane.plane == Plane::top ? plane.velocity[0] : speed;
    }
    const double nu = scene.fluid->kinematic_viscosity;
    const double height = scene.channel->height;
    return run_start_up(
        scene, [=](double y, double t) { return couette_velocity(y, t, speed, nu, height); }, std::abs(speed));
}

Case start_up_case(const std::string& name, const std::string& flow, Result (*run)(const Request&)) {
    Case c;
    c.name = name;
    c.truth =
        "Fourier series of the start-up of plane " + flow +
        " flow at the times and the Reynolds number, 0.0125, of Morris, Fox and Zhu (1997). The error of a "
        "profile is the RMS over all particles, relative to the RMS of the exact velocities at their heights; the "
        "worst of five times counts.";
    c.reference = "Fourier series";
    c.spacings = {0.1, 0.05, 0.025};
    c.quick = true;
    c.quick_level = 1;  // 20 spacings between the planes, where the limit is stated
    c.run = run;
    return c;
}

// Vortices that decay by viscosity alone: does the solver add or take energy where particles shear past one another?

constexpr double vortex_side = 1;   // m, of the periodic square
constexpr double vortex_speed = 1;  // m/s, largest at t = 0
constexpr double wave_number = 2 * std::numbers::pi / vortex_side;

std::array<double, 3> mode(const std::array<double, 3>& x) {
    return {-std::cos(wave_number * x[0]) * std::sin(wave_number * x[1]),
            std::sin(wave_number * x[0]) * std::cos(wave_number * x[1]), 0};
}

// Slope of the least-squares line through (t, ln v).
double rate_of(const std::vector<std::vector<double>>& rows, std::size_t column) {
    double t = 0, v = 0, tt = 0, tv = 0;
    const auto n = static_cast<double>(rows.size());
    for (const auto& row : rows) {
        const double log = std::log(row[column]);
        t += row[0], v += log, tt += row[0] * row[0], tv += row[0] * log;
    }
    return (n * tv - t * v) / (n * tt - t * t);
}

Result run_taylor_green(const Request& request) {
    const Scene scene = scene_for(request, "validation/taylor_green.json", slice_overrides(request, false));
    fluid::FluidWorld world(scene);
    world.set_velocity([](const std::array<double, 3>& x) {
        const std::array<double, 3> e = mode(x);
        return std::array<double, 3>{vortex_speed * e[0], vortex_speed * e[1], vortex_speed * e[2]};
    });

    Result result;
    Cost cost;
    Curve decay{"decay", {"time_s", "speed_from_energy_m_s", "speed_of_mode_m_s", "exact_speed_m_s"}, {}};
    Curve error{"speed_error", {"time_s", "mean_error_over_mean_speed"}, {}};
    double l1 = 0;
    const int frames = frames_in(scene, scene.duration);
    for (int frame = 0; frame <= frames; ++frame) {
        if (frame > 0) {
            advance_frame(world, cost);
        }
        const double time = frame / scene.frame_rate;
        const double exact = vortex_speed * taylor_green_decay(time, scene.fluid->kinematic_viscosity, vortex_side);
        const fluid::Particles& p = world.particles();
        double off = 0, all = 0, along = 0, squares = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            const std::array<double, 3> v{p.vx[i], p.vy[i], p.vz[i]};
            const std::array<double, 3> e = mode({p.x[i], p.y[i], p.z[i]});
            const double size = std::hypot(e[0], e[1]);
            off += std::abs(std::hypot(v[0], v[1], v[2]) - exact * size);
            all += exact * size;
            along += v[0] * e[0] + v[1] * e[1];
            squares += size * size;
        }
        // The mean of |v|^2 over the square is U^2 / 2.
        decay.rows.push_back({time, 2 * std::sqrt(specific_kinetic_energy(p)), along / squares, exact});
        error.rows.push_back({time, off / all});
        l1 += frame > 0 ? off / all / frames : 0;
    }
    const double truth = -2 * scene.fluid->kinematic_viscosity * wave_number * wave_number;
    const double rate = rate_of(decay.rows, 1), rate_of_mode = rate_of(decay.rows, 2);  // 1/s
    result.metrics.push_back({"decay_rate_error", std::abs(rate / truth - 1), "1"});
    result.metrics.push_back({"mode_decay_rate_error", std::abs(rate_of_mode / truth - 1), "1"});
    // Beyond that of the viscosity, in units of U / L; U L / nu of the viscosity that would take as much is 8 pi^2 over it.
    result.metrics.push_back({"numerical_decay_rate", (truth - rate) * vortex_side / vortex_speed, "1"});
    result.metrics.push_back({"speed_l1", l1, "1"});
    result.metrics.push_back({"speed_l1_at_end", error.rows.back()[1], "1"});
    note_solver(cost, world, result);
    note_cost(cost, world, result);
    result.curves = {decay, error};
    return result;
}

// Lid-driven cavity: a steady vortex in a closed box that is full, after many turns of the water.

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
Result run_cavity(const Request& request) {
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
    const double reach = 2 * scene.fluid->particle_spacing;
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

Case poiseuille_case() {
    return start_up_case("poiseuille", "Poiseuille", run_poiseuille);
}

Case couette_case() {
    return start_up_case("couette", "Couette", run_couette);
}

Case taylor_green_case() {
    Case c;
    c.name = "taylor_green";
    c.truth =
        "Vortices in a periodic square decay as exp(-8 pi^2 nu t / L^2) (Taylor and Green 1937, in the plane), Re 100, "
        "until a fifth of the speed is left. Rates are fitted to ln U, U once from the kinetic energy, once from the "
        "projection on the exact mode; L1 of the speed is the mean over the frames.";
    c.reference = "exact decay";
    c.spacings = {1.0 / 32, 1.0 / 64, 1.0 / 128};
    c.quick = true;
    c.run = run_taylor_green;
    return c;
}

Case cavity_100_case() {
    return make_case(0, run_cavity<0>, 2);
}

Case cavity_400_case() {
    return make_case(1, run_cavity<1>, 2);
}

Case cavity_1000_case() {
    return make_case(2, run_cavity<2>, 2);
}

}  // namespace wade::validation
