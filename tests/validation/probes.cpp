#include "probes.hpp"

#include <algorithm>
#include <cmath>

#include "fluid_server/neighbours/kernel.hpp"

namespace wade::validation {

double wall_pressure(const fluid::Particles& p, const std::array<double, 3>& point, double spacing,
                     double rest_density) {
    const auto reach = static_cast<float>(2 * spacing);
    const auto px = static_cast<float>(point[0]);
    const auto py = static_cast<float>(point[1]);
    const auto pz = static_cast<float>(point[2]);
    const fluid::CubicSpline kernel(reach);
    double sum = 0;
    double weights = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const float dx = p.x[i] - px;
        if (std::abs(dx) >= reach) {
            continue;
        }
        const float dy = p.y[i] - py;
        const float dz = p.z[i] - pz;
        const auto weight = static_cast<double>(kernel.value(std::sqrt(dx * dx + dy * dy + dz * dz)));
        weights += weight;
        sum += weight * static_cast<double>(p.pressure[i]);
    }
    const double volume = spacing * spacing * spacing;
    return rest_density * volume * sum / std::max(volume * weights, 0.25);
}

double wet_length(const fluid::Particles& p, double x, double z, double spacing) {
    const double reach = 2 * spacing;
    double sum = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const double along = 1 - std::abs(static_cast<double>(p.x[i]) - x) / reach;
        const double across = 1 - std::abs(static_cast<double>(p.z[i]) - z) / reach;
        sum += std::max(along, 0.0) * std::max(across, 0.0);
    }
    return sum * spacing * spacing * spacing / (reach * reach);
}

}  // namespace wade::validation
