#include "profiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/scene/interval.hpp"

namespace wade::validation {

Columns make_columns(const Interval& x, double width, double column) {
    const auto count = static_cast<std::size_t>(std::max(1L, std::lround(x.length() / column)));
    Columns columns;
    columns.x = x;
    columns.width = width;
    columns.volume.assign(count, 0);
    columns.momentum.assign(count, 0);
    return columns;
}

void sample(const fluid::Particles& particles, double spacing, Columns& columns) {
    const double area = spacing * spacing;
    const double length = columns.length();
    const auto last = static_cast<double>(columns.count());
    for (std::size_t i = 0; i < particles.count; ++i) {
        if (particles.kind[i] != fluid::Kind::fluid) {
            continue;
        }
        // The particle's cube in units of a column.
        const double place = (static_cast<double>(particles.x[i]) - columns.x.lo) / length;
        const double from = std::max(place - spacing / (2 * length), 0.0);
        const double to = std::min(place + spacing / (2 * length), last);
        for (double k = std::floor(from); k < to; ++k) {
            const double volume = area * length * (std::min(to, k + 1) - std::max(from, k));
            columns.volume[static_cast<std::size_t>(k)] += volume;
            columns.momentum[static_cast<std::size_t>(k)] += volume * static_cast<double>(particles.vx[i]);
        }
    }
    columns.samples += 1;
}

double leading_x(const fluid::Particles& particles, double none) {
    double leading = none;
    for (std::size_t i = 0; i < particles.count; ++i) {
        if (particles.kind[i] == fluid::Kind::fluid) {
            leading = std::min(leading, static_cast<double>(particles.x[i]));
        }
    }
    return leading;
}

double quantile(std::vector<double> values, double p) {
    if (values.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::sort(values.begin(), values.end());
    const double place = p * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace wade::validation
