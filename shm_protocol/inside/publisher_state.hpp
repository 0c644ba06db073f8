#pragma once
// The insides of a Publisher; shared with Subscriber::in_process only.

#include <array>
#include <boost/interprocess/mapped_region.hpp>
#include <cstdint>
#include <limits>
#include <string>

#include "shm_protocol/inside/pages.hpp"
#include "shm_protocol/inside/segment.hpp"
#include "shm_protocol/inside/wait.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::shm {

struct PublisherState {
    // What the consumers in lockstep allow.
    struct Census {
        int joined = 0;  // admitted and not gone
        int active = 0;  // joined but not followers: the stream goes on for these
        std::uint64_t slowest = std::numeric_limits<std::uint64_t>::max();  // last frame that all acknowledged
    };

    PublisherState(const std::string& session, const StreamInfo& info, Waiting how);

    // Reads all consumer entries. Consumers that ask to join are admitted at frame `admit_at` (0: none is).
    // Errors: peer_aborted; protocol_violation, also if a process has written into another's page.
    Census survey(std::uint64_t admit_at);

    // Errors: peer_dead if a consumer's process has ended without a goodbye and still owes frame `owed` or one before.
    void check_alive(std::uint64_t owed);

    // Whether a consumer in lockstep is left, and none that was admitted has died or given up.
    [[nodiscard]] bool consumers_are_there() const;

    void ring();  // tells the consumers that something has changed
    void enter(ProducerState next);
    void wait(const WaitTask& task) const;
    void end(ProducerState last) noexcept;

    // A consumer's words at its admission; later values are read only for comparison.
    struct Member {
        std::uint64_t admitted = 0;  // at this frame; 0 = no member
        std::uint32_t mode = mode_lockstep;
        std::uint32_t flags = 0;
        [[nodiscard]] bool in_lockstep() const { return admitted != 0 && mode == mode_lockstep; }
        [[nodiscard]] bool follows() const { return (flags & consumer_follows) != 0; }
    };

    void admit(std::uint32_t consumer, std::uint64_t at);
    void dismiss(std::uint32_t consumer);
    // Errors: protocol_violation unless the state, mode and flags of a member in lockstep are those of one.
    void check_words(std::uint32_t consumer, std::uint32_t consumer_state) const;
    // Errors: protocol_violation unless the control page holds what this side has written.
    void check_own_page() const;

    [[nodiscard]] bool counts(std::uint32_t consumer) const;  // it is in lockstep, admitted and not gone
    // It has said its goodbye and released its lock; the state alone may come from any process.
    [[nodiscard]] bool has_left(std::uint32_t consumer, std::uint32_t consumer_state) const;
    [[nodiscard]] std::string label(std::uint32_t consumer) const;
    [[nodiscard]] std::string everybody_behind(std::uint64_t frame) const;
    [[nodiscard]] bool waits_for_paused(std::uint64_t frame) const;  // a consumer that owes `frame` pauses on purpose

    std::string session;
    std::string name;  // of the shared-memory object
    Waiting waiting;
    SegmentMap map;
    SegmentFile file;
    boost::interprocess::mapped_region region;
    Pages<std::byte> pages;

    std::array<Member, max_consumers> members{};
    ProducerState state = producer_ready;  // as written into the control page
    bool had_lockstep = false;             // there was a lockstep consumer, followers excluded
    bool refusals_count = false;           // during wait_for_consumers()
    bool hash_frames = true;
    bool frame_open = false;
    bool sent_final = false;  // no frame may follow
    bool ended = false;
    std::uint64_t published = 0;
    std::uint64_t chain = 0;
    std::uint64_t last_tick = 0;  // of frame `published`
    int reason_code = static_cast<int>(Failure::peer_aborted);
    std::string reason = "It ended without closing the stream.";
};

}  // namespace wade::shm
