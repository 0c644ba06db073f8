// The recirculating river of the scenes, and one that slope and friction balance.

#include <algorithm>
#include <cmath>
#include <memory>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "run.hpp"
#include "water.hpp"

namespace wade::validation {

namespace {

struct Tiles {
    Interval x, z;
    std::size_t nx, nz;
    std::vector<double> momentum, count;  // volume times velocity and volume, m^4/s and m^3

    explicit Tiles(const Channel& channel)
        : x(channel.x),
          z(channel.z),
          nx(static_cast<std::size_t>(std::max(1L, std::lround(x.length() / 10)))),
          nz(static_cast<std::size_t>(std::max(1L, std::lround(z.length() / 3)))),
          momentum(nx * nz, 0),
          count(nx * nz, 0) {}

    void sample(const Water& water) {
        const auto along = [](double v, const Interval& span, std::size_t n) {
            const double place = (v - span.lo) / span.length() * static_cast<double>(n);
            return std::min(static_cast<std::size_t>(std::max(place, 0.0)), n - 1);
        };
        water.for_each_parcel([&](const Parcel& parcel) {
            const std::size_t tile = along(parcel.z, z, nz) * nx + along(parcel.x, x, nx);
            momentum[tile] -= parcel.volume * parcel.vx;
            count[tile] += parcel.volume;
        });
    }

