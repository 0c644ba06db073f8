#include "crowd_client/water/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/site.hpp"
#include "configs/scene/world.hpp"

namespace wade::crowd {
namespace {

constexpr double empty_time = 10;     // s
constexpr double heaviest = 10;       // times the density of water; waves and random positions stay far below
constexpr double margin_share = 0.1;  // of a side of the box
constexpr double margin = 1;          // m

// Bounds of one axis in stored units, swapped for a mirrored axis.
struct StoredInterval {
    float lo, hi;
    StoredInterval(const Interval& side, double origin, double scale) {
        const double reach = margin + margin_share * side.length();
        const double a = (side.lo - reach - origin) / scale, b = (side.hi + reach - origin) / scale;
        lo = static_cast<float>(std::min(a, b));
        hi = static_cast<float>(std::max(a, b));
    }
};

// Result of one pass over the particles, in stored units.
struct Sums {
    std::size_t inside = 0;
    float mass = 0, lightest = std::numeric_limits<float>::infinity(), heaviest = 0;
    std::array<float, 3> lo, hi;
};

Sums sum_up(const WaterView& water, const StoredInterval& x, const StoredInterval& y, const StoredInterval& z) {
    const float *const m = water.mass.data(), *const px = water.px.data(), *const py = water.py.data(),
                       *const pz = water.pz.data();
    const std::size_t n = water.size();
    constexpr float far = std::numeric_limits<float>::infinity();
    float mass = 0, lightest = far, most = -far;
    float x_lo = far, x_hi = -far, y_lo = far, y_hi = -far, z_lo = far, z_hi = -far;
    int inside = 0;
#pragma omp simd reduction(+ : mass, inside) reduction(min : lightest, x_lo, y_lo, z_lo) \
    reduction(max : most, x_hi, y_hi, z_hi)
    for (std::size_t i = 0; i < n; ++i) {
        mass += m[i];
        lightest = m[i] < lightest ? m[i] : lightest;
        most = m[i] > most ? m[i] : most;
        x_lo = px[i] < x_lo ? px[i] : x_lo;
        x_hi = px[i] > x_hi ? px[i] : x_hi;
        y_lo = py[i] < y_lo ? py[i] : y_lo;
        y_hi = py[i] > y_hi ? py[i] : y_hi;
        z_lo = pz[i] < z_lo ? pz[i] : z_lo;
        z_hi = pz[i] > z_hi ? pz[i] : z_hi;
        inside +=
            (px[i] >= x.lo) & (px[i] <= x.hi) & (py[i] >= y.lo) & (py[i] <= y.hi) & (pz[i] >= z.lo) & (pz[i] <= z.hi);
    }
    Sums sums;
    sums.inside = static_cast<std::size_t>(inside);
    sums.mass = mass;
    sums.lightest = lightest;
    sums.heaviest = most;
    sums.lo = {x_lo, y_lo, z_lo};
    sums.hi = {x_hi, y_hi, z_hi};
    return sums;
}

void check_masses(const Sums& sums, std::uint64_t frame) {
    // The sum of all shows a NaN, which no comparison does.
    if (sums.lightest > 0 && !std::isnan(sums.mass) && std::isfinite(sums.heaviest)) return;
    char text[160];
    std::snprintf(text, sizeof text, "frame %llu of the water has masses from %g to %g kg; allowed: above 0 and finite",
                  static_cast<unsigned long long>(frame), static_cast<double>(sums.lightest),
                  static_cast<double>(sums.heaviest));
    throw RunError(ExitCode::protocol_violation, text);
}

std::string text_of(const Box& box) {
    const auto& [x, y, z] = box.sides;
    char text[200];
    std::snprintf(text, sizeof text, "x %.4g to %.4g, y %.4g to %.4g, z %.4g to %.4g m", x.lo, x.hi, y.lo, y.hi, z.lo,
                  z.hi);
    return text;
}

bool lies_in(const Box& inner, const Box& outer) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Interval &a = inner.sides[i], &b = outer.sides[i];
        const double reach = margin + margin_share * b.length();
        if (a.lo < b.lo - reach || a.hi > b.hi + reach) return false;
    }
    return true;
}

Box scaled(const Box& box, double factor) {
    Box result = box;
    for (Interval& side : result.sides) side = {side.lo * factor, side.hi * factor};
    return result;
}

