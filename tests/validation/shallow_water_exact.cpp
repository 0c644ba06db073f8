#include "shallow_water_exact.hpp"

#include <cmath>

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

}  // namespace wade::validation
