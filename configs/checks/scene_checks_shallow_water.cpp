// What the shallow-water model can take: open water that stands on the bed, and obstacles that its cells can show.

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

constexpr double most_cells = 1e8;  // about 13 GB

std::string name_of_model(const Scene& scene) {
    return quoted(scene.fluid->model);
}

void check_surface(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const std::string model = name_of_model(scene) + " ";
    if (channel.top != Top::open) {
        refuse(source, "/fluid/model",
               model + "has a free surface, and /channel/top is \"" + name_of(channel.top) +
                   "\"; allowed: \"open\", or the model \"dfsph\".");
    }
    if (!channel.no_slip.empty()) {
        refuse(source, "/fluid/model",
               model +
                   "knows the mean velocity over the depth only, so that /channel/no_slip would have no effect; "
                   "allowed: none, or the model \"dfsph\". The bed's friction is /channel/manning_n.");
    }
    if (!(scene.world->gravity > 0)) {
        refuse(
            source, "/world/gravity_m_s2",
            short_number(scene.world->gravity) + " m/s2: the waves of " + model + "need gravity; allowed: > 0 m/s2.");
    }
    for (std::size_t i = 0; i < channel.water_blocks.size(); ++i) {
        const WaterBlock& block = channel.water_blocks[i];
        const std::string pointer = "/channel/water_blocks/" + std::to_string(i);
        if (block.y_min > 0) {
            refuse(source, pointer + "/y_min_m",
                   short_number(block.y_min) + " m: the water of " + model + "stands on the bed; allowed: 0 m.");
        }
        if (block.velocity[1] != 0) {
            refuse(source, pointer + "/velocity_y_m_s",
                   short_number(block.velocity[1]) + " m/s: the water of " + model +
                       "has no velocity of its own upwards; allowed: 0 m/s.");
        }
    }
}

void check_grid(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const double size = scene.fluid->shallow_water.cell_size;
    const std::string pointer = "/fluid/shallow_water/cell_size_m";
    if (size > channel.x.length() * (1 + rounding_tolerance)) {
        refuse(source, pointer,
               short_number(size) + " m is larger than the channel's length of " + short_number(channel.x.length()) +
                   " m; allowed: <= " + short_number(channel.x.length()) + " m.");
    }
    if (channel.x.length() / size * channel.z.length() / size > most_cells) {
        refuse(source, pointer,
               short_number(size) + " m makes more than " + short_number(most_cells) + " cells of the channel of " +
                   short_number(channel.x.length()) + " m x " + short_number(channel.z.length()) + " m; allowed: >= " +
                   short_number(std::sqrt(channel.x.length() * channel.z.length() / most_cells)) + " m.");
    }
    const auto check_side = [&](const Interval& side, const Interval& extent, std::size_t i, const char* axis) {
        const double cell = extent.length() / static_cast<double>(cells_along(extent, size));
        if (side.length() >= cell * (1 - rounding_tolerance)) return;
        refuse(source, "/obstacles/" + std::to_string(i),
               "the obstacle is " + short_number(side.length()) + " m long in " + axis + ", less than a cell of " +
                   short_number(cell) + " m, so that the model " + name_of_model(scene) +
                   " would miss it; allowed: >= " + short_number(cell) + " m, or a smaller " + pointer + ".");
    };
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
        check_side(scene.obstacles[i].x, channel.x, i, "x");
        check_side(scene.obstacles[i].z, channel.z, i, "z");
    }
}

}  // namespace

void check_shallow_water(const Scene& scene, const std::string& source) {
    if (scene.fluid->model != ModelKind::shallow_water && scene.fluid->model != ModelKind::mixed) return;
    check_surface(scene, source);
    check_grid(scene, source);
    // Depths are sure to stay positive up to there.
    if (scene.fluid->cfl > 0.5) {
        refuse(source, "/fluid/cfl",
               short_number(scene.fluid->cfl) + " is too large for the model " + name_of_model(scene) +
                   ", dt (s_x / dx + s_z / dz) with the fastest waves s; "
                   "allowed: <= 0.5.");
    }
}

}  // namespace wade
