#include "fluid_server/dfsph/step_measures.hpp"

#include <string>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/dfsph/stabler_settings.hpp"
#include "fluid_server/dfsph/time_step.hpp"

namespace wade::fluid {

namespace {

// A mean compression beyond this is no water any more.
constexpr double collapse = 0.1;

// `what` happened and what to change in the scene.
[[noreturn]] void fail(const std::string& what, const Fluid& fluid) {
    throw RunError(ExitCode::numerical_failure, what + "; " + advice(fluid));
}

// " at (x, y, z) m"
std::string place_of_fastest(const Particles& p) {
    const auto square = [&](std::size_t i) { return p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]; };
    std::size_t fastest = 0;
    for (std::size_t i = 1; i < p.count; ++i) fastest = square(i) > square(fastest) ? i : fastest;
    const auto text = [](float v) { return short_number(static_cast<double>(v)); };
    return " at (" + text(p.x[fastest]) + ", " + text(p.y[fastest]) + ", " + text(p.z[fastest]) + ") m";
}

}  // namespace

void check_speed(const Particles& particles, double fastest, double expected, const Fluid& fluid) {
    if (expected <= 0 || !(fastest > runaway * expected)) return;
    fail("a fluid particle" + place_of_fastest(particles) + " moves at " + short_number(fastest) + " m/s, more than " +
             std::to_string(runaway) + " times the " + short_number(expected) +
             " m/s of the scene's depth and velocity",
         fluid);
}

void check_compression(double mean_error, const Fluid& fluid) {
    if (!(mean_error > collapse)) return;
    fail("the fluid is compressed by " + short_number(100 * mean_error) + " % on average, more than " +
             short_number(100 * collapse) + " %",
         fluid);
}

void check_moves(std::uint64_t not_finite, double longest, double support_radius, const Fluid& fluid) {
    if (not_finite > 0) {
        fail(std::to_string(not_finite) + " fluid particles have a velocity or position that is not finite", fluid);
    }
    if (longest > support_radius) {
        fail("a fluid particle moves by " + short_number(longest) +
                 " m in one step, further than the support radius of " + short_number(support_radius) + " m",
             fluid);
    }
}

}  // namespace wade::fluid
