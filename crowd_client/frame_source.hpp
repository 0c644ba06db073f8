#pragma once
// Where the water's frames come from: shared memory in a run, made-up frames in a test.

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
    // The next frame, valid until release(); empty once the producer has ended the stream. May throw shm::Error.
    [[nodiscard]] virtual std::optional<shm::Frame> acquire() = 0;
    virtual void release() = 0;
    // Clean goodbye before the end of the stream.
    virtual void leave() noexcept = 0;
    // Tells the producer why this side gives up.
    virtual void abort(int reason_code, std::string_view text) noexcept = 0;
};

// Joins a session of the shared-memory protocol as the consumer "crowd". Throws shm::Error, and
// RunError (protocol violation) if the stream's frames are not as long as the scene's.
[[nodiscard]] std::unique_ptr<FrameSource> join_session(const std::string& session, std::uint64_t scene_hash,
                                                        double frame_rate, shm::Waiting waiting);

}  // namespace wade::crowd
