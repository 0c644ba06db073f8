#pragma once
// A joined segment as its consumer sees it.

#include <boost/interprocess/mapped_region.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "shm_protocol/inside/pages.hpp"
#include "shm_protocol/inside/segment.hpp"
#include "shm_protocol/inside/wait.hpp"

namespace wade::shm {

// All of the segment is mapped read-only, the doorbell and the consumer's own page writable.
struct Link {
    SegmentFile file;  // holds the consumer's lock
    std::unique_ptr<SegmentMap> map;
    boost::interprocess::mapped_region all, doorbell_page, entry_page;
    Pages<const std::byte> pages;
    Doorbell* doorbell = nullptr;
    ConsumerEntry* entry = nullptr;
    std::uint32_t index = 0;
    std::uint32_t producer_pid = 0;
    ConsumerMode mode = mode_lockstep;  // what this consumer wrote into its entry
    std::uint32_t flags = 0;
    bool gone = false;  // the goodbye was said

    void ring() const;  // tells the producer that something has changed
    void heartbeat() const noexcept;
    void set_paused(bool paused) const noexcept;
    // Frees the entry, which holds a goodbye, for another consumer from the next frame on.
    void lay_to_rest() const noexcept;
    void say_goodbye(ConsumerState last, int reason_code, std::string_view text) noexcept;
    // Errors: protocol_violation if another process has written into this consumer's entry.
    void check_entry(std::uint64_t acknowledged) const;

    [[nodiscard]] bool producer_lives() const;
    [[nodiscard]] std::string producer() const;      // "Producer 'dfsph' (process 123)"
    [[nodiscard]] std::string next_frame() const;    // "frame 8 of producer 'dfsph' (process 123, alive, ...)"
    [[nodiscard]] Error producer_gave_up() const;    // peer_aborted, with its reason
    [[nodiscard]] Error producer_died() const;       // peer_dead
    [[nodiscard]] Error ended_before_entry() const;  // attach_timeout
    [[nodiscard]] Sleep bed() const;                 // what this consumer sleeps on
};

}  // namespace wade::shm
