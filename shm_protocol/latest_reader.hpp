#pragma once
// A reader that runs freely beside the lockstep: it takes the newest complete frame and never holds the producer up.
//
//   LatestReader r(session, "viewer");
//   while (auto frame = r.next()) {   // copies, checked
//       ... use frame->px[i] ...
//   }

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "shm_protocol/stream.hpp"

namespace wade::shm {

class Publisher;

// Takes part in a session in LATEST mode. Calls come from one thread. The spans of a frame are valid until the next
// next() or poll(). A frame that the producer overwrites while it is copied is dropped and a newer one is tried.
class LatestReader {
 public:
    // Joins as Subscriber does (options.follows has no meaning here). stride n >= 1: at most every n-th frame is wanted.
    // Errors: attach_timeout, protocol_violation, interrupted; std::invalid_argument.
    LatestReader(const std::string& session, const std::string& consumer_name, JoinOptions options = {},
                 std::uint32_t stride = 1);

    // The same over the mapping of a producer in this process, which must outlive the reader (for race detectors).
    static LatestReader in_process(Publisher& publisher, const std::string& consumer_name, JoinOptions options = {},
                                   std::uint32_t stride = 1);

    ~LatestReader();
    LatestReader(LatestReader&&) noexcept;
    LatestReader& operator=(LatestReader&&) noexcept;

    [[nodiscard]] const StreamInfo& info() const;

    // Waits for a frame newer than the last one by the stride at least; empty once the stream has ended before one.
    // A frame that was complete when the producer died or gave up is still delivered, then the error comes.
    // Errors: peer_dead, peer_aborted, interrupted; step_timeout, also when every copy was overtaken;
    // protocol_violation as Subscriber::acquire().
    std::optional<Frame> next();

    // The same without waiting: empty if there is no such frame now. Errors: as next(), but for the time-out.
    std::optional<Frame> poll();

    // Whether the producer has ended the stream and nothing newer will come; known after next() or poll() was empty.
    [[nodiscard]] bool ended() const;

    // Frames that passed unseen since the first one taken, beyond those that the stride leaves out.
    [[nodiscard]] std::uint64_t dropped_frames() const;

    // Whether the producer is still there: false once it has died, given up or ended. For a side that pauses; the next
    // call for a frame says what happened.
    [[nodiscard]] bool producer_is_there() const;

    // Goodbye; frames taken stay valid.
    void leave() noexcept;

 private:
    struct State;
    explicit LatestReader(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace wade::shm
