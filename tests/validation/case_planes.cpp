// Start-up of Poiseuille and of Couette flow between planes to which the water sticks: viscosity and no-slip boundaries.

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "cases.hpp"
#include "run.hpp"
#include "viscous_exact.hpp"
#include "viscous_measures.hpp"

namespace wade::validation {

namespace {

// s; the profiles that Morris et al. (1997) show, the last is steady.
constexpr std::array times{0.0225, 0.045, 0.1125, 0.225, 1.0};

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
    for (const double t : times) {
        advance(world, t - now, cost);
        now = t;
        error = profile_error(world.particles(), exact, t, peak);
        worst = std::max(worst, error.relative);
        worst_of_peak = std::max(worst_of_peak, error.of_peak);
        const std::string place = "at_" + std::to_string(std::lround(1e4 * t)) + "e-4_s";
        result.metrics.push_back({"profile_l2_" + place, error.relative, "1"});
        Curve curve{"profile_" + place, {"y_m", "speed_m_s", "exact_speed_m_s"}, {}};
        add_profile(world.particles(), exact, t, scene.channel.height, scene.fluid.particle_spacing, curve);
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
    const double drive = scene.world.gravity * std::sin(std::atan(scene.channel.slope));
    const double nu = scene.fluid.kinematic_viscosity;
    const double height = scene.channel.height;
    return run_start_up(
        scene, [=](double y, double t) { return -poiseuille_velocity(y, t, drive, nu, height); },
        drive * height * height / (8 * nu));
}

Result run_couette(const Request& request) {
    const Scene scene = scene_for(request, "validation/couette.json", slice_overrides(request, true));
    double speed = 0;
    for (const NoSlip& plane : scene.channel.no_slip) {
        speed = plane.plane == Plane::top ? plane.velocity[0] : speed;
    }
    const double nu = scene.fluid.kinematic_viscosity;
    const double height = scene.channel.height;
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

}  // namespace

Case poiseuille_case() {
    return start_up_case("poiseuille", "Poiseuille", run_poiseuille);
}

Case couette_case() {
    return start_up_case("couette", "Couette", run_couette);
}

}  // namespace wade::validation
