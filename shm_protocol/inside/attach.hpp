#pragma once
// How a consumer finds its producer's segment and takes one of the consumer entries.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "shm_protocol/inside/link.hpp"

namespace wade::shm {

// Why a consumer does not take part.
struct Refusal {
    int reason_code = 0;
    std::string text;
};

struct AttachRequest {
    std::string session;
    std::string consumer_name;
    JoinOptions options;
    ConsumerMode mode = mode_lockstep;
    std::uint32_t stride = 1;
    std::byte* shared_base = nullptr;               // mapping of a producer in this process; null = map the segment
    std::optional<Refusal> refusal = std::nullopt;  // takes an entry to say so, instead of joining
};

// Tries until the attach timeout.
// Errors: attach_timeout with what was found last, protocol_violation, interrupted.
Link attach(const AttachRequest& request);

}  // namespace wade::shm
