#include "viscous_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "configs/scene/fluid.hpp"
#include "slice.hpp"

namespace wade::validation {

double slice_thickness(const Request& request) {
    return slice_width(request, KernelKind::wendland_c2);
}

std::vector<std::string> slice_overrides(const Request& request, bool along_x) {
    std::vector<std::string> sizes{assign("/channel/z_max_m", slice_thickness(request))};
    if (along_x) {
        sizes.push_back(assign("/channel/x_max_m", slice_thickness(request)));
    }
    return sizes;
}

double specific_kinetic_energy(const fluid::Particles& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        sum += static_cast<double>(p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i]);
    }
    return p.count == 0 ? 0 : 0.5 * sum / static_cast<double>(p.count);
}

DensityError density_error(const fluid::FluidWorld& world) {
    DensityError result;
    const std::size_t n = world.particles().count;
    for (std::size_t i = 0; i < n; ++i) {
        const double error = static_cast<double>(world.fields().density[i]) - 1;
        result.compression += std::max(error, 0.0) / static_cast<double>(n);
        result.magnitude += std::abs(error) / static_cast<double>(n);
        result.largest = std::max(result.largest, error);
    }
    return result;
}

void note_solver(const Cost& cost, const fluid::FluidWorld& world, Result& result) {
    const auto steps = static_cast<double>(std::max<std::size_t>(cost.steps, 1));
    result.metrics.push_back({"density_iterations", cost.density_iterations / steps, "1"});
    result.metrics.push_back({"divergence_iterations", cost.divergence_iterations / steps, "1"});
    result.metrics.push_back({"mean_compression_at_end", density_error(world).compression, "1"});
    result.metrics.push_back({"max_compression", cost.max_density_error, "1"});
}

PointSamples::PointSamples(std::vector<std::array<double, 2>> points, std::size_t component, double reach)
    : points_(std::move(points)), sums_(points_.size()), component_(component), reach_(reach) {}

void PointSamples::add(const fluid::Particles& p) {
    const std::vector<float>& u = component_ == 0 ? p.vx : p.vy;
    for (std::size_t i = 0; i < p.count; ++i) {
        for (std::size_t k = 0; k < points_.size(); ++k) {
            // In units of the reach, so that the equations below are well scaled.
            const double dx = (static_cast<double>(p.x[i]) - points_[k][0]) / reach_;
            const double dy = (static_cast<double>(p.y[i]) - points_[k][1]) / reach_;
            const double q2 = dx * dx + dy * dy;
            if (q2 >= 1) continue;
            const double w = (1 - q2) * (1 - q2);
            const double wu = w * static_cast<double>(u[i]);
            const Sums terms{w, w * dx, w * dy, w * dx * dx, w * dx * dy, w * dy * dy, wu, wu * dx, wu * dy};
            for (std::size_t s = 0; s < terms.size(); ++s) {
                sums_[k][s] += terms[s];
            }
        }
    }
}

double PointSamples::velocity(std::size_t k) const {
    // u = a + b dx + c dy: a by Cramer's rule.
    const auto& [w, x, y, xx, xy, yy, u, ux, uy] = sums_[k];
    const double minor_w = xx * yy - xy * xy;
    const double minor_x = x * yy - xy * y;
    const double minor_y = x * xy - xx * y;
    const double determinant = w * minor_w - x * minor_x + y * minor_y;
    if (determinant <= 1e-9 * w * w * w) return std::numeric_limits<double>::quiet_NaN();
    return (u * minor_w - ux * minor_x + uy * minor_y) / determinant;
}

}  // namespace wade::validation
