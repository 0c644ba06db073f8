#include "fluid_server/model_choice/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "configs/exit_code.hpp"
#include "configs/scene_capacity.hpp"
#include "configs/scene_checks.hpp"
#include "configs/scene_frames.hpp"
#include "fluid_server/fluid_model.hpp"

namespace wade::fluid::model_choice {

namespace {

constexpr double table_time = 10;            // s, about as long as the runs of the table
constexpr double longest = 4, shortest = 1;  // s, of a pilot

// The patch: a channel whose banks are z = 1 and z = 1 + width.
struct Patch {
    double depth = 0, velocity = 0, length = 0, width = 0;
    std::string channel, obstacles;  // JSON
    std::vector<Probe> probes;
};

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

std::string patch_json(const Patch& patch, const Scene& scene, double time) {
    std::ostringstream text;
    const bool closed = patch.channel.find("closed") != std::string::npos;
    text << R"({"name": "pilot", "duration_s": )" << time << R"(, "frame_rate_hz": )" << scene.frame_rate
         << R"(, "world": {"length_m": )" << patch.length << R"(, "width_m": )" << patch.width + 2
         << R"(, "gravity_m_s2": )" << scene.world.gravity << R"(}, "channel": {"x_min_m": 0, "x_max_m": )"
         << patch.length << R"(, "z_min_m": 1, "z_max_m": )" << 1 + patch.width << ", " << patch.channel;
    if (!closed) text << R"(, "depth_m": )" << patch.depth << R"(, "velocity_m_s": )" << patch.velocity;
    text << R"(}, "obstacles": )" << patch.obstacles
         << R"(, "fluid": {"max_particles": 100000000, "rest_density_kg_m3": )" << scene.fluid.rest_density
         << R"(, "viscosity_m2_s": )" << scene.fluid.kinematic_viscosity << "}}";
    return text.str();
}

Scene patch_scene(const Patch& patch, const Scene& scene, const Candidate& candidate, double time) {
    std::vector<SceneOverride> overrides;
    for (const SceneOverride& change : candidate.overrides) {
        if (change.pointer != "/fluid/max_particles") overrides.push_back(change);
    }
    Scene patched = load_scene_text(patch_json(patch, scene, time), "pilot.json", overrides).scene;
    patched.fluid.max_particles = static_cast<int>(particles_needed(patched));
    return patched;
}

struct ProbeImpulse {
    double x = 0, z = 0, load = 0;  // kg m
};

struct PatchRun {
    std::vector<ProbeImpulse> impulses;
    double steps = 0, particle_steps = 0;
};

class Frame {
 public:
    explicit Frame(std::uint32_t capacity) {
        for (std::vector<float>* v : {&mass_, &vx_, &vy_, &vz_, &px_, &py_, &pz_}) v->resize(capacity);
    }
    std::size_t take(const FluidModel& model, std::uint64_t frame) {
        shm::FrameFields slot;
        slot.frame = frame;
        slot.mass = mass_;
        slot.vx = vx_, slot.vy = vy_, slot.vz = vz_;
        slot.px = px_, slot.py = py_, slot.pz = pz_;
        return count_ = model.write_frame(slot);
    }
    // Adds the momentum of all that is closer than `distance`, Eq. 5, over dt.
    void add_to(ProbeImpulse& impulse, const Probe& probe, double distance, double dt) const {
        double x = 0, z = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const double dx = static_cast<double>(px_[i]) - probe.x, dz = static_cast<double>(pz_[i]) - probe.z;
            if (dx * dx + dz * dz >= distance * distance) continue;
            x += static_cast<double>(mass_[i]) * static_cast<double>(vx_[i]);
            z += static_cast<double>(mass_[i]) * static_cast<double>(vz_[i]);
        }
        impulse.x += x * dt;
        impulse.z += z * dt;
        impulse.load += std::hypot(x, z) * dt;
    }

 private:
    std::vector<float> mass_, vx_, vy_, vz_, px_, py_, pz_;
    std::size_t count_ = 0;
};

PatchRun run_patch(const Scene& scene, const Patch& patch, double contact) {
    const std::unique_ptr<FluidModel> model = make_fluid_model(scene);
    Frame frame(model->capacity());
    PatchRun run;
    run.impulses.resize(patch.probes.size());
    constexpr std::uint64_t ticks = 1000000;
    const auto per_second = static_cast<std::uint64_t>(std::llround(scene.frame_rate * static_cast<double>(ticks)));
    for (std::uint64_t k = 1; k <= frames_of(scene); ++k) {
        const shm::Diagnostics d = model->advance_frame({(k - 1) * ticks, k * ticks, per_second});
        const std::size_t count = frame.take(*model, k);
        run.steps += d.sub_steps;
        run.particle_steps += static_cast<double>(d.sub_steps) * static_cast<double>(count);
        for (std::size_t p = 0; p < patch.probes.size(); ++p) {
            frame.add_to(run.impulses[p], patch.probes[p], contact, 1 / scene.frame_rate);
        }
    }
    return run;
}

double median_difference(const PatchRun& a, const PatchRun& b) {
    std::vector<double> differences;
    for (std::size_t p = 0; p < a.impulses.size(); ++p) {
        const ProbeImpulse &i = a.impulses[p], &j = b.impulses[p];
        if (j.load > 0) differences.push_back(std::hypot(i.x - j.x, i.z - j.z) / j.load);
    }
    if (differences.empty()) return 0;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    return *middle;
}

}  // namespace

std::optional<PilotResult> run_pilot(const LoadedScene& written, const SceneWater& water,
                                     const std::optional<Meeting>& meeting, const Candidate& chosen,
                                     const Candidate& better, double demand, double budget, std::string& why) {
    const Scene& scene = written.scene;
    const bool met = meeting && meeting->wet > 0;
    const double coarser = std::max(chosen.spacing, better.spacing);
    const double depth = std::max(met ? meeting->depth : water.depth, 1.5 * coarser);
    const double velocity = met ? meeting->speed : water.velocity;
    const Patch patch = patch_for(scene, chosen.worst, depth, velocity, coarser);
    try {
        const auto cost_of = [&](const Candidate& c) {
            const auto particles = static_cast<double>(particles_needed(patch_scene(patch, scene, c, longest)));
            return particles * c.steps_per_s * c.step_cost;
        };
        const double time = std::min(longest, budget / (cost_of(chosen) + cost_of(better)));
        if (time < shortest) {
            why = "a second of it would cost more than its share";
            return std::nullopt;
        }
        const double contact = contact_distance(scene.coupling);
        const PatchRun first = run_patch(patch_scene(patch, scene, chosen, time), patch, contact);
        const PatchRun second = run_patch(patch_scene(patch, scene, better, time), patch, contact);
        PilotResult result;
        result.time = time;
        result.difference = median_difference(first, second);
        result.allowed = (demand + better.median) * std::sqrt(table_time / time);
        result.particle_steps = first.particle_steps + second.particle_steps;
        result.cost = first.particle_steps * chosen.step_cost + second.particle_steps * better.step_cost;
        result.steps_per_s = first.steps / time;
        return result;
    } catch (const ConfigurationError& error) {
        why = std::string("its patch of water cannot be run: ") + error.what();
        return std::nullopt;
    }
}

}  // namespace wade::fluid::model_choice
