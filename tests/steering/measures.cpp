#include "tests/steering/measures.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"

namespace wade::steering_map {

namespace {

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

double run_for(SteeringWorld& world, double time, const std::function<void(double)>& on_frame) {
    const double frame = 1 / world.scene().frame_rate;
    const auto frames = static_cast<int>(std::lround(time / frame));
    double cpu = 0;
    for (int f = 0; f < frames; ++f) {
        const double start = cpu_seconds();
        double remaining = frame;
        while (remaining > 1e-9 * frame) remaining -= world.step(remaining).dt;
        cpu += cpu_seconds() - start;
        if (on_frame) on_frame(world.time());
    }
    return cpu;
}

Packing measure_packing(const SteeringWorld& world) {
    const fluid::Particles& p = world.particles();
    const Channel& channel = world.scene().channel;
    const double d = world.settings().spacing;
    Packing result;
    double height = 0;
    std::vector<double> heights(p.count);
    for (std::size_t i = 0; i < p.count; ++i) {
        heights[i] = static_cast<double>(p.y[i]);
        height += heights[i];
    }
    const auto n = static_cast<double>(p.count);
    result.depth = 2 * height / n;

    double nearest_sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < p.count; ++j) {
            if (i == j) continue;
            const double dx = static_cast<double>(p.x[i] - p.x[j]), dy = static_cast<double>(p.y[i] - p.y[j]);
            const double dz = static_cast<double>(p.z[i] - p.z[j]);
            nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
        }
        nearest_sum += std::sqrt(nearest);
    }
    result.spacing = nearest_sum / n;

    const double area = channel.x.length() * channel.z.length();
    const auto between = [&](double lo, double hi) {
        const auto inside = std::count_if(heights.begin(), heights.end(),
                                          [&](double y) { return y >= lo * result.depth && y < hi * result.depth; });
        return static_cast<double>(inside) * d * d * d / (area * (hi - lo) * result.depth);
    };
    result.density = between(1.0 / 3, 2.0 / 3);
    result.bottom = between(0, 1.0 / 6);
    result.top = between(4.0 / 6, 5.0 / 6);

    // The surface of a column: the mean height of the highest particles, half a layer of it.
    const auto columns_x = static_cast<std::size_t>(std::max(1.0, std::floor(channel.x.length() / (4 * d))));
    const auto columns_z = static_cast<std::size_t>(std::max(1.0, std::floor(channel.z.length() / (4 * d))));
    std::vector<std::vector<double>> columns(columns_x * columns_z);
    for (std::size_t i = 0; i < p.count; ++i) {
        const auto at = [](float v, const Interval& range, std::size_t count) {
            const double share = (static_cast<double>(v) - range.lo) / range.length();
            return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, share * static_cast<double>(count))));
        };
        columns[at(p.z[i], channel.z, columns_z) * columns_x + at(p.x[i], channel.x, columns_x)].push_back(heights[i]);
    }
    double lowest = std::numeric_limits<double>::infinity();
    double highest = 0;
    for (std::vector<double>& column : columns) {
        std::sort(column.rbegin(), column.rend());
        double level = 0;
        const std::size_t highest_few = std::min<std::size_t>(8, column.size());
        for (std::size_t k = 0; k < highest_few; ++k) level += column[k] / static_cast<double>(highest_few);
        lowest = std::min(lowest, level);
        highest = std::max(highest, level);
    }
    result.unevenness = highest - lowest;
    return result;
}

void Profile::add(const SteeringWorld& world) {
    const fluid::Particles& p = world.particles();
    const double height = world.scene().channel->height;
    const auto bins = static_cast<double>(velocity.size());
    for (std::size_t i = 0; i < p.count; ++i) {
        const double share = static_cast<double>(p.y[i]) / height;
        const auto k = static_cast<std::size_t>(std::clamp(share * bins, 0.0, bins - 1));
        velocity[k] -= static_cast<double>(p.vx[i]);
        count[k] += 1;
    }
}

Parabola fit_parabola(const Profile& profile, double height) {
    // Normal equations of (slip, curvature).
    const auto bins = static_cast<double>(profile.velocity.size());
    double n = 0, q = 0, qq = 0, u = 0, uq = 0;
    const auto shape = [&](std::size_t k) {
        const double y = (static_cast<double>(k) + 0.5) / bins * height;
        return y * (height - y);
    };
    for (std::size_t k = 0; k < profile.velocity.size(); ++k) {
        n += 1, q += shape(k), qq += shape(k) * shape(k), u += profile.mean(k), uq += profile.mean(k) * shape(k);
    }
    Parabola fit;
    fit.curvature = (n * uq - q * u) / (n * qq - q * q);
    fit.slip = (u - fit.curvature * q) / n;
    double squares = 0, lowest = 1e300, highest = -1e300;
    for (std::size_t k = 0; k < profile.velocity.size(); ++k) {
        squares += std::pow(profile.mean(k) - fit.slip - fit.curvature * shape(k), 2);
        lowest = std::min(lowest, profile.mean(k)), highest = std::max(highest, profile.mean(k));
    }
    fit.residual = std::sqrt(squares / n) / std::max(highest - lowest, 1e-300);
    return fit;
}

Bingham fit_bingham(const Profile& profile, double height, double drive) {
    const std::size_t bins = profile.velocity.size();
    const double step = height / static_cast<double>(bins);
    std::vector<double> rates, stresses;
    double steepest = 0;
    for (std::size_t k = 0; k + 1 < bins; ++k) {
        const double from_middle = 0.5 * height - (static_cast<double>(k) + 1) * step;
        // Positive where the velocity falls towards the planes.
        rates.push_back((profile.mean(k + 1) - profile.mean(k)) / step * (from_middle < 0 ? -1 : 1));
        stresses.push_back(drive * std::abs(from_middle));
        steepest = std::max(steepest, rates.back());
    }
    double n = 0, r = 0, rr = 0, s = 0, rs = 0;
    for (std::size_t k = 0; k < rates.size(); ++k) {
        if (rates[k] < 0.05 * steepest) continue;
        n += 1, r += rates[k], rr += rates[k] * rates[k], s += stresses[k], rs += rates[k] * stresses[k];
    }
    Bingham fit;
    fit.viscosity = (n * rs - r * s) / (n * rr - r * r);
    fit.yield = (s - fit.viscosity * r) / n;
    fit.sheared = n / static_cast<double>(rates.size());
    return fit;
}

}  // namespace wade::steering_map
