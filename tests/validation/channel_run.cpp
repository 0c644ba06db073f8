#include "channel_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "slice.hpp"

namespace wade::validation {

std::vector<std::string> channel_slice(const Request& request) {
    const double width = slice_width(request);
    return {assign("/channel/z_min_m", 0), assign("/channel/z_max_m", width), assign("/world/width_m", width)};
}

Columns average_columns(Water& water, double from, double to, double column, Cost& cost) {
    const Scene& scene = water.scene();
    Columns columns = make_columns(scene.channel->x, scene.channel->z.length(), column);
    const int last = frames_in(scene, to);
    for (int frame = 1; frame <= last; ++frame) {
        water.advance(cost);
        if (frame > frames_in(scene, from)) {
            water.add_to(columns);
        }
    }
    return columns;
}

double discharge(const Columns& columns, std::size_t k) {
    return -columns.depth(k) * columns.velocity(k);
}

double mean_over(const Columns& columns, const Interval& x, const std::function<double(std::size_t)>& value) {
    double sum = 0;
    double count = 0;
    for (std::size_t k = 0; k < columns.count(); ++k) {
        if (x.contains(columns.centre(k))) {
            sum += value(k);
            count += 1;
        }
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

double mean_depth(const Columns& columns, const Interval& x) {
    return mean_over(columns, x, [&](std::size_t k) { return columns.depth(k); });
}

double mean_discharge(const Columns& columns, const Interval& x) {
    return mean_over(columns, x, [&](std::size_t k) { return discharge(columns, k); });
}

double depth_error(const Columns& columns, const Interval& x, const std::function<double(double)>& exact_depth) {
    const auto squared = [](double v) { return v * v; };
    const double errors = mean_over(
        columns, x, [&](std::size_t k) { return squared(columns.depth(k) - exact_depth(columns.centre(k))); });
    return std::sqrt(errors /
                     mean_over(columns, x, [&](std::size_t k) { return squared(exact_depth(columns.centre(k))); }));
}

double discharge_variation(const Columns& columns, const Interval& x) {
    const double mean = mean_discharge(columns, x);
    double worst = 0;
    mean_over(columns, x, [&](std::size_t k) {
        worst = std::max(worst, std::abs(discharge(columns, k) / mean - 1));
        return 0.0;
    });
    return worst;
}

}  // namespace wade::validation
