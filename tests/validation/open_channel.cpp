#include "open_channel.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace wade::validation {

namespace {

// Root of f in [lo, hi], where it changes sign, by bisection to the last bit but a few.
template <typename Function>
double root(double lo, double hi, Function&& f) {
    const bool rising = f(hi) > 0;
    for (int i = 0; i < 200 && hi - lo > 1e-15 * std::abs(hi); ++i) {
        const double middle = 0.5 * (lo + hi);
        ((f(middle) > 0) == rising ? hi : lo) = middle;
    }
    return 0.5 * (lo + hi);
}

}  // namespace

double critical_depth(double q, double g) {
    return std::cbrt(q * q / g);
}

double specific_energy(double q, double h, double g) {
    return h + q * q / (2 * g * h * h);
}

double momentum_function(double q, double h, double g) {
    return 0.5 * h * h + q * q / (g * h);
}

double subcritical_depth(double q, double energy, double g) {
    const double critical = critical_depth(q, g);
    if (energy <= 1.5 * critical) {
        return critical;
    }
    return root(critical, energy, [&](double h) { return specific_energy(q, h, g) - energy; });
}

double supercritical_depth(double q, double energy, double g) {
    const double critical = critical_depth(q, g);
    if (energy <= 1.5 * critical) {
        return critical;
    }
    // The velocity head alone is below E: h > q / sqrt(2 g E).
    return root(q / std::sqrt(2 * g * energy), critical, [&](double h) { return specific_energy(q, h, g) - energy; });
}

double belanger_ratio(double froude) {
    return 0.5 * (std::sqrt(1 + 8 * froude * froude) - 1);
}

double bump_height(double s) {
    return std::max(0.0, bump_top - 0.05 * (s - bump_crest) * (s - bump_crest));
}

double BumpFlow::depth(double s) const {
    const double z = bump_height(s);
    switch (kind) {
        case Kind::subcritical:
            return subcritical_depth(q, energy_upstream - z, g);
        case Kind::with_jump:
            if (s >= jump) {
                return subcritical_depth(q, energy_downstream - z, g);
            }
            [[fallthrough]];
        case Kind::transcritical:
            return s < bump_crest ? subcritical_depth(q, energy_upstream - z, g)
                                  : supercritical_depth(q, energy_upstream - z, g);
    }
    return 0;
}

BumpFlow subcritical_bump_flow(double q, double depth_downstream, double g) {
    BumpFlow flow{BumpFlow::Kind::subcritical, q, g};
    flow.energy_upstream = flow.energy_downstream = specific_energy(q, depth_downstream, g);
    if (depth_downstream < critical_depth(q, g) || flow.energy_upstream < bump_top + 1.5 * critical_depth(q, g)) {
        throw std::invalid_argument("no subcritical flow over the bump has this discharge and depth");
    }
    return flow;
}

BumpFlow transcritical_bump_flow(double q, double g) {
    BumpFlow flow{BumpFlow::Kind::transcritical, q, g};
    flow.energy_upstream = flow.energy_downstream = bump_top + 1.5 * critical_depth(q, g);
    return flow;
}

BumpFlow bump_flow_with_jump(double q, double depth_downstream, double g) {
    BumpFlow flow = transcritical_bump_flow(q, g);
    flow.kind = BumpFlow::Kind::with_jump;
    flow.energy_downstream = specific_energy(q, depth_downstream, g);
    // Positive where the stream from upstream is the stronger one and drives the jump on.
    const auto surplus = [&](double s) {
        const double z = bump_height(s);
        return momentum_function(q, supercritical_depth(q, flow.energy_upstream - z, g), g) -
               momentum_function(q, subcritical_depth(q, flow.energy_downstream - z, g), g);
    };
    const double end = bump_crest + bump_half_length;
    if (surplus(bump_crest) < 0 || surplus(end) > 0) {
        throw std::invalid_argument("this depth downstream holds no jump on the bump");
    }
    flow.jump = root(bump_crest, end, surplus);
    return flow;
}

