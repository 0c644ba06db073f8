#pragma once
// What a reader demands of a frame before its caller gets it.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/header.hpp"
#include "shm_protocol/layout.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::shm {

// How long a frame of the water may last in simulated time (agents have the ticks of their water): the tick of frame f + n is at most n times `longest_in_frames` frame times
// (Header::ticks_per_frame) above the one of frame f, and at least one `shortest_in_frames`-th of one unless it is final.
inline constexpr std::uint64_t longest_in_frames = 8;
inline constexpr std::uint64_t shortest_in_frames = 1000;
inline constexpr std::uint64_t largest_first_tick = std::uint64_t{1} << 53;  // a double holds all numbers up to it

struct FrameTick {
    std::uint64_t frame = 0;
    std::uint64_t tick = 0;
};

// What is wrong with the tick of a frame, as the end of a sentence; empty if it may follow `last` (none: any frame may be
// the first one of a reader).
std::string tick_fault(const StreamInfo& info, FrameTick now, bool final, const std::optional<FrameTick>& last);

// CRC-32C of a descriptor from `frame` to its end with the word crc32c taken as 0; not of `sequence`, which says only
// whether the rest is complete.
std::uint32_t descriptor_crc(const SlotDescriptor& descriptor);

// What a reader knows about the frames before this one.
struct FrameHistory {
    bool check_values = true;       // JoinOptions
    bool check_descriptor = false;  // SegmentMap::descriptors_have_checks
    bool check_further = false;     // SegmentMap::has_further_hash
    std::uint64_t chain = 0;        // over all frames before
    std::optional<FrameTick> last;  // the last frame that this reader saw
};

// To be called before `fields` can be named: nothing is believed of a descriptor before.
// Errors: protocol_violation if frame `frame` holds more particles than fit, or its descriptor is damaged.
void check_descriptor(const StreamInfo& info, std::uint64_t frame, const SlotDescriptor& descriptor,
                      const FrameHistory& history);

// Judges frame `frame`, given a private copy of its descriptor and its fields (header.hpp: fields_of), each of descriptor.count values,
// in place or copied; brings `history` up to date. Errors: protocol_violation if its tick may not follow the one before,
// if it does not match its hash, or if it holds a NaN, an infinity or a mass that is not above 0.
Frame checked_frame(const StreamInfo& info, std::uint64_t frame, const SlotDescriptor& descriptor, FieldSpans fields,
                    FrameHistory& history);

}  // namespace wade::shm
