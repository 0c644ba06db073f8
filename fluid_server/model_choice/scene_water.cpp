#include "fluid_server/model_choice/scene_water.hpp"

#include <algorithm>
#include <cmath>

#include "configs/checks/scene_checks.hpp"
#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/world.hpp"

namespace wade::fluid::model_choice {

namespace {

constexpr double rounding = 1e-6;

void add(SceneWater& water, WaterKind kind, const std::string& why) {
    const bool there =
        std::any_of(water.kinds.begin(), water.kinds.end(), [&](const auto& k) { return k.kind == kind; });
    if (!there) water.kinds.push_back({kind, why});
}

void add_blocks(const Channel& channel, SceneWater& water) {
    if (channel.water_blocks.empty()) return;
    double ground = 0;
    const double depth = channel.water_blocks.front().depth;
    bool level = true;
    for (const WaterBlock& block : channel.water_blocks) {
        if (block.y_min == 0) ground += block.x.length() * block.z.length();
        level = level && std::abs(block.depth + block.y_min - depth) <= rounding;
    }
    if (ground < channel.x.length() * channel.z.length() * (1 - rounding)) {
        add(water, WaterKind::dry_front, "water_blocks beside a dry bed");
    }
    if (!level) add(water, WaterKind::wet_front, "water_blocks of different depths");
    if (water.kinds.empty()) add(water, WaterKind::river, "level water_blocks");
}

void add_flow(const Channel& channel, SceneWater& water) {
    const bool filled = channel.initial_river == InitialRiver::filled;
    if (channel.flow == Flow::emitter) {
        add(water, WaterKind::inflow, filled ? "an emitter and a fall" : "an emitter that floods a dry bed");
    }
    if (channel.flow != Flow::closed && filled) add(water, WaterKind::river, "a river from the start on");
    if (!channel.velocity_history.empty() && filled) {
        add(water, WaterKind::wet_front, "velocity_history lets the river rise");
    }
    if (!channel.bed_points.empty()) add(water, WaterKind::wet_front, "bed_points change depth and speed on the way");
}

double deepest(const Channel& channel) {
    double depth = has_river(channel) ? channel.depth : 0;
    for (const WaterBlock& block : channel.water_blocks) depth = std::max(depth, block.depth);
    return depth > 0 ? depth : channel.depth;
}

double fastest(const Channel& channel) {
    double velocity = channel.velocity;
    for (const VelocityPoint& point : channel.velocity_history) velocity = std::max(velocity, point.velocity);
    for (const WaterBlock& block : channel.water_blocks) {
        velocity = std::max(velocity, length_of(block.velocity[0], block.velocity[2]));
    }
    return velocity;
}

}  // namespace

double contact_distance(const Coupling& coupling) {
    const double a = coupling.agent_radius, p = coupling.particle_radius;
    return coupling.contact_rule == ContactRule::sum ? a + p : std::abs(a - p);
}

SceneWater water_of(const Scene& scene) {
    const Channel& channel = scene.channel;
    SceneWater water;
    add_blocks(channel, water);
    add_flow(channel, water);
    if (!scene.obstacles.empty()) add(water, WaterKind::lee, "water round /obstacles");
    if (water.kinds.empty()) add(water, WaterKind::river, "no water");
    water.depth = deepest(channel);
    water.velocity = fastest(channel);
    water.scale = water.depth / table_depth;
    const double contact = contact_distance(scene.coupling);
    if (contact > 0) water.scale = std::min(water.scale, contact / table_contact_distance);
    return water;
}

double wave_speed(const Scene& scene, const SceneWater& water) {
    return std::sqrt(scene.world->gravity * water.depth) + water.velocity;
}

}  // namespace wade::fluid::model_choice
