#include "crowd_trips.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/bodies/body_cells.hpp"

namespace wade::validation {
namespace {

constexpr double rounding = 1e-6;  // m; walls stand a skin of as much before their faces

// How far a disc reaches into a box, m; at most 0: it does not.
double depth_in(const Obstacle& box, const crowd::Vector2d& p, double radius) {
    const crowd::Vector2d nearest(std::clamp(p.x(), box.x.lo, box.x.hi), std::clamp(p.y(), box.z.lo, box.z.hi));
    return radius - (p - nearest).norm();
}

double depth_in_walls(const crowd::CrowdWorld& crowd, const crowd::Vector2d& p, double radius) {
    const World& world = crowd.scene.world;
    double depth = -std::min(p.y(), world.width - p.y());  // the edge of the world holds the centre only
    if (!(world.period() > 0)) depth = std::max(depth, -std::min(p.x(), world.length - p.x()));
    for (const Obstacle& box : crowd.scene.obstacles) depth = std::max(depth, depth_in(box, p, radius));
    return depth;
}

double distance_beyond(const Gate& line, const crowd::Vector2d& p) {
    return line.forward.dot(p - line.a);
}

}  // namespace

Scene people_scene(const Request& request, const std::string& name, std::uint64_t seed,
                   const std::vector<std::string>& settings) {
    Request dry = request;
    dry.spacing = 0;
    Scene scene = scene_for(dry, "validation/" + name, settings);
    scene.seed = seed;
    return scene;
}

void note_bodies(const crowd::CrowdWorld& crowd, Tally& tally) {
    std::vector<crowd::Vector2d> people;
    for (const std::uint32_t id : crowd.active) people.push_back(crowd.agents.position[id]);
    const double reach = 2 * crowd.scene.crowd->body_radius;
    crowd::BodyCells cells;
    crowd::sort_people(cells, crowd.scene.world, people, reach);
    for (std::uint32_t k = 0; k < people.size(); ++k) {
        const double radius = half_width(crowd, crowd.active[k]);
        cells.visit_near(people[k], reach, [&](std::uint32_t j, double dx, double dz) {
            if (j <= k) return;
            const double depth = radius + half_width(crowd, crowd.active[j]) - std::hypot(dx, dz);
            if (depth <= rounding) return;
            tally.overlaps += 1;
            tally.deepest = std::max(tally.deepest, depth);
        });
        const double depth = depth_in_walls(crowd, people[k], radius);
        if (depth <= 2 * rounding) continue;
        tally.in_walls += 1;
        tally.deepest = std::max(tally.deepest, depth);
    }
    tally.steps += static_cast<double>(people.size());
}

void report_tally(const Tally& tally, Result& result) {
    result.metrics.push_back({"left_behind", tally.left_behind, "1"});
    result.metrics.push_back({"overlaps", tally.overlaps, "1"});
    result.metrics.push_back({"in_walls", tally.in_walls, "1"});
    result.metrics.push_back({"deepest_overlap", tally.deepest, "m"});
    result.metrics.push_back({"steps_of_people", tally.steps, "1"});
}

Trip walk_past(crowd::CrowdWorld& crowd, const std::vector<Gate>& lines, Result& result, Tally& tally,
               const crowd::WaterView& water, const std::function<void()>& before_step) {
    const std::size_t people = crowd.agents.size();
    Trip trip;
    trip.passed_at.assign(people, std::numeric_limits<double>::quiet_NaN());
    std::size_t waiting = people;
    std::vector<crowd::Vector2d> before;
    while (waiting > 0 && !crowd.active.empty() && trip.end < crowd.scene.duration - crowd.dt / 2) {
        if (before_step) before_step();
        before = crowd.agents.position;
        walk(crowd, result, water);
        note_bodies(crowd, tally);
        trip.end = static_cast<double>(crowd.steps) * crowd.dt;
        for (std::size_t id = 0; id < people; ++id) {
            if (!std::isnan(trip.passed_at[id])) continue;
            const Gate& line = lines[std::min<std::size_t>(crowd.agents.group[id], lines.size() - 1)];
            const double now = distance_beyond(line, crowd.agents.position[id]);
            if (now < 0) continue;
            const double then = std::min(distance_beyond(line, before[id]), 0.0);
            trip.passed_at[id] = trip.end - (now > then ? now / (now - then) : 0) * crowd.dt;
            --waiting;
        }
    }
    tally.left_behind = std::max(tally.left_behind, static_cast<double>(waiting));
    return trip;
}

std::vector<double> times_of(const crowd::CrowdWorld& crowd, const Trip& trip, std::uint32_t group) {
    std::vector<double> times;
    for (std::size_t id = 0; id < trip.passed_at.size(); ++id) {
        if (crowd.agents.group[id] == group && !std::isnan(trip.passed_at[id])) times.push_back(trip.passed_at[id]);
    }
    std::sort(times.begin(), times.end());
    return times;
}

double middle_flow(const std::vector<double>& times) {
    if (times.size() < 20) return std::numeric_limits<double>::quiet_NaN();
    const std::size_t tenth = times.size() / 10;
    const std::size_t last = times.size() - 1 - tenth;
    return static_cast<double>(last - tenth) / (times[last] - times[tenth]);
}

Curve curve_of_leaving(const std::string& name, const std::vector<std::string>& columns,
                       const std::vector<std::vector<double>>& times, double step) {
    Curve curve{name, {"time_s"}, {}};
    curve.columns.insert(curve.columns.end(), columns.begin(), columns.end());
    double end = 0;
    for (const std::vector<double>& of_one : times) end = std::max(end, of_one.empty() ? 0.0 : of_one.back());
    for (double t = 0; t <= end + step; t += step) {
        std::vector<double> row{t};
        for (const std::vector<double>& of_one : times) {
            row.push_back(static_cast<double>(std::upper_bound(of_one.begin(), of_one.end(), t) - of_one.begin()));
        }
        curve.rows.push_back(row);
    }
    return curve;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double worse(double a, double b) {
    return std::isnan(a) || a > b ? a : b;
}

}  // namespace wade::validation
