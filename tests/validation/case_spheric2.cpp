// SPHERIC test 2: a dam breaks and its water strikes a box on the bed of a tank.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "cases.hpp"
#include "configs/scene/fluid.hpp"
#include "probes.hpp"
#include "run.hpp"
#include "spheric2_reference.hpp"

namespace wade::validation {

namespace {

constexpr double reservoir_depth = 0.55;  // m, of the reservoir
constexpr double end_time = 3;            // s
constexpr double sampling = 0.02;         // s, between the samples of the experiment

// Distances from the wall behind the box, m; all in the middle plane of the tank.
constexpr std::array<double, 4> gauges_x{0.496, 0.992, 1.488, 2.638};
constexpr double middle = 0.5;
// P1 and P3, on the face of the box that the water strikes.
constexpr std::array<std::array<double, 3>, 2> sensors{{{0.8245, 0.021, middle}, {0.8245, 0.101, middle}}};

struct Readings {
    std::vector<double> time;
    std::array<std::vector<double>, 4> height;
    std::array<std::vector<double>, 2> pressure;  // averages over the 20 ms round time
};

Readings run_tank(fluid::FluidWorld& world, Cost& cost) {
    const double d = world.scene().fluid->particle_spacing;
    const double rho = world.scene().fluid->rest_density;
    Readings readings;
    const auto read_heights = [&](double t) {
        readings.time.push_back(t);
        for (std::size_t k = 0; k < gauges_x.size(); ++k) {
            readings.height[k].push_back(wet_length(world.particles(), gauges_x[k], middle, d));
        }
    };
    // Two half intervals a sample: the pressure at t is the mean from t - 10 ms to t + 10 ms.
    std::array<double, 2> before{};
    read_heights(0);
    for (int half = 1; half <= 2 * static_cast<int>(std::lround(end_time / sampling)) + 1; ++half) {
        std::array<double, 2> mean{};
        advance(world, 0.5 * sampling, cost, [&](const fluid::StepReport& step) {
            for (std::size_t k = 0; k < sensors.size(); ++k) {
                mean[k] += wall_pressure(world.particles(), sensors[k], d, rho) * step.dt / (0.5 * sampling);
            }
        });
        for (std::size_t k = 0; k < sensors.size(); ++k) {
            if (half % 2 == 1) {
                readings.pressure[k].push_back(half == 1 ? mean[k] : 0.5 * (before[k] + mean[k]));
            }
        }
        before = mean;
        if (half % 2 == 0) {
            read_heights(0.5 * half * sampling);
        }
    }
    return readings;
}

// The reading at a time of the reference, which is a multiple of half an interval.
double at(const std::vector<double>& values, double time) {
    const double place = time / sampling;
    const auto below = std::min(static_cast<std::size_t>(place + 1e-6), values.size() - 1);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    const double share = std::max(0.0, place - static_cast<double>(below));
    return values[below] + share * (values[above] - values[below]);
}

double rms_difference(const std::vector<double>& values, const std::vector<double>& time,
                      const std::vector<double>& reference) {
    double sum = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
        sum += std::pow(at(values, time[i]) - reference[i], 2);
    }
    return std::sqrt(sum / static_cast<double>(time.size()));
}

// Integral of a pressure, straight between its readings, over the impact, Pa s.
constexpr std::array<double, 2> impact{0.38, 0.7};  // s: from before the water comes until it falls back
double impulse_of(const std::vector<double>& time, const std::vector<double>& pressure) {
    double sum = 0;
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double from = std::max(time[i - 1], impact[0]), to = std::min(time[i], impact[1]);
        if (from >= to) continue;
        const double middle_share = (0.5 * (from + to) - time[i - 1]) / (time[i] - time[i - 1]);
        sum += (to - from) * (pressure[i - 1] + middle_share * (pressure[i] - pressure[i - 1]));
    }
    return sum;
}

