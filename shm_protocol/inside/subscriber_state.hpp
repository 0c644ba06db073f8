#pragma once
// The insides of a Subscriber.

#include <cstdint>
#include <optional>
#include <string_view>

#include "shm_protocol/inside/attach.hpp"
#include "shm_protocol/inside/frame_check.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::shm {

struct SubscriberState {
    SubscriberState(Link joined, const JoinOptions& options);

    // Waits for frame `next`; false if the stream has ended before it. Errors: those of Subscriber::acquire().
    bool wait_for_next();

    // Looks whether frame `next` is there or will never be.
    enum class Outlook { open, complete, ended };
    Outlook look();

    // The complete frame `next`, checked. Errors: protocol_violation.
    Frame check_frame();

    void say_goodbye(ConsumerState last, int reason_code, std::string_view text) noexcept;
    void finish() noexcept;  // the goodbye of a destructor

    Link link;
    Waiting waiting;
    std::uint64_t next = 0;  // frame to be acquired; 0 = not admitted yet
    std::uint64_t held = 0;  // between acquire and release
    std::uint64_t released = 0;
    FrameHistory history;
    std::optional<Error> failure;  // final: it comes again with every further call for a frame
    bool held_is_final = false;
    bool over = false;  // no frame will come any more
};

}  // namespace wade::shm
