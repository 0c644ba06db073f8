// The recirculating river of the scenes, and one that slope and friction balance.

#include <cmath>

#include "cases.hpp"
#include "river.hpp"

namespace wade::validation {

namespace {

// The channel is periodic along x: 10 m of it are as good as 100 m. Two layers of particles, the paper's, get 20 m.
std::vector<std::string> length(const Request& request) {
    const double metres = request.spacing > 0.3 ? 20 : 10;
    return {assign("/channel/x_min_m", 0), assign("/channel/x_max_m", metres)};
}

Result run_recirculating(const Request& request, double duration) {
    std::vector<std::string> sizes = length(request);
    sizes.push_back(assign("/duration_s", duration));
    const Scene scene = scene_for(request, "validation/uniform_river.json", sizes);
    return run_river(scene, scene.channel.velocity);
}

Result run_manning(const Request& request, double duration, double start) {
    const Scene given = scene_for(request, "validation/manning_river.json");
    const double truth =
        std::pow(given.channel.depth, 2.0 / 3) * std::sqrt(given.channel.slope) / given.channel.manning_n;
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
