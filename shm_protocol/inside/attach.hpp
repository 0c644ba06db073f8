#pragma once
// How a consumer finds its producer's segment and takes one of the consumer entries.

#include <cstddef>
#include <cstdint>
#include <string>

#include "shm_protocol/inside/link.hpp"

namespace wade::shm {

struct AttachRequest {
    std::string session;
    std::string consumer_name;
    JoinOptions options;
    ConsumerMode mode = mode_lockstep;
    std::uint32_t stride = 1;
    std::byte* shared_base = nullptr;  // mapping of a producer in this process; null = map the segment
};

// Tries until the attach timeout.
// Errors: attach_timeout with what was found last, protocol_violation, interrupted.
Link attach(const AttachRequest& request);

}  // namespace wade::shm
