// Vortices that decay by viscosity alone: does the solver add or take energy where particles shear past one another?

#include <array>
#include <cmath>
#include <numbers>

#include "cases.hpp"
#include "run.hpp"
#include "viscous_exact.hpp"
#include "viscous_measures.hpp"

namespace wade::validation {

namespace {

constexpr double length = 1;  // m, of the periodic square
constexpr double speed = 1;   // m/s, largest at t = 0
constexpr double k = 2 * std::numbers::pi / length;

std::array<double, 3> mode(const std::array<double, 3>& x) {
    return {-std::cos(k * x[0]) * std::sin(k * x[1]), std::sin(k * x[0]) * std::cos(k * x[1]), 0};
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

Result run(const Request& request) {
    const Scene scene = scene_for(request, "validation/taylor_green.json", slice_overrides(request, false));
    fluid::FluidWorld world(scene);
    world.set_velocity([](const std::array<double, 3>& x) {
        const std::array<double, 3> e = mode(x);
        return std::array<double, 3>{speed * e[0], speed * e[1], speed * e[2]};
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
        const double exact = speed * taylor_green_decay(time, scene.fluid.kinematic_viscosity, length);
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
    const double truth = -2 * scene.fluid.kinematic_viscosity * k * k;
    const double rate = rate_of(decay.rows, 1), rate_of_mode = rate_of(decay.rows, 2);  // 1/s
    result.metrics.push_back({"decay_rate_error", std::abs(rate / truth - 1), "1"});
    result.metrics.push_back({"mode_decay_rate_error", std::abs(rate_of_mode / truth - 1), "1"});
    // Beyond that of the viscosity, in units of U / L; U L / nu of the viscosity that would take as much is 8 pi^2 over it.
    result.metrics.push_back({"numerical_decay_rate", (truth - rate) * length / speed, "1"});
    result.metrics.push_back({"speed_l1", l1, "1"});
    result.metrics.push_back({"speed_l1_at_end", error.rows.back()[1], "1"});
    note_solver(cost, world, result);
    note_cost(cost, world, result);
    result.curves = {decay, error};
    return result;
}

}  // namespace

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
    c.run = run;
    return c;
}

}  // namespace wade::validation