void compare(const Readings& readings, const Spheric2Reference& truth, Result& result) {
    auto& metrics = result.metrics;
    for (std::size_t k = 0; k < truth.arrival.size(); ++k) {
        const double arrival = arrival_time(readings.time, readings.height[k]);
        metrics.push_back({"arrival_h" + std::to_string(k + 1), std::abs(arrival - truth.arrival[k]), "s"});
    }
    for (std::size_t k = 0; k < gauges_x.size(); ++k) {
        const double rms = rms_difference(readings.height[k], truth.time, truth.height[k]);
        metrics.push_back({"height_rms_h" + std::to_string(k + 1), rms / reservoir_depth, "1"});
    }
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        const std::string sensor = k == 0 ? "p1" : "p3";
        const auto peak = std::max_element(readings.pressure[k].begin(), readings.pressure[k].end());
        const double peak_time = readings.time[static_cast<std::size_t>(peak - readings.pressure[k].begin())];
        metrics.push_back({"pressure_peak_" + sensor, std::abs(*peak / truth.peak[k] - 1), "1"});
        metrics.push_back({"pressure_peak_" + sensor + "_over_measured", *peak / truth.peak[k], "1"});
        if (truth.series) {
            const double impulse = impulse_of(readings.time, readings.pressure[k]);
            const double measured = impulse_of(truth.time, truth.pressure[k]);
            metrics.push_back({"pressure_impulse_" + sensor + "_over_measured", impulse / measured, "1"});
        }
        metrics.push_back({"pressure_peak_time_" + sensor, std::abs(peak_time - truth.peak_time[k]), "s"});
        const double rms = rms_difference(readings.pressure[k], truth.time, truth.pressure[k]);
        metrics.push_back({"pressure_rms_" + sensor, rms / truth.peak[k], "1"});
    }
    metrics.push_back({"reference_samples", static_cast<double>(truth.time.size()), "1"});
}

// Rows at each sample; the reference where it has one.
Curve curve_of(const std::string& name, const std::string& quantity, const Readings& readings,
               const std::vector<double>& values, const Spheric2Reference& truth, const std::vector<double>& measured) {
    Curve curve{name, {"t_s", quantity, "measured_" + quantity}, {}};
    for (std::size_t i = 0; i < readings.time.size(); ++i) {
        double reference = std::nan("");
        for (std::size_t r = 0; r < truth.time.size(); ++r) {
            reference = std::abs(truth.time[r] - readings.time[i]) < 0.26 * sampling ? measured[r] : reference;
        }
        curve.rows.push_back({readings.time[i], values[i], reference});
    }
    return curve;
}

Result run_spheric2(const Request& request) {
    const Scene scene = scene_for(request, "validation/spheric2.json");
    const Spheric2Reference truth = spheric2_reference();
    fluid::FluidWorld world(scene);
    Cost cost;
    const Readings readings = run_tank(world, cost);
    Result result;
    note_cost(cost, world, result);
    compare(readings, truth, result);
    result.metrics.push_back({"max_density_error", cost.max_density_error, "1"});
    for (std::size_t k = 0; k < gauges_x.size(); ++k) {
        const std::string name = "height_h" + std::to_string(k + 1);
        result.curves.push_back(curve_of(name, "height_m", readings, readings.height[k], truth, truth.height[k]));
    }
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        const std::string name = k == 0 ? "pressure_p1" : "pressure_p3";
        result.curves.push_back(
            curve_of(name, "pressure_pa", readings, readings.pressure[k], truth, truth.pressure[k]));
    }
    return result;
}

}  // namespace

Case spheric2_case() {
    Case c;
    c.name = "spheric2";
    c.truth =
        "Experiment: a dam break that strikes a box (Kleefsman et al., J. Comput. Phys. 206, 2005; SPHERIC test 2). "
        "reference_samples says what was compared: 13, the table in the program, every 0.25 s; 151, the published "
        "series, every 0.02 s, from the folder that WADE_SPHERIC2_DATA names.";
    c.reference = "Kleefsman 2005";
    c.spacings = {0.0282, 0.0189, 0.00878};  // 30,000, 100,000 and 1,000,000 particles
    c.long_from = 2;
    c.starts = 5;
    c.run = run_spheric2;
    return c;
}

}  // namespace wade::validation
