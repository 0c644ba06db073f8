// The shape of the bed: points in order, room for the water, level where it must be.

#include <algorithm>
#include <cmath>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade {

namespace {

double bed_height_at(const std::vector<BedPoint>& points, double x) {
    if (x <= points.front().x) return points.front().y;
    for (std::size_t i = 1; i < points.size(); ++i) {
        const BedPoint &a = points[i - 1], &b = points[i];
        if (x <= b.x) return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
    }
    return points.back().y;
}

// Lowest and highest bed over a stretch.
Interval bed_heights_over(const std::vector<BedPoint>& points, const Interval& x) {
    const double at_lo = bed_height_at(points, x.lo), at_hi = bed_height_at(points, x.hi);
    Interval y{std::min(at_lo, at_hi), std::max(at_lo, at_hi)};
    for (const BedPoint& point : points) {
        if (!x.contains(point.x)) continue;
        y = {std::min(y.lo, point.y), std::max(y.hi, point.y)};
    }
    return y;
}

// Points in order, with room for the water above them.
void check_points(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const std::vector<BedPoint>& points = channel.bed_points;
    const double d = scene.fluid->particle_spacing;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string pointer = "/channel/bed_points/" + std::to_string(i);
        if (i > 0 && !(points[i - 1].x < points[i].x)) {
            refuse(source, pointer + "/x_m",
                   short_number(points[i].x) + " m is not larger than that of the point before; allowed: > " +
                       short_number(points[i - 1].x) + " m.");
        }
        // Particles see each other in the facet below the middle between them, which is right for gentle changes of slope.
        constexpr double steepest = 0.5;
        const double rise = i > 0 ? std::abs(points[i].y - points[i - 1].y) : 0;
        if (i > 0 && rise > steepest * (points[i].x - points[i - 1].x) + rounding_tolerance) {
            refuse(source, pointer + "/y_m",
                   short_number(points[i].y) + " m is " + short_number(rise) +
                       " m from that of the point before, steeper than 1 : 2; allowed: " +
                       short_number(std::max(0.0, points[i - 1].y - steepest * (points[i].x - points[i - 1].x))) +
                       " to " + short_number(points[i - 1].y + steepest * (points[i].x - points[i - 1].x)) +
                       " m. A step is an obstacle.");
        }
        const auto check_room = [&](double height, const std::string& what) {
            if (points[i].y <= height - d + rounding_tolerance) return;
            refuse(source, pointer + "/y_m",
                   short_number(points[i].y) + " m leaves less than a particle spacing below " + what + " " +
                       short_number(height) + " m; allowed: <= " + short_number(std::max(0.0, height - d)) + " m.");
        };
        if (has_river(channel)) check_room(channel.depth, "the water's surface at /channel/depth_m =");
        if (channel.top == Top::wall) check_room(channel.height, "the lid at /channel/height_m =");
    }
}

// Level where particles see each other but not the bed between them: across a periodic joint, and in the emitter.
void check_ends(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const std::vector<BedPoint>& points = channel.bed_points;
    const double reach = reach_of_water(scene.fluid);
    const auto check_level = [&](const Interval& x, double y, const std::string& where) {
        const Interval heights = bed_heights_over(points, x);
        if (heights.lo >= y - rounding_tolerance && heights.hi <= y + rounding_tolerance) return;
        refuse(source, "/channel/bed_points",
               "the bed lies at " + short_number(heights.lo) + " to " + short_number(heights.hi) + " m within x " +
                   short_number(x.lo) + " to " + short_number(x.hi) + " m, " + where + "; allowed: " + short_number(y) +
                   " m there.");
    };
    if (channel.flow == Flow::recirculating || channel.flow == Flow::periodic) {
        const double y = bed_height_at(points, channel.x.lo);
        check_level({std::min(points.front().x, channel.x.lo), channel.x.lo + reach}, y, "next to the periodic joint");
        check_level({channel.x.hi - reach, std::max(points.back().x, channel.x.hi)}, y, "next to the periodic joint");
    }
    if (channel.flow == Flow::emitter) {
        check_level({channel.x.hi - reach, std::max(points.back().x, channel.x.hi)}, 0, "at the emitter");
    }
}

void check_blocks(const Scene& scene, const std::string& source) {
    const double d = scene.fluid->particle_spacing;
    const std::vector<WaterBlock>& blocks = scene.channel->water_blocks;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const std::string pointer = "/channel/water_blocks/" + std::to_string(i);
        const double y_min = blocks[i].y_min;
        const Interval bed = bed_heights_over(scene.channel->bed_points, blocks[i].x);
        if (y_min > 0 && y_min < bed.hi - rounding_tolerance) {
            refuse(source, pointer + "/y_min_m",
                   short_number(y_min) + " m reaches into the bed, which rises to " + short_number(bed.hi) +
                       " m below the block; allowed: >= " + short_number(bed.hi) + " m, or 0 to stand on the bed.");
        }
        if (y_min + blocks[i].depth < bed.lo + d - rounding_tolerance) {
            refuse(source, pointer + "/depth_m",
                   short_number(blocks[i].depth) + " m, counted from y = " + short_number(y_min) +
                       " m, leaves less than a particle spacing above the bed, which lies at " + short_number(bed.lo) +
                       " m or higher; allowed: >= " + short_number(bed.lo + d - y_min) + " m.");
        }
    }
}

}  // namespace

bool has_river(const Channel& channel) {
    return channel.flow == Flow::emitter ||
           (channel.flow != Flow::closed && channel.initial_river == InitialRiver::filled);
}

void check_bed(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    if (channel.bed_points.empty()) return;
    if (channel.top == Top::periodic) {
        refuse(source, "/channel/bed_points", "there is no bed where /channel/top is \"periodic\"; allowed: none.");
    }
    check_points(scene, source);
    check_ends(scene, source);
    check_blocks(scene, source);
}

}  // namespace wade
