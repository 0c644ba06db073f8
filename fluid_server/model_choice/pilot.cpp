#include "fluid_server/model_choice/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/portable.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/scene_frames.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/model_choice/patch.hpp"

namespace wade::fluid::model_choice {

namespace {

constexpr double table_time = 10;            // s, about as long as the runs of the table
constexpr double longest = 4, shortest = 1;  // s, of a pilot

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
        impulse.load += length_of(x, z) * dt;
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
        if (j.load > 0) differences.push_back(length_of(i.x - j.x, i.z - j.z) / j.load);
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