// What would put the particles into the box.
std::string guess(const Box& found, const Box& expected) {
    const Box swapped{{found.sides[0], found.sides[2], found.sides[1]}};
    if (lies_in(swapped, expected)) return "; with y and z swapped they would lie in it";
    if (lies_in(scaled(found, 1e-3), expected)) return "; taken as millimetres they would lie in it";
    if (lies_in(scaled(found, 1e-2), expected)) return "; taken as centimetres they would lie in it";
    return "";
}

// Returns the possible heights of water on a site: from its lowest ground to 100 m above its highest [A].
Interval heights_of(const Ground& ground, const World& world) {
    std::vector<double> heights;
    if (ground.raster) {
        heights = ground.raster->values;
    } else {
        for (const double x : {0.0, world.length}) {
            for (const double z : {0.0, world.width}) heights.push_back(ground_height(ground, {x, z}));
        }
        for (const auto& point : ground.points) heights.push_back(point[1]);
    }
    constexpr double deepest = 100;
    Interval range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const double height : heights) {
        if (!std::isnan(height)) range = {std::min(range.lo, height), std::max(range.hi, height)};
    }
    return {range.lo, range.hi + deepest};
}

bool starts_with_water(const Scene& scene) {
    const Channel& channel = scene.channel;
    const bool fed = channel.flow == Flow::emitter && (channel.velocity > 0 || !channel.velocity_history.empty());
    return fed || channel.initial_river == InitialRiver::filled || !channel.water_blocks.empty();
}

}  // namespace

Box water_box(const Scene& scene) {
    const Channel& channel = scene.channel;
    if (scene.site) return {{channel.x, heights_of(scene.site->ground, scene.world), channel.z}};
    double bed_lo = 0, bed_hi = 0;
    for (const BedPoint& point : channel.bed_points) {
        bed_lo = std::min(bed_lo, point.y);
        bed_hi = std::max(bed_hi, point.y);
    }
    double top = bed_hi + channel.depth;
    for (const WaterBlock& block : channel.water_blocks) top = std::max(top, bed_hi + block.y_min + block.depth);
    if (channel.top != Top::open) top = std::max(top, channel.height);
    return {{channel.x, {bed_lo, top}, channel.z}};
}

Plausibility::Plausibility(const Scene& scene)
    : expected_(water_box(scene)),
      rest_density_(scene.fluid->rest_density),
      should_have_water_(starts_with_water(scene)) {}

std::vector<std::string> Plausibility::look(const WaterView& water, std::uint64_t frame, double time) {
    std::vector<std::string> sentences;
    if (water.size() == 0) {
        if (should_have_water_ && time > empty_time && !std::exchange(told_empty_, true)) {
            sentences.push_back("no frame of the water had a particle in the first " + std::to_string(frame) +
                                " frames, where the scene has water from the start");
        }
        return sentences;
    }
    should_have_water_ = false;
    const std::array origin{water.origin_x, water.origin_y, water.origin_z};
    const std::array scale{water.scale_x, water.scale_y, water.scale_z};
    const auto stored = [&](std::size_t i) { return StoredInterval(expected_.sides[i], origin[i], scale[i]); };
    const Sums sums = sum_up(water, stored(0), stored(1), stored(2));
    check_masses(sums, frame);
    if (told_outside_ && told_heavy_) return sentences;

    Box found;
    double volume = 1;
    const double width = cube_root(static_cast<double>(sums.heaviest) / rest_density_);
    for (std::size_t i = 0; i < 3; ++i) {
        const double a = origin[i] + scale[i] * static_cast<double>(sums.lo[i]);
        const double b = origin[i] + scale[i] * static_cast<double>(sums.hi[i]);
        found.sides[i] = {std::min(a, b), std::max(a, b)};
        volume *= found.sides[i].length() + width;
    }
    const std::string boxes = "the particles fill " + text_of(found) + ", the scene's water " + text_of(expected_);
    const bool outside = 2 * sums.inside < water.size();
    if (outside && !std::exchange(told_outside_, true)) {
        sentences.push_back("most of the water lies outside the channel: " + boxes + guess(found, expected_));
    }
    const double times = static_cast<double>(sums.mass) / (volume * rest_density_);
    const double widest =
        std::max({expected_.sides[0].length(), expected_.sides[1].length(), expected_.sides[2].length()});
    const bool heavy = times > heaviest || width > widest;
    if (!outside && heavy && !std::exchange(told_heavy_, true)) {
        char text[200];
        std::snprintf(text, sizeof text,
                      "the particles weigh up to %.3g kg each, %.3g kg together, too much for where they are: ",
                      static_cast<double>(sums.heaviest), static_cast<double>(sums.mass));
        sentences.push_back(text + boxes);
    }
    return sentences;
}

}  // namespace wade::crowd
