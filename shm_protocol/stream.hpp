#pragma once
// What both sides of a stream of frames have in common.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "shm_protocol/error.hpp"
#include "shm_protocol/layout.hpp"

namespace wade::shm {

// What holds for a whole stream; travels in the header page.
struct StreamInfo {
    std::string producer_name;            // at most 63 bytes, for example "dfsph"
    std::uint32_t capacity = 0;           // particles a frame can hold, at least 1
    std::uint32_t depth = 1;              // frames the producer may be ahead of the slowest acknowledgement, 1 .. slots
    std::uint32_t slots = 0;              // 1 .. 64; 0 = depth + 1, so that a free-running reader finds a stable frame
    std::uint64_t ticks_per_second = 30;  // unit of SlotDescriptor::tick
    std::uint64_t ticks_per_frame = 1;    // see tick_of_frame()
    double metres_per_unit = 1;
    std::array<double, 3> origin{};             // m
    std::array<std::int32_t, 3> axes{1, 2, 3};  // world axis i is the stored axis |axes[i]| - 1, mirrored if negative
    double particle_radius = 0;                 // m, 0 = not given
    double rest_density = 0;                    // kg/m3, 0 = not given
    // Depth-averaged water: each particle is a column on a rectangle round px, pz of this width along world x and z, 0 to 2 m. The column has the depth mass / (rest_density * area), also where a solid cuts the rectangle. 0 = points.
    std::array<double, 2> column_width{};
    std::uint64_t scene_hash = 0;  // 0 = not given
    StreamKind kind = stream_fluid;
    std::uint32_t coupling_lag = 0;  // two-way runs: 0 serial, 1 parallel
    bool impulses = false;           // streams of agents: frames have jx, jz, submerged and spread
    bool hash_frames = true;         // the producer computes the hash chain, so that consumers can compare
    bool group_access = false;       // mode 0660 instead of 0600: open to the group of the producer's process

    std::uint64_t session_id = 0;  // of this run; chosen by the producer, ignored on input

    // World coordinates are the stored ones: metres, x along the stream, y up, z across, no offset.
    [[nodiscard]] bool in_world_coordinates() const {
        return metres_per_unit == 1 && origin == std::array<double, 3>{} &&
               axes == std::array<std::int32_t, 3>{1, 2, 3};
    }
};

// How long a side waits for the other one, and what it does meanwhile. Time during which the whole process was stopped
// (SIGSTOP, a debugger) does not count.
struct Waiting {
    double attach_timeout_s = 10;                       // 0 = never
    double step_warning_s = 5;                          // warn once per wait; 0 = never
    double step_timeout_s = 60;                         // 0 = never, for a debugger
    std::function<bool()> interrupted = {};             // polled every 50 ms and after each signal
    std::function<void(const std::string&)> warn = {};  // gets one full sentence
    std::function<void(double)> paused = {};            // gets the seconds just spent on a peer that pauses
};

// How a consumer joins a session.
struct JoinOptions {
    std::uint64_t scene_hash = 0;  // of the scene that it expects, 0 = any
    Waiting waiting = {};
    StreamKind kind = stream_fluid;
    bool follows = false;       // the stream need not go on for this consumer alone (recorders, loggers)
    bool group_access = false;  // accepts another user's segment that is open to a group of this process
    // Reads all values of each frame: computes the hash chain, compares it with the producer's, and refuses NaN and
    // infinity. Without, Frame::hash is the producer's word, 0 if it gives none.
    bool check_values = true;
};

// A slot to be filled: arrays of `capacity` values, in place in the shared memory, 64-byte aligned.
struct FrameFields {
    std::uint64_t frame = 0;      // from 1 on
    std::span<float> mass;        // kg
    std::span<float> vx, vy, vz;  // m/s times units per metre
    std::span<float> px, py, pz;  // units, see StreamInfo::metres_per_unit

    // Streams of agents only, else empty.
    std::span<float> radius, height;  // units
    std::span<float> state;           // AgentState

    // Streams with StreamInfo::impulses only, else empty.
    std::span<float> jx = {}, jz = {};  // N s of this frame's interval, along the stored x and z
    std::span<float> submerged = {};    // units, how deep the agent stands or floats in the water, 0 = not at all
    std::span<float> spread = {};       // units, radius of the cone over which the impulse is spread
};

// A complete frame: arrays of `count` values, valid until the next call for a frame or Subscriber::release(). In place
// in the shared memory for a Subscriber, copies for a LatestReader.
struct Frame {
    std::uint64_t frame = 0;  // from 1 on
    std::uint64_t tick = 0;
    std::uint32_t count = 0;
    bool final = false;      // no frame follows
    std::uint64_t hash = 0;  // chain over all frames so far
    std::span<const float> mass;
    std::span<const float> vx, vy, vz;
    std::span<const float> px, py, pz;
    std::span<const float> radius, height, state;      // streams of agents only, else empty
    std::span<const float> jx, jz, submerged, spread;  // StreamInfo::impulses only, else empty
    Diagnostics diagnostics;
};

// The tick of frame f unless its producer says otherwise: a fluid frame holds the state at the end of its interval,
// an agents frame the state at the beginning.
constexpr std::uint64_t tick_of_frame(const StreamInfo& info, std::uint64_t frame) {
    return (info.kind == stream_agents ? frame - 1 : frame) * info.ticks_per_frame;
}

// The name of the shared-memory object of a session, "/<session>-fluid" or "/<session>-agents".
// Errors: std::invalid_argument unless the session is 1 to 200 characters of [A-Za-z0-9._-].
std::string segment_name(const std::string& session, StreamKind kind);

}  // namespace wade::shm
