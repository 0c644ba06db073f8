#include "crowd_client/session/frame_time.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"

namespace wade::crowd {
namespace {

double rate_of(const shm::StreamInfo& info) {
    return static_cast<double>(info.ticks_per_second) / static_cast<double>(info.ticks_per_frame);
}

// Up to the rounding of a rate to whole ticks.
bool has_rate_of_scene(const Scene& scene, const shm::StreamInfo& info) {
    return info.ticks_per_frame > 0 && std::abs(rate_of(info) - scene.frame_rate) <= 1e-6 * scene.frame_rate;
}

}  // namespace

double time_of_tick(const shm::StreamInfo& info, std::uint64_t tick) {
    return static_cast<double>(tick) / static_cast<double>(info.ticks_per_second);
}

std::uint64_t steps_due_at(const Scene& scene, const shm::StreamInfo& info, std::uint64_t tick) {
    const std::uint64_t all = steps_of(scene);
    // Also keeps absurd ticks away from the conversion of a number that is too large.
    if (time_of_tick(info, tick) > scene.duration + 2 / scene.frame_rate + 1 / scene.crowd->step_rate) return all;
    if (has_rate_of_scene(scene, info) && tick % info.ticks_per_frame == 0) {
        return std::min(all, step_of_frame(scene, tick / info.ticks_per_frame + 1) - 1);
    }
    return std::min(all, steps_due(scene, tick, info.ticks_per_second));
}

std::string rate_note(const Scene& scene, const shm::StreamInfo& info) {
    if (has_rate_of_scene(scene, info)) return "";
    std::ostringstream note;
    note << "'" << info.producer_name << "' ";
    if (info.ticks_per_frame > 0) {
        note << "sends " << rate_of(info) << " frames a second";
    } else {
        note << "does not say how many frames it sends in a second";
    }
    note << ", the scene has /frame_rate_hz " << scene.frame_rate << "; the crowd keeps to the time of the frames";
    return note.str();
}

}  // namespace wade::crowd
