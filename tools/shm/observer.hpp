#pragma once
// Inspects a segment from outside: joins nothing, maps read-only and takes no lock, so that it disturbs no participant.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shm_protocol/inside/header.hpp"
#include "shm_protocol/stream.hpp"

namespace wade {

enum class Condition {
    absent,      // there is no such segment
    foreign,     // the name leads to something that is no plain file
    closed_off,  // it cannot be opened: another user's
    unfinished,  // its header is not there yet
    refused,     // its header breaks the contract
    readable
};

constexpr bool was_opened(Condition condition) {
    return condition >= Condition::unfinished;
}

struct ConsumerView {
    std::uint32_t index = 0;
    std::string name;
    std::uint32_t pid = 0;
    bool alive = false;  // holds its lock
    std::uint32_t state = 0, mode = 0, stride = 0;
    bool follows = false, waiting = false, paused = false;
    std::uint64_t admitted_frame = 0;      // 0 = not yet
    std::uint64_t acknowledged_frame = 0;  // LATEST mode: the last one taken
    std::uint64_t dropped_frames = 0;
    double silent_s = 0;  // since its last sign of life
    std::string reason;   // of a consumer that aborted or refused
};

struct SegmentView {
    std::string name;  // "/run1-fluid"
    Condition condition = Condition::absent;
    std::string problem;  // a sentence, unless readable
    std::uint32_t owner = 0, mode = 0;
    std::uint64_t bytes = 0;
    bool producer_alive = false;  // holds its lock
    std::int64_t at_ns = 0;       // CLOCK_MONOTONIC of this look

    // The rest only of a readable segment.
    std::uint32_t version_major = 0, version_minor = 0;
    shm::StreamInfo info;
    std::uint32_t state = 0, pid = 0;
    bool waiting = false, paused = false;
    std::uint64_t published_frame = 0;
    double silent_s = 0;
    std::int32_t reason_code = 0;
    std::string reason;                       // of a producer that aborted
    std::optional<shm::SlotDescriptor> last;  // of the newest frame; none: not published, or overwritten just now
    std::vector<ConsumerView> consumers;      // one for each entry that was ever used
};

// Looks once; what the producer does meanwhile may show in one value and not yet in another.
[[nodiscard]] SegmentView look_at(const std::string& name);

// All names in /dev/shm that a stream could have, "/run1-agents", sorted.
[[nodiscard]] std::vector<std::string> segment_names();

// Returns how many frames a consumer in lockstep is behind the last published one.
[[nodiscard]] std::uint64_t frames_behind(const SegmentView& segment, const ConsumerView& consumer);

// Frames per second of wall time between two looks; none if they saw different runs or no time passed.
[[nodiscard]] std::optional<double> frame_rate(const SegmentView& before, const SegmentView& now);

// Simulated seconds per second of wall time at this rate of frames.
[[nodiscard]] double times_real_time(const shm::StreamInfo& info, double frames_per_s);

[[nodiscard]] const char* word_for(Condition condition);
[[nodiscard]] std::string producer_state_word(std::uint32_t state);
[[nodiscard]] std::string consumer_state_word(std::uint32_t state);

struct Sample {
    SegmentView segment;
    std::optional<double> frames_per_s;
};

// For people, several lines, and for scripts, one JSON array.
[[nodiscard]] std::string text_of(const Sample& sample);
[[nodiscard]] std::string json_of(const std::vector<Sample>& samples, bool pretty);

}  // namespace wade
