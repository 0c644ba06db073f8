#include "fluid_server/model_choice/patch.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"

namespace wade::fluid::model_choice {

namespace {

std::string block_json(double x_lo, double x_hi, double width, double depth, double velocity) {
    std::ostringstream text;
    text << R"({"x_min_m": )" << x_lo << R"(, "x_max_m": )" << x_hi << R"(, "z_min_m": 1, "z_max_m": )" << 1 + width
         << R"(, "depth_m": )" << depth << R"(, "velocity_x_m_s": )" << -velocity << "}";
    return text.str();
}

// Eight places that have no common measure with spacings, in [x, x + length] and the middle three quarters of the width.
void add_probes(Patch& patch, double x, double length) {
    for (int k = 0; k < 8; ++k) {
        const double along = (k + 0.5) / 8, across = std::fmod(0.5 + 0.618034 * k, 1.0);
        patch.probes.push_back({x + along * length, 1 + patch.width * (0.125 + 0.75 * across)});
    }
}

Patch river_patch(double depth, double velocity) {
    Patch patch{depth, velocity, 6 * depth, 3 * depth, R"("flow": "recirculating", "initial_river": "filled")",
                "[]",  {}};
    add_probes(patch, 0, patch.length);
    return patch;
}

Patch lee_patch(const Scene& scene, double depth, double velocity) {
    const auto smaller = [](const Obstacle& a, const Obstacle& b) {
        return a.x.length() * a.z.length() < b.x.length() * b.z.length();
    };
    const Obstacle& o = *std::min_element(scene.obstacles.begin(), scene.obstacles.end(), smaller);
    const double lx = o.x.length(), lz = o.z.length();
    Patch patch{depth,
                velocity,
                4 * lx + 4 * depth,
                3 * lz + 2 * depth,
                R"("flow": "recirculating", "initial_river": "filled")",
                "",
                {}};
    const double x = patch.length - lx - 2 * depth, z = 1 + 0.5 * (patch.width - lz);
    std::ostringstream text;
    text << R"([{"x_min_m": )" << x << R"(, "x_max_m": )" << x + lx << R"(, "z_min_m": )" << z << R"(, "z_max_m": )"
         << z + lz << R"(, "height_m": )" << o.height << "}]";
    patch.obstacles = text.str();
    add_probes(patch, x - 2.5 * lx, 2.25 * lx);
    return patch;
}

Patch front_patch(double depth, double velocity, double under) {
    Patch patch{depth, velocity, 6 * depth, 2 * depth, "", "[]", {}};
    patch.channel = R"("flow": "closed", "water_blocks": [)" +
                    block_json(3 * depth, 6 * depth, patch.width, depth, velocity) +
                    (under > 0 ? ", " + block_json(0, 3 * depth, patch.width, under, 0) : "") + "]";
    add_probes(patch, 0.5 * depth, 2.5 * depth);
    return patch;
}

std::string patch_json(const Patch& patch, const Scene& scene, double time) {
    std::ostringstream text;
    const bool closed = patch.channel.find("closed") != std::string::npos;
    text << R"({"name": "pilot", "duration_s": )" << time << R"(, "frame_rate_hz": )" << scene.frame_rate
         << R"(, "world": {"length_m": )" << patch.length << R"(, "width_m": )" << patch.width + 2
         << R"(, "gravity_m_s2": )" << scene.world->gravity << R"(}, "channel": {"x_min_m": 0, "x_max_m": )"
         << patch.length << R"(, "z_min_m": 1, "z_max_m": )" << 1 + patch.width << ", " << patch.channel;
    if (!closed) text << R"(, "depth_m": )" << patch.depth << R"(, "velocity_m_s": )" << patch.velocity;
    text << R"(}, "obstacles": )" << patch.obstacles
         << R"(, "fluid": {"max_particles": 100000000, "rest_density_kg_m3": )" << scene.fluid->rest_density
         << R"(, "viscosity_m2_s": )" << scene.fluid->kinematic_viscosity << "}}";
    return text.str();
}

}  // namespace

Patch patch_for(const Scene& scene, WaterKind kind, double depth, double velocity, double spacing) {
    switch (kind) {
        case WaterKind::river:
            return river_patch(depth, velocity);
        case WaterKind::lee:
            if (!scene.obstacles.empty()) return lee_patch(scene, depth, velocity);
            return river_patch(depth, velocity);
        case WaterKind::wet_front:
            return front_patch(depth, velocity, 0.5 * depth >= spacing ? 0.5 * depth : 0);
        case WaterKind::dry_front:
        case WaterKind::inflow:
            break;
    }
    return front_patch(depth, velocity, 0);
}

Scene patch_scene(const Patch& patch, const Scene& scene, const Candidate& candidate, double time) {
    std::vector<SceneOverride> overrides;
    for (const SceneOverride& change : candidate.overrides) {
        if (change.pointer != "/fluid/max_particles") overrides.push_back(change);
    }
    Scene patched = load_scene_text(patch_json(patch, scene, time), "pilot.json", overrides).scene;
    patched.fluid->max_particles = static_cast<int>(particles_needed(patched));
    return patched;
}

}  // namespace wade::fluid::model_choice
