#pragma once
// Where the water's frames come from: shared memory in a run, made-up frames in a test.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "shm_protocol/stream.hpp"

namespace wade::crowd {

//   acquire -> (use the frame in place) -> release -> acquire -> ... -> leave | abort | empty frame
class FrameSource {
 public:
    FrameSource() = default;
    FrameSource(const FrameSource&) = delete;
    FrameSource& operator=(const FrameSource&) = delete;
    virtual ~FrameSource() = default;

    [[nodiscard]] virtual const shm::StreamInfo& info() const = 0;
    // Returns whether each frame comes, in order; else only the newest frame at each acquire().
    [[nodiscard]] virtual bool in_lockstep() const { return true; }
    // The next frame, valid until release(); empty once the producer has ended the stream. May throw shm::Error.
    [[nodiscard]] virtual std::optional<shm::Frame> acquire() = 0;
    virtual void release() = 0;
    // Returns the number of frames that were not seen.
    [[nodiscard]] virtual std::uint64_t dropped_frames() const { return 0; }
    // Whether this side pauses on purpose, so that the producer need not count the time.
    virtual void set_paused(bool) noexcept {}
    // Returns whether frames may still come; acquire() says what happened if not.
    [[nodiscard]] virtual bool producer_is_there() const { return true; }
    // Clean goodbye before the end of the stream.
    virtual void leave() noexcept = 0;
    // Tells the producer why this side gives up.
    virtual void abort(int reason_code, std::string_view text) noexcept = 0;
};

enum class FrameMode { lockstep, latest };

// Joins a session of the shared-memory protocol as the consumer "crowd", for every frame or for the latest ones.
// Throws shm::Error.
[[nodiscard]] std::unique_ptr<FrameSource> join_session(const std::string& session, std::uint64_t scene_hash,
                                                        FrameMode mode, shm::Waiting waiting);

}  // namespace wade::crowd
