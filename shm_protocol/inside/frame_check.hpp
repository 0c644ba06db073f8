#pragma once
// What a reader demands of a frame before its caller gets it.

#include <cstdint>
#include <optional>
#include <span>

#include "shm_protocol/inside/hash.hpp"
#include "shm_protocol/inside/header.hpp"
#include "shm_protocol/layout.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::shm {

// What a reader knows about the frames before this one.
struct FrameHistory {
    bool check_values = true;                // JoinOptions
    std::uint64_t chain = 0;                 // over all frames before
    std::optional<std::uint64_t> last_tick;  // of the last frame that this reader saw
};

// Errors: protocol_violation if frame `frame` holds more particles than fit.
void check_count(const StreamInfo& info, std::uint64_t frame, std::uint32_t count);

// Judges frame `frame`, given a private copy of its descriptor and its required fields, each of descriptor.count values,
// in place or copied; brings `history` up to date. Errors: protocol_violation if its tick does not increase, if it does
// not match its hash, or if it holds a NaN or an infinity.
Frame checked_frame(const StreamInfo& info, std::uint64_t frame, const SlotDescriptor& descriptor, FieldSpans fields,
                    FrameHistory& history);

}  // namespace wade::shm
