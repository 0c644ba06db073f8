#pragma once
// The producing end of a stream of frames.
//
//   Publisher p(session, info);         producer      consumer
//   p.wait_for_consumers(1);               |  <- join ----  |
//   while (auto f = p.begin_frame()) {     |  - frame 1 ->  |   acquire()
//       ... write f->px[i] in place ...    |                |   ... read in place ...
//       p.end_frame(count, diagnostics);   |  <- ack 1 ---  |   release()
//   }                                      |  - final --->  |
//   p.close();                             |  <- ack n ---  |

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "shm_protocol/stream.hpp"

namespace wade::shm {

struct PublisherState;  // shm_protocol/inside/publisher_state.hpp

// Owns the segment of a session. Calls come from one thread, in the order of the picture. A destructor without close()
// marks the stream as aborted. Every Error ends the stream: the consumers learn the reason when the object goes.
class Publisher {
 public:
    // Creates the segment; replaces the segment of a dead producer.
    // Errors: name_in_use if its producer is alive or it belongs to another user; std::invalid_argument for a value
    // out of range; std::system_error, for example when /dev/shm is full.
    Publisher(const std::string& session, StreamInfo info, Waiting waiting = {});
    ~Publisher();
    Publisher(Publisher&&) noexcept;
    Publisher& operator=(Publisher&&) noexcept;

    [[nodiscard]] const StreamInfo& info() const;

    // Waits until n consumers in lockstep have joined, at least one of them no follower; they take part from the next
    // frame on. Only before frame 1.
    // Errors: attach_timeout; peer_dead; peer_aborted, also when a consumer refused the stream (another scene).
    void wait_for_consumers(int n = 1);

    // The slot of the next frame, once every consumer in lockstep has acknowledged the frame `depth` before it.
    // Empty when all consumers in lockstep but followers have left cleanly. Consumers that ask to join take part from this frame on.
    // Errors: peer_dead, peer_aborted, step_timeout, protocol_violation, interrupted.
    std::optional<FrameFields> begin_frame();

    // Publishes the slot of begin_frame(). Without a tick it has the one of tick_of_frame().
    // Errors: std::invalid_argument if count exceeds the capacity or the tick does not increase, by a thousandth of
    // ticks_per_frame at least (but for the final frame) and 8 times ticks_per_frame at most (streams of agents: by any).
    void end_frame(std::uint32_t count, const Diagnostics& diagnostics = {}, bool final = false,
                   std::optional<std::uint64_t> tick = std::nullopt);

    // A sign of life during a long computation; begin_frame, end_frame and every wait give one too.
    void heartbeat() noexcept;

    // Tells consumers that this side pauses on purpose, so that they do not count the time until it goes on.
    void set_paused(bool paused) noexcept;

    // Waits until every consumer in lockstep has acknowledged the last frame or left, then removes the segment.
    // Errors: as begin_frame().
    void close();

    // Ends the stream at once and tells the consumers why; the text is cut at 511 bytes.
    void abort(int reason_code, std::string_view text) noexcept;

    // Whether all goes well on the other side: false once a consumer in lockstep has died or given up, or all have left. For
    // a side that pauses or waits elsewhere; check_consumers() says what happened.
    [[nodiscard]] bool consumers_are_there() const;

    // Looks at every consumer in lockstep, whether it owes a frame or not; false if all have left.
    // Errors: peer_dead, peer_aborted, protocol_violation.
    bool check_consumers();

    [[nodiscard]] std::uint64_t published_frames() const;
    [[nodiscard]] std::uint64_t frame_hash() const;  // chain over the published frames, 0 without hash_frames

 private:
    friend class Subscriber;  // in_process() of both shares the mapping
    friend class LatestReader;
    std::unique_ptr<PublisherState> state_;
};

}  // namespace wade::shm
