// Martin and Moyce (1952): a column of water collapses over a dry, level bed.

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "cases.hpp"
#include "profiles.hpp"
#include "run.hpp"
#include "slice.hpp"

namespace wade::validation {

namespace {

// Phil. Trans. R. Soc. A 244, 312 (1952), square column n^2 = 2 (twice as high as wide), a = 2.25 in:
// T = t sqrt(2 g / a), Z = front / a, from the wall behind the column.
constexpr std::array<std::pair<double, double>, 18> measured{{{0.41, 1.11},
                                                              {0.84, 1.22},
                                                              {1.19, 1.44},
                                                              {1.43, 1.67},
                                                              {1.63, 1.89},
                                                              {1.83, 2.11},
                                                              {1.98, 2.33},
                                                              {2.20, 2.56},
                                                              {2.32, 2.78},
                                                              {2.51, 3.00},
                                                              {2.65, 3.22},
                                                              {2.83, 3.44},
                                                              {2.97, 3.67},
                                                              {3.11, 3.89},
                                                              {3.33, 4.11},
                                                              {4.02, 5.00},
                                                              {4.44, 6.00},
                                                              {5.09, 7.00}}};
constexpr double last_compared = 3.3;  // T; later the two series of the experiment scatter by as much as the threshold

struct Point {
    double time = 0, front = 0;  // T, Z
};

double front_at(const std::vector<Point>& points, double time) {
    if (time <= 0) {
        return points[0].front;
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (points[i].time >= time) {
            const double part = (time - points[i - 1].time) / (points[i].time - points[i - 1].time);
            return points[i - 1].front + part * (points[i].front - points[i - 1].front);
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

struct Errors {
    double rms = 0, mean = 0;  // relative to the measured front
};

// Of the simulation that starts `delay` later, T.
Errors errors_with(const std::vector<Point>& simulated, double delay) {
    Errors errors;
    int compared = 0;
    for (const auto& [time, z] : measured) {
        if (time <= last_compared) {
            const double error = front_at(simulated, time - delay) / z - 1;
            errors.rms += error * error;
            errors.mean += error;
            ++compared;
        }
    }
    return {std::sqrt(errors.rms / compared), errors.mean / compared};
}

Result run(const Request& request) {
    const Scene scene = scene_for(request, "validation/collapse.json", slice_sizes(request, 1));
    fluid::FluidWorld world(scene);
    const WaterBlock& column = scene.channel.water_blocks.at(0);
    const double a = column.x.length();
    const double unit = std::sqrt(a / (2 * scene.world.gravity));  // of T, s
    const double d = scene.fluid.particle_spacing;
    // The front is the far edge of the foremost particle, half a spacing ahead of its centre: a at t = 0.
    const auto front = [&] { return (column.x.hi - leading_x(world.particles(), column.x.hi) + d / 2) / a; };

    std::vector<Point> simulated{{0, front()}};
    Cost cost;
    const int frames = frames_in(scene, scene.duration);
    for (int f = 1; f <= frames; ++f) {
        advance_frame(world, cost);
        simulated.push_back({f / scene.frame_rate / unit, front()});
    }

    Result result;
    note_cost(cost, world, result);
    Curve curve{"front", {"T", "Z", "measured_Z"}, {}};
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    for (const Point& point : simulated) {
        curve.rows.push_back({point.time, point.front, nothing});
    }
    for (const auto& [time, z] : measured) {
        if (time <= last_compared) {
            curve.rows.push_back({time, nothing, z});
        }
    }
    const Errors errors = errors_with(simulated, 0);
    double delay = 0;
    for (double other = -0.5; other <= 0.5; other += 0.01) {
        delay = errors_with(simulated, other).rms < errors_with(simulated, delay).rms ? other : delay;
    }
    result.metrics = {
        {"front_rms", errors.rms, "1"},
        {"front_mean_lead", errors.mean, "1"},
        {"front_rms_delayed", errors_with(simulated, delay).rms, "1"},
        {"delay", delay, "T"},
        {"max_density_error", cost.max_density_error, "1"},
        {"position_clamps", static_cast<double>(world.position_clamps()), "1"},
    };
    result.curves = {curve};
    return result;
}

}  // namespace

Case collapse_case() {
    const double a = 0.05715;  // m, 2.25 in
    return {
        .name = "collapse",
        .truth =
            "Collapse of a column of water 2.25 in (a) wide and twice as high, Martin and Moyce (1952): the front Z = "
            "x/a at 14 times T = t sqrt(2 g/a) up to 3.3, RMS of the relative errors. front_mean_lead: their mean, "
            "positive if the simulated front is ahead. Friction of the bed and the time that the gate takes are not "
            "simulated.",
        .reference = "Martin and Moyce 1952",
        .spacings = {a / 10, a / 20, a / 40},
        .quick = true,
        .run = run};
}

}  // namespace wade::validation
