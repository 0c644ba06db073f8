// Checks of the hybrid model (`mixed`) beyond those of shallow water: a level bed, a particle region that fits into the
// channel, and a key or agents that say where the region is.

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "configs/scene/mixed_window.hpp"

namespace wade {

namespace {

void check_place(const Scene& scene, const std::string& source) {
    const MixedWindow& mixed = scene.fluid->mixed;
    const Interval& channel = scene.channel->x;
    if (mixed.x_min.has_value() != mixed.x_max.has_value()) {
        refuse(source, mixed.x_min ? "/fluid/mixed/x_max_m" : "/fluid/mixed/x_min_m",
               "is missing; allowed: both ends of the window, or none.");
    }
    if (!mixed.x_min) return;
    if (!(*mixed.x_min >= channel.lo && *mixed.x_min < *mixed.x_max)) {
        refuse(source, "/fluid/mixed/x_min_m",
               short_number(*mixed.x_min) + " m; allowed: from the channel's begin, " + short_number(channel.lo) +
                   " m, to below x_max_m = " + short_number(*mixed.x_max) + " m.");
    }
    if (*mixed.x_max > channel.hi) {
        refuse(
            source, "/fluid/mixed/x_max_m",
            short_number(*mixed.x_max) + " m lies beyond the channel; allowed: <= " + short_number(channel.hi) + " m.");
    }
}

void check_room(const Scene& scene, const std::string& source) {
    const Interval& x = scene.channel->x;
    const double cell = x.length() / static_cast<double>(cells_along(x, scene.fluid->shallow_water.cell_size));
    const double guard = guard_length(scene, cell);
    if (scene.channel->flow != Flow::closed && x.length() < 2 * guard + 4 * cell) {
        refuse(source, "/fluid/model",
               "\"mixed\" needs a guard of " + short_number(guard) +
                   " m before each end of its window, and the channel is " + short_number(x.length()) +
                   " m long; allowed: >= " + short_number(2 * guard + 4 * cell) + " m, or the model \"dfsph\".");
    }
}

}  // namespace

void check_mixed(const Scene& scene, const std::string& source) {
    if (scene.fluid->model != ModelKind::mixed) return;
    if (!scene.channel->bed_points.empty()) {
        refuse(source, "/fluid/model",
               "\"mixed\" hands water over on a level bed only, and /channel/bed_points holds " +
                   std::to_string(scene.channel->bed_points.size()) +
                   "; allowed: none, or the models \"dfsph\" and \"shallow_water\".");
    }
    check_place(scene, source);
    check_room(scene, source);
    if (scene.coupling->agents_stream == AgentsStream::off && mixed_needs_agents(scene)) {
        refuse(source, "/fluid/model",
               "\"mixed\" does not know where particles are needed; allowed: /coupling/agents_stream \"serial\" or "
               "\"parallel\", so that they follow the people, or /fluid/mixed/x_min_m and x_max_m, or "
               "/fluid/mixed/obstacles in a scene that has some.");
    }
}

}  // namespace wade