namespace {

struct March {
    bool too_much_energy = false;  // the flow stays subcritical; else it thins without end
    std::vector<double> depths;
};

// Integrates h'' from the start of the bump to some metres behind it, by a fourth-order Runge-Kutta method. Stops once
// the solution has clearly left the transcritical flow to one side.
March march(double q, double g, double energy) {
    constexpr double dz = 0.1;  // z'' = -dz on the bump
    constexpr double kink = 2 * dz * bump_half_length / 2;
    constexpr double ds = CurvedBumpFlow::step;
    const double critical = critical_depth(q, g);
    const double thinnest = 0.5 * supercritical_depth(q, energy, g);
    const auto steps_on_bump = std::lround(2 * bump_half_length / ds);
    double h = subcritical_depth(q, energy, g);
    double slope = -1.5 * kink;
    March result;
    result.depths.push_back(h);
    for (long i = 0; i < 2 * steps_on_bump; ++i) {
        const bool on_bump = i < steps_on_bump;
        if (i == steps_on_bump) {
            slope -= 1.5 * kink;
        }
        const double s = bump_crest - bump_half_length + static_cast<double>(i) * ds;
        const auto second = [&](double at, double depth, double dh) {
            const double z1 = on_bump ? -dz * (at - bump_crest) : 0;
            const double z2 = on_bump ? -dz : 0;
            const double z = on_bump ? bump_top - 0.5 * dz * (at - bump_crest) * (at - bump_crest) : 0;
            const double factor = (energy - z - depth) * 2 * g * depth * depth / (q * q);
            return (3 * (factor - 1 - depth * z2 - z1 * z1) + dh * dh) / (2 * depth);
        };
        const double k1 = slope, m1 = second(s, h, slope);
        const double k2 = slope + 0.5 * ds * m1, m2 = second(s + 0.5 * ds, h + 0.5 * ds * k1, k2);
        const double k3 = slope + 0.5 * ds * m2, m3 = second(s + 0.5 * ds, h + 0.5 * ds * k2, k3);
        const double k4 = slope + ds * m3, m4 = second(s + ds, h + ds * k3, k4);
        h += ds / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        slope += ds / 6 * (m1 + 2 * m2 + 2 * m3 + m4);
        result.depths.push_back(h);
        if (h < thinnest) {
            return result;
        }
        if (s > bump_crest && slope > 0 && h > critical) {
            result.too_much_energy = true;
            return result;
        }
    }
    return result;
}

}  // namespace

double CurvedBumpFlow::depth(double s) const {
    const double place = (s - (bump_crest - bump_half_length)) / step;
    if (place <= 0) {
        return subcritical_depth(q, energy, g);
    }
    const auto below = static_cast<std::size_t>(place);
    if (below + 1 >= depths.size()) {
        return supercritical_depth(q, energy, g);
    }
    return depths[below] + (place - static_cast<double>(below)) * (depths[below + 1] - depths[below]);
}

CurvedBumpFlow curved_transcritical_bump_flow(double q, double g) {
    const double hydrostatic = transcritical_bump_flow(q, g).energy_upstream;
    CurvedBumpFlow flow{q, g, 0, {}};
    // Curvature over a crest lets more through: the head is lower, by some percent.
    flow.energy = root(0.9 * hydrostatic, 1.1 * hydrostatic,
                       [&](double energy) { return march(q, g, energy).too_much_energy ? 1.0 : -1.0; });
    flow.depths = march(q, g, flow.energy).depths;
    // What rounding leaves of the solutions that run away grows in the end: from the point nearest to it on, the flow
    // is the uniform one.
    const double uniform = supercritical_depth(q, flow.energy, g);
    const auto bump_end = flow.depths.begin() + std::lround(2 * bump_half_length / CurvedBumpFlow::step);
    const auto nearest =
        std::min_element(std::min(bump_end, flow.depths.end()), flow.depths.end(),
                         [&](double a, double b) { return std::abs(a - uniform) < std::abs(b - uniform); });
    flow.depths.erase(nearest, flow.depths.end());
    return flow;
}

double mean_surface(const BumpFlow& flow, double from, double to) {
    constexpr int steps = 10000;  // midpoint rule; the profile is smooth but for a jump
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double s = from + (i + 0.5) * (to - from) / steps;
        sum += flow.depth(s) + bump_height(s);
    }
    return sum / steps;
}

}  // namespace wade::validation
