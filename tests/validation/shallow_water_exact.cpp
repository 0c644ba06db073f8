#include "shallow_water_exact.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wade::validation {

FlowState ritter(double s, double t, double reservoir_depth, double g) {
    const double c = std::sqrt(g * reservoir_depth);
    const double v = s / t;
    if (v <= -c) {
        return {reservoir_depth, 0};
    }
    if (v >= 2 * c) {
        return {};
    }
    return {(2 * c - v) * (2 * c - v) / (9 * g), 2 * (c + v) / 3};
}

WetDamBreak solve_wet_dam_break(double h_left, double h_right, double g) {
    // Velocity behind the wave minus velocity behind the shock, of the depth h between them: falls monotonically.
    const auto excess = [&](double h) {
        return 2 * (std::sqrt(g * h_left) - std::sqrt(g * h)) -
               (h - h_right) * std::sqrt(g / 2 * (1 / h + 1 / h_right));
    };
    double h = (h_left + h_right) / 2;
    for (int i = 0; i < 50; ++i) {
        const double step = 1e-7 * h;
        const double slope = (excess(h + step) - excess(h - step)) / (2 * step);
        const double change = excess(h) / slope;
        h -= change;
        if (std::abs(change) < 1e-14 * h_left) {
            break;
        }
    }
    WetDamBreak dam{h_left, h_right, g, h, 2 * (std::sqrt(g * h_left) - std::sqrt(g * h)), 0};
    dam.shock_speed = h * dam.u_middle / (h - h_right);  // mass balance across the shock
    return dam;
}

FlowState stoker(const WetDamBreak& dam, double s, double t) {
    const double c = std::sqrt(dam.g * dam.h_left);
    const double v = s / t;
    if (v <= -c) {
        return {dam.h_left, 0};
    }
    if (v <= dam.u_middle - std::sqrt(dam.g * dam.h_middle)) {
        return {(2 * c - v) * (2 * c - v) / (9 * dam.g), 2 * (c + v) / 3};
    }
    return v < dam.shock_speed ? FlowState{dam.h_middle, dam.u_middle} : FlowState{dam.h_right, 0};
}

namespace {

using Row = std::vector<double>;

constexpr std::size_t beyond = 2;  // cells beyond each wall
constexpr double even = 1, odd = -1;

// A row with its image beyond each wall.
Row with_images(const Row& row, double parity) {
    const std::size_t n = row.size();
    Row all(n + 2 * beyond);
    std::copy(row.begin(), row.end(), all.begin() + beyond);
    for (std::size_t k = 0; k < beyond; ++k) {
        all[beyond - 1 - k] = parity * row[k];
        all[beyond + n + k] = parity * row[n - 1 - k];
    }
    return all;
}

// df/dx of a row with its images, to fourth order.
Row slope(const Row& f, double dx) {
    Row result(f.size() - 2 * beyond);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const std::size_t k = i + beyond;
        result[i] = (8 * (f[k + 1] - f[k - 1]) - (f[k + 2] - f[k - 2])) / (12 * dx);
    }
    return result;
}

// (h at a cell's lower end)^3 / (3 dx^2), of all cells and beyond the last.
Row stiffness(const Row& depth, double dx) {
    const Row h = with_images(depth, even);
    Row result(depth.size() + 1);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const double at_face = (h[i + beyond - 1] + h[i + beyond]) / 2;
        result[i] = at_face * at_face * at_face / (3 * dx * dx);
    }
    return result;
}

