#pragma once
// The arrays of a frame as the bytes of a record, and back.

#include <cstddef>
#include <span>
#include <vector>

#include "shm_protocol/stream.hpp"
#include "tools/shm/recording_format.hpp"

namespace wade::recording {

// The required fields of a stream of this kind, in their order.
std::vector<std::span<const float>> fields_of(const shm::Frame& frame, shm::StreamKind kind);
std::vector<std::span<float>> fields_of(const shm::FrameFields& slot, shm::StreamKind kind);

// Appends the payload to `out` and tells how it is encoded. level 0 stores, 1 to 19 compress, faster to smaller.
PayloadEncoding append_payload(std::span<const std::span<const float>> fields, int level, std::vector<std::byte>& out);

// The largest payload of `values` floats.
std::size_t largest_payload(PayloadEncoding encoding, std::size_t values);

// Fills the fields, all of one length. False if the payload does not hold exactly that many values.
bool decode_payload(std::span<const std::byte> payload, PayloadEncoding encoding,
                    std::span<const std::span<float>> fields);

}  // namespace wade::recording