    [[nodiscard]] double worst(double velocity) const {
        double worst = 0;
        for (std::size_t k = 0; k < count.size(); ++k) {
            worst = std::max(worst, std::abs(momentum[k] / count[k] / velocity - 1));
        }
        return worst;
    }
};

// Slope of the straight line through column c of the rows from `first` on.
double slope(const std::vector<std::vector<double>>& rows, std::size_t first, std::size_t c) {
    double n = 0, t = 0, v = 0, tt = 0, tv = 0;
    for (std::size_t i = first; i < rows.size(); ++i) {
        n += 1, t += rows[i][0], v += rows[i][c], tt += rows[i][0] * rows[i][0], tv += rows[i][0] * rows[i][c];
    }
    return (n * tv - t * v) / (n * tt - t * t);
}

double column_mean(const std::vector<std::vector<double>>& rows, std::size_t first, std::size_t c) {
    double sum = 0;
    for (std::size_t i = first; i < rows.size(); ++i) {
        sum += rows[i][c];
    }
    return sum / static_cast<double>(rows.size() - first);
}

// Runs the scene, a channel that is periodic along x and filled at t = 0, and compares it with the depth of the scene
// and a mean velocity. Means are over the last quarter of the run, at most over 100 s.
//
//   mass         of the water a square metre, against the depth, over its exact value
//   depth        twice the mean height of the water, over that of the scene
//   speed        mean velocity towards -x over the exact one
//   worst_speed  the frame that is farthest from it (of the whole run)
//   worst_tile   the tile of 10 m x 3 m with the mean speed farthest from it
//   depth_drift, speed_drift   change a minute of the straight line through the second half of the run, over the exact one
Result run_river(const Scene& scene, double exact_velocity) {
    const std::unique_ptr<Water> water = make_water(scene);
    const Channel& channel = scene.channel;
    const int frames = frames_in(scene, scene.duration);
    const int averaged = frames_in(scene, std::min(scene.duration / 4, 100.0));
    Tiles tiles(channel);
    Cost cost;
    double worst_speed = 0;
    Curve curve{"history", {"t_s", "depth_m", "exact_depth_m", "velocity_m_s", "exact_velocity_m_s"}, {}};
    for (int f = 1; f <= frames; ++f) {
        water->advance(cost);
        const fluid::RiverMeasures river = water->measures();
        curve.rows.push_back({f / scene.frame_rate, river.mean_depth, channel.depth, river.mean_speed, exact_velocity});
        worst_speed = std::max(worst_speed, std::abs(river.mean_speed / exact_velocity - 1));
        if (f > frames - averaged) {
            tiles.sample(*water);
        }
    }

    const auto& rows = curve.rows;
    const std::size_t window = rows.size() - static_cast<std::size_t>(averaged);
    const double areal = water->volume() / (channel.x.length() * channel.z.length());
    Result result;
    water->note(cost, result);
    result.metrics = {
        {"mass", std::abs(areal / channel.depth - 1), "1"},
        {"depth", std::abs(column_mean(rows, window, 1) / channel.depth - 1), "1"},
        {"speed", std::abs(column_mean(rows, window, 3) / exact_velocity - 1), "1"},
        {"worst_speed", worst_speed, "1"},
        {"worst_tile", tiles.worst(exact_velocity), "1"},
        {"depth_drift", std::abs(60 * slope(rows, rows.size() / 2, 1) / channel.depth), "1/min"},
        {"speed_drift", std::abs(60 * slope(rows, rows.size() / 2, 3) / exact_velocity), "1/min"},
        {"driving_acceleration", water->driving() / scene.duration, "m/s2"},
        {"max_density_error", cost.max_density_error, "1"},
        {"position_clamps", water->position_clamps(), "1"},
    };
    // A point a second is enough for a plot.
    const auto every = static_cast<std::size_t>(std::max(1L, std::lround(scene.frame_rate)));
    Curve thin{curve.name, curve.columns, {}};
    for (std::size_t i = every - 1; i < rows.size(); i += every) {
        thin.rows.push_back(rows[i]);
    }
    result.curves = {thin};
    return result;
}

// The channel is periodic along x: 10 m of it are as good as 100 m. Two layers of particles, the paper's, get 20 m.
std::vector<std::string> length(const Request& request) {
    const double metres = request.spacing > 0.3 ? 20 : 10;
    return {assign("/channel/x_min_m", 0), assign("/channel/x_max_m", metres)};
}

Result run_recirculating(const Request& request, double duration) {
    std::vector<std::string> sizes = length(request);
    sizes.push_back(assign("/duration_s", duration));
    const Scene scene = scene_for(request, "validation/uniform_river.json", sizes);
    return run_river(scene, scene.channel->velocity);
}

Result run_manning(const Request& request, double duration, double start) {
    const Scene given = scene_for(request, "validation/manning_river.json");
    const double truth =
        std::pow(given.channel->depth, 2.0 / 3) * std::sqrt(given.channel->slope) / given.channel->manning_n;
    const Scene scene = scene_for(request, "validation/manning_river.json",
                                  {assign("/duration_s", duration), assign("/channel/velocity_m_s", start * truth)});
    return run_river(scene, truth);
}

Case recirculating(const char* name, const char* time) {
    return {.name = name,
            .truth = std::string("The river of the scenes, 27 m wide, 1 m deep, 1.5 m/s, recirculating for ") + time +
                     ": mass, depth and mean speed are given, and no part of it may differ. The banks and the bed are "
                     "smooth. Means of the last quarter; drifts by a straight line through the second half.",
            .reference = "mass balance",
            .spacings = {0.4642, 0.25, 0.125}};
}

Case sloped(const char* name, const char* time) {
    return {
        .name = name,
        .truth =
            std::string("A river 1 m deep on a slope of 0.002 with Manning's n = 0.03, periodic along and across, ") +
            time +
            "; the wide channel's speed is h^(2/3) S^(1/2) / n = 1.491 m/s. The flow is the same all across, so that "
            "10 m x 6 m of it stand for the 27 m.",
        .reference = "Manning",
        .spacings = {0.4642, 0.25, 0.125}};
}

}  // namespace

Case uniform_river_case() {
    Case c = recirculating("uniform_river", "60 s");
    c.quick = true;
    c.run = [](const Request& request) { return run_recirculating(request, 60); };
    return c;
}

Case uniform_river_600s_case() {
    Case c = recirculating("uniform_river_600s", "600 s");
    c.long_from = 0;
    c.run = [](const Request& request) { return run_recirculating(request, 600); };
    return c;
}

Case manning_river_case() {
    Case c = sloped("manning_river", "60 s from the exact speed");
    c.quick = true;
    c.quick_level = 1;
    c.run = [](const Request& request) { return run_manning(request, 60, 1); };
    return c;
}

Case manning_river_600s_case() {
    Case c = sloped("manning_river_600s", "600 s from a speed 20 % too low");
    c.long_from = 0;
    c.run = [](const Request& request) { return run_manning(request, 600, 0.8); };
    return c;
}

}  // namespace wade::validation
