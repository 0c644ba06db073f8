#pragma once
// How a consumer finds its producer's segment and takes one of the consumer entries.

#include <boost/interprocess/mapped_region.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "shm_protocol/pages.hpp"
#include "shm_protocol/segment.hpp"

namespace wade::shm {

struct AttachRequest {
    std::string session;
    StreamKind kind;
    std::string consumer_name;
    std::uint64_t scene_hash;  // 0 = any
    std::byte* shared_base;    // mapping of a producer in this process; null = map the segment
};

// A joined segment: all of it read-only, the doorbell and the consumer's own page writable.
struct Link {
    SegmentFile file;  // holds the consumer's lock
    std::unique_ptr<SegmentMap> map;
    boost::interprocess::mapped_region all, doorbell_page, entry_page;
    Pages<const std::byte> pages;
    Doorbell* doorbell = nullptr;
    ConsumerEntry* entry = nullptr;
    std::uint32_t index = 0;
    std::uint32_t producer_pid = 0;

    void ring() const;  // tells the producer that something has changed
};

// Tries until the attach timeout.
// Errors: attach_timeout with what was found last, protocol_violation, interrupted.
Link attach(const AttachRequest& request, const Waiting& waiting);

}  // namespace wade::shm
