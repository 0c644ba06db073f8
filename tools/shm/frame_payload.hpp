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

// Rounds the fields of water in a box to what a quantised payload holds, appends it to `out`, and tells how many
// velocities were beyond its range, 32767 velocity steps, and cut to it. level: 1 to 19.
std::size_t append_quantised(std::span<const std::span<float>> fields, const Thinning& thinning, int level,
                             std::vector<std::byte>& out);

// What velocity_step_m_s and position_error_m are for particles in the box of a thinning.
inline constexpr float velocity_step = 1.0F / 512;
float position_error(const Thinning& thinning);

// The largest payload of `values` floats.
std::size_t largest_payload(PayloadEncoding encoding, std::size_t values);

// Fills the fields, all of one length. False if the payload does not hold exactly that many values.
bool decode_payload(std::span<const std::byte> payload, PayloadEncoding encoding, const Thinning& thinning,
                    std::span<const std::span<float>> fields);

}  // namespace wade::recording