// u of h u - (h^3 u_x / 3)_x = m, by Thomas's algorithm; images beyond a wall move against the water.
Row velocity_of(const Row& depth, const Row& momentum, double dx) {
    const std::size_t n = depth.size();
    const Row c = stiffness(depth, dx);
    Row upper(n), u(n);
    for (std::size_t i = 0; i < n; ++i) {
        const bool first = i == 0, last = i + 1 == n;
        const double lower = first ? 0 : -c[i];
        const double middle = depth[i] + c[i] * (first ? 2 : 1) + c[i + 1] * (last ? 2 : 1);
        const double rest = first ? middle : middle - lower * upper[i - 1];
        upper[i] = last ? 0 : -c[i + 1] / rest;
        u[i] = (momentum[i] - (first ? 0 : lower * u[i - 1])) / rest;
    }
    for (std::size_t i = n - 1; i-- > 0;) u[i] -= upper[i] * u[i + 1];
    return u;
}

struct Rates {
    Row depth, momentum;
};

Rates rates(const SerreWaves& waves) {
    const Row u = velocity_of(waves.depth, waves.momentum, waves.dx);
    const Row u_x = slope(with_images(u, odd), waves.dx);
    Row discharge(u.size()), push(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
        const double h = waves.depth[i];
        discharge[i] = h * u[i];
        push[i] = u[i] * waves.momentum[i] + waves.g * h * h / 2 - 2.0 / 3 * h * h * h * u_x[i] * u_x[i];
    }
    Rates result{slope(with_images(discharge, odd), waves.dx), slope(with_images(push, even), waves.dx)};
    for (Row* row : {&result.depth, &result.momentum})
        for (double& value : *row) value = -value;
    return result;
}

SerreWaves after(const SerreWaves& waves, const Rates& rates, double dt) {
    SerreWaves result = waves;
    for (std::size_t i = 0; i < waves.depth.size(); ++i) {
        result.depth[i] += dt * rates.depth[i];
        result.momentum[i] += dt * rates.momentum[i];
    }
    return result;
}

void step(SerreWaves& waves, double dt) {
    const Rates first = rates(waves), second = rates(after(waves, first, dt / 2));
    const Rates third = rates(after(waves, second, dt / 2)), fourth = rates(after(waves, third, dt));
    for (std::size_t i = 0; i < waves.depth.size(); ++i) {
        const auto mean = [i](const Row& a, const Row& b, const Row& c, const Row& d) {
            return (a[i] + 2 * b[i] + 2 * c[i] + d[i]) / 6;
        };
        waves.depth[i] += dt * mean(first.depth, second.depth, third.depth, fourth.depth);
        waves.momentum[i] += dt * mean(first.momentum, second.momentum, third.momentum, fourth.momentum);
    }
}

}  // namespace

SerreWaves serre_waves(double length, double dx, double g, const std::function<double(double x)>& depth,
                       const std::function<double(double x)>& velocity) {
    const auto cells = static_cast<std::size_t>(std::lround(length / dx));
    SerreWaves waves{length / static_cast<double>(cells), g, Row(cells), Row(cells)};
    Row u(cells);
    for (std::size_t i = 0; i < cells; ++i) {
        const double x = (static_cast<double>(i) + 0.5) * waves.dx;
        waves.depth[i] = depth(x);
        u[i] = velocity(x);
    }
    const Row c = stiffness(waves.depth, waves.dx), all = with_images(u, odd);
    for (std::size_t i = 0; i < cells; ++i) {
        const std::size_t k = i + beyond;
        waves.momentum[i] = waves.depth[i] * u[i] - c[i + 1] * (all[k + 1] - all[k]) + c[i] * (all[k] - all[k - 1]);
    }
    return waves;
}

std::vector<double> velocities(const SerreWaves& waves) {
    return velocity_of(waves.depth, waves.momentum, waves.dx);
}

void advance(SerreWaves& waves, double duration) {
    constexpr double courant = 0.25;
    const double deepest = *std::max_element(waves.depth.begin(), waves.depth.end());
    const double longest = courant * waves.dx / std::sqrt(waves.g * deepest);
    const double steps = std::max(1.0, std::ceil(duration / longest));
    for (double k = 0; k < steps; ++k) step(waves, duration / steps);
}

}  // namespace wade::validation
