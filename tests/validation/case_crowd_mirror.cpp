// The mirrored scene gives the mirrored run.

#include <algorithm>
#include <cmath>
#include <utility>

#include "cases.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

namespace {

// A multiple of 2^-20 m, so that mirrored coordinates and their differences are exact.
double rounded(double v) {
    return std::ldexp(std::round(std::ldexp(v, 20)), -20);
}

struct Mirror {
    bool along_x = false;
    bool along_z = false;
    double length = 0, width = 0;  // of the world, m

    [[nodiscard]] crowd::Vector2d operator()(const crowd::Vector2d& p) const {
        return {along_x ? length - p.x() : p.x(), along_z ? width - p.y() : p.y()};
    }
};

// The markers within 2 m of the world, rounded and mirrored. The last rows and columns of the grid's border lie farther
// away than the first; nobody perceives what is there.
crowd::Markers mirrored(const crowd::Markers& markers, const Mirror& mirror) {
    crowd::Markers made;
    made.grid = markers.grid;
    std::vector<std::pair<std::size_t, crowd::Vector2d>> kept;
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const crowd::Vector2d p(rounded(markers.x[m]), rounded(markers.z[m]));
        if (p.x() <= -2 || p.y() <= -2 || p.x() >= mirror.length + 2 || p.y() >= mirror.width + 2) continue;
        const crowd::Vector2d q = mirror(p);
        kept.emplace_back(made.grid.cell_of(q.x(), q.y()), q);
    }
    std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    made.cell_start.assign(made.grid.cells() + 1, 0);
    for (const auto& [cell, p] : kept) {
        made.x.push_back(p.x());
        made.z.push_back(p.y());
        ++made.cell_start[cell + 1];
    }
    for (std::size_t c = 0; c < made.grid.cells(); ++c) made.cell_start[c + 1] += made.cell_start[c];
    return made;
}

crowd::CrowdWorld mirrored_crowd(Scene scene, const crowd::Markers& markers, const Mirror& mirror) {
    for (Obstacle& o : scene.obstacles) {
        if (mirror.along_x) o.x = {mirror.length - o.x.hi, mirror.length - o.x.lo};
        if (mirror.along_z) o.z = {mirror.width - o.z.hi, mirror.width - o.z.lo};
    }
    crowd::CrowdWorld crowd = crowd::make_crowd(scene);
    crowd.markers = mirrored(markers, mirror);
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        crowd.agents.position[id] = mirror(crowd.agents.position[id]);
        crowd.agents.goal[id] = mirror(crowd.agents.goal[id]);
    }
    return crowd;
}

Result run(const Request& request) {
    const Scene scene = crowd_scene(request, "validation/crowd_mirror.json");
    const crowd::Markers markers = crowd::make_crowd(scene).markers;
    const Mirror none{false, false, scene.world.length, scene.world.width};
    crowd::CrowdWorld reference = mirrored_crowd(scene, markers, none);
    Mirror in_z = none;
    in_z.along_z = true;
    Mirror in_x = none;
    in_x.along_x = true;
    crowd::CrowdWorld over_z = mirrored_crowd(scene, markers, in_z);
    crowd::CrowdWorld over_x = mirrored_crowd(scene, markers, in_x);

    Result result = crowd_result();
    double distance_z = 0;
    double distance_x = 0;
    while (!reference.active.empty() && static_cast<double>(reference.steps) * reference.dt < scene.duration) {
        walk(reference, result);
        walk(over_z, result);
        walk(over_x, result);
        for (std::size_t id = 0; id < reference.agents.size(); ++id) {
            const crowd::Vector2d& p = reference.agents.position[id];
            distance_z = std::max(distance_z, (in_z(over_z.agents.position[id]) - p).norm());
            distance_x = std::max(distance_x, (in_x(over_x.agents.position[id]) - p).norm());
        }
    }
    double other_ends = 0;
    for (std::size_t id = 0; id < reference.agents.size(); ++id) {
        const bool same = reference.agents.outcome[id] == over_z.agents.outcome[id] &&
                          reference.agents.outcome[id] == over_x.agents.outcome[id] &&
                          reference.agents.end_step[id] == over_z.agents.end_step[id] &&
                          reference.agents.end_step[id] == over_x.agents.end_step[id];
        other_ends += same ? 0 : 1;
    }
    result.metrics = {
        {"distance_mirrored_in_z", distance_z, "m"},
        {"distance_mirrored_in_x", distance_x, "m"},
        {"other_ends", other_ends, "1"},
        {"arrived", static_cast<double>(reference.arrived), "1"},
    };
    return result;
}

}  // namespace

Case crowd_mirror_case() {
    return {.name = "crowd_mirror",
            .truth =
                "Two groups of 24 cross, one past a block, and again with everything mirrored across and along "
                "the world, markers too: the paths must be mirror images. Levels: 16, 32 and 64 markers per m2.",
            .reference = "mirror image",
            .spacings = marker_spacings,
            .quick = true,
            .run = run};
}

}  // namespace wade::validation
