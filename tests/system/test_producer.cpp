// test_producer SCENE.json [...]: a producer of exactly known frames that can misbehave on request.
//
// Particles stand on a square grid over the scene's channel and all have the velocity (-v_F, 0, 0), frame after frame:
// the grid does not move, so that a test can count by hand which particles touch an agent. Pitch and mass are
// powers of two, so that the grid is exact in 32-bit floats.

#include <unistd.h>

#include <cmath>
#include <exception>
#include <iostream>
#include <limits>

#include "configs/program/command_line.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/program.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/scene_frames.hpp"
#include "shm_protocol/publisher.hpp"

namespace {

using namespace wade;

constexpr double pitch = 0.125;       // m
constexpr double particle_mass = 16;  // kg
constexpr double height = 0.5;        // m, of all particles

std::uint32_t columns(const Interval& along) {
    return static_cast<std::uint32_t>(std::lround(along.length() / pitch));
}

std::uint32_t fill(const shm::FrameFields& slot, const Channel& channel) {
    std::uint32_t n = 0;
    for (std::uint32_t i = 0; i < columns(channel.x); ++i) {
        for (std::uint32_t j = 0; j < columns(channel.z); ++j, ++n) {
            slot.mass[n] = static_cast<float>(particle_mass);
            slot.vx[n] = static_cast<float>(-channel.velocity);
            slot.vy[n] = 0;
            slot.vz[n] = 0;
            slot.px[n] = static_cast<float>(channel.x.lo + (i + 0.5) * pitch);
            slot.py[n] = static_cast<float>(height);
            slot.pz[n] = static_cast<float>(channel.z.lo + (j + 0.5) * pitch);
        }
    }
    return n;
}

shm::StreamInfo stream_info(const ProgramStart& start) {
    const Scene& scene = start.loaded.scene;
    shm::StreamInfo info;
    info.producer_name = "test_producer";
    info.capacity = columns(scene.channel->x) * columns(scene.channel->z);
    info.depth = static_cast<std::uint32_t>(scene.lockstep_depth);
    info.ticks_per_second = static_cast<std::uint64_t>(std::lround(scene.frame_rate));
    info.scene_hash = start.options.has("--other-scene") ? ~scene.hash : scene.hash;
    return info;
}

// Alive, with a heartbeat, but without another frame, until the consumer gives up.
void stay_silent(shm::Publisher& publisher) {
    while (received_signal() == 0) {
        publisher.heartbeat();
        ::usleep(20'000);
    }
}

void produce(const ProgramStart& start, Console& console) {
    const Scene& scene = start.loaded.scene;
    shm::Publisher publisher(start.options.session, stream_info(start),
                             waiting_of<shm::Waiting>(start.options, console));
    publisher.wait_for_consumers(1);
    const std::uint64_t frames = frames_of(scene);
    const auto nan_at = static_cast<std::uint64_t>(start.options.extra("--nan-at-frame"));
    const auto silent_after = static_cast<std::uint64_t>(start.options.extra("--silent-after-frame"));
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
        const auto slot = publisher.begin_frame();
        if (!slot) break;
        const std::uint32_t count = fill(*slot, scene.channel);
        if (frame == nan_at) slot->vx[count / 2] = std::numeric_limits<float>::quiet_NaN();
        publisher.end_frame(count, {}, frame == frames);
        if (frame == silent_after) return stay_silent(publisher);
    }
    publisher.close();
}

}  // namespace

int main(int argc, char** argv) {
    Console console("test_producer");
    try {
        const ProgramDescription program{
            "test_producer",
            "Sends particles at rest on a grid that claim to move with the stream.",
            {{"--nan-at-frame", "Frame with a velocity that is no number; 0: none", NumberRange{0, 1e6}, 0},
             {"--silent-after-frame", "Send nothing more after this frame; 0: never", NumberRange{0, 1e6}, 0},
             {"--other-scene", "Claim to play another scene"}}};
        const ProgramStart start = start_program(program, argc, argv);
        if (start.answer) {
            std::cout << *start.answer;
            return 0;
        }
        catch_signals();
        produce(start, console);
        return 0;
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of<shm::Error>(error);
    }
}
