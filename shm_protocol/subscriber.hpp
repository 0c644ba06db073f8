#pragma once
// The consuming end of a stream of frames, in lockstep with its producer: no frame is skipped, none is seen twice.
//
//   Subscriber s(session, "crowd", {.scene_hash = hash});
//   while (auto frame = s.acquire()) {   // in place, read-only, checked
//       ... use frame->px[i] ...
//       s.release();                     // the producer may reuse the slot
//   }

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "shm_protocol/stream.hpp"

namespace wade::shm {

struct SubscriberState;  // shm_protocol/inside/subscriber_state.hpp

class Publisher;

// Takes part in a session. Calls come from one thread. A destructor before the last frame was released and without
// leave() tells the producer that this side gave up. Every Error ends the participation, with its reason told.
class Subscriber {
 public:
    // Joins the session, whether its producer is already there or comes later: absent, unready and stale segments are
    // tried again until the attach timeout. Joining does not wait for the producer's next frame; acquire() does.
    // consumer_name: 1 to 63 bytes.
    // Errors: attach_timeout; protocol_violation for another version, another scene or a damaged header;
    // std::invalid_argument.
    Subscriber(const std::string& session, const std::string& consumer_name, JoinOptions options = {});

    // Joins the session of a producer in the same process over the producer's own mapping (for race detectors, which
    // follow addresses; in all else like the constructor). The publisher must outlive the subscriber.
    static Subscriber in_process(Publisher& publisher, const std::string& consumer_name, JoinOptions options = {});

    // Tells the producer of a session, which may come later, that this consumer will not take part, and why: a producer that
    // waits for its first consumers ends, one that has published a frame goes on undisturbed. The text is cut at 511 bytes.
    // Errors: as the constructor.
    static void refuse(const std::string& session, const std::string& consumer_name, const JoinOptions& options,
                       int reason_code, const std::string& text);

    ~Subscriber();
    Subscriber(Subscriber&&) noexcept;
    Subscriber& operator=(Subscriber&&) noexcept;

    [[nodiscard]] const StreamInfo& info() const;

    // The next frame, empty once the producer has ended the stream and all its frames were released.
    // Frames that were complete when a producer died or gave up are still delivered, then the error comes.
    // Errors: peer_dead, peer_aborted, step_timeout, interrupted; protocol_violation if the frame is not the expected
    // one, holds more particles than fit, does not match its hash or holds a NaN or an infinity.
    std::optional<Frame> acquire();

    // Acknowledges the frame of acquire(); its spans must not be used any more.
    // Errors: protocol_violation if the producer overwrote the frame while it was held.
    void release();

    // A sign of life during a long computation; acquire, release and every wait give one too.
    void heartbeat() noexcept;

    // Tells the producer that this side pauses on purpose, so that it does not count the time until it goes on.
    void set_paused(bool paused) noexcept;

    // Whether the producer is still there: false once it has died, given up or ended. For a side that pauses; the next
    // call for a frame says what happened.
    [[nodiscard]] bool producer_is_there() const;

    // A clean goodbye before the end: the producer goes on without this consumer.
    void leave() noexcept;

    // Gives up and tells the producer why; the text is cut at 511 bytes.
    void abort(int reason_code, std::string_view text) noexcept;

    [[nodiscard]] std::uint64_t released_frame() const;  // the last one, 0 = none

 private:
    explicit Subscriber(std::unique_ptr<SubscriberState> state);
    std::unique_ptr<SubscriberState> state_;
};

}  // namespace wade::shm
