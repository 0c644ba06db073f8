#include "tools/shm/frame_payload.hpp"

#include <zstd.h>

#include <cstring>
#include <stdexcept>
#include <string>

namespace wade::recording {
namespace {

constexpr std::size_t value_bytes = sizeof(float);

// The exponents of neighbouring particles are alike: their bytes side by side compress, the mantissas between do not.
void shuffle(std::span<const float> values, std::byte* out) {
    const auto bytes = std::as_bytes(values);
    for (std::size_t b = 0; b < value_bytes; ++b)
        for (std::size_t k = 0; k < values.size(); ++k) *out++ = bytes[value_bytes * k + b];
}

void unshuffle(const std::byte* in, std::span<float> values) {
    const auto bytes = std::as_writable_bytes(values);
    for (std::size_t b = 0; b < value_bytes; ++b)
        for (std::size_t k = 0; k < values.size(); ++k) bytes[value_bytes * k + b] = *in++;
}

template <typename Spans>
std::size_t plain_bytes(const Spans& fields) {
    return fields.empty() ? 0 : fields.size() * fields[0].size_bytes();
}

template <typename Span, typename Source>
std::vector<Span> in_order(const Source& s, shm::StreamKind kind) {
    std::vector<Span> fields{s.mass, s.vx, s.vy, s.vz, s.px, s.py, s.pz};
    if (kind == shm::stream_agents) fields.insert(fields.end(), {s.radius, s.height, s.state});
    return fields;
}

}  // namespace

std::vector<std::span<const float>> fields_of(const shm::Frame& frame, shm::StreamKind kind) {
    return in_order<std::span<const float>>(frame, kind);
}

std::vector<std::span<float>> fields_of(const shm::FrameFields& slot, shm::StreamKind kind) {
    return in_order<std::span<float>>(slot, kind);
}

PayloadEncoding append_payload(std::span<const std::span<const float>> fields, int level, std::vector<std::byte>& out) {
    const std::size_t begin = out.size();
    if (level == 0) {
        for (const auto& field : fields) {
            const auto bytes = std::as_bytes(field);
            out.insert(out.end(), bytes.begin(), bytes.end());
        }
        return payload_plain;
    }
    std::vector<std::byte> shuffled(plain_bytes(fields));
    std::size_t at = 0;
    for (const auto& field : fields) {
        shuffle(field, shuffled.data() + at);
        at += field.size_bytes();
    }
    out.resize(begin + ZSTD_compressBound(shuffled.size()));
    const std::size_t written =
        ZSTD_compress(out.data() + begin, out.size() - begin, shuffled.data(), shuffled.size(), level);
    if (ZSTD_isError(written) != 0)
        throw std::runtime_error(std::string("Compressing a frame failed: ") + ZSTD_getErrorName(written) + ".");
    out.resize(begin + written);
    return payload_shuffled_zstd;
}

std::size_t largest_payload(PayloadEncoding encoding, std::size_t values) {
    return encoding == payload_plain ? values * value_bytes : ZSTD_compressBound(values * value_bytes);
}

bool decode_payload(std::span<const std::byte> payload, PayloadEncoding encoding,
                    std::span<const std::span<float>> fields) {
    const std::size_t expected = plain_bytes(fields);
    if (encoding == payload_plain) {
        if (payload.size() != expected) return false;
        std::size_t at = 0;
        for (const auto& field : fields) {
            if (!field.empty()) std::memcpy(field.data(), payload.data() + at, field.size_bytes());
            at += field.size_bytes();
        }
        return true;
    }
    std::vector<std::byte> shuffled(expected);
    const std::size_t got = ZSTD_decompress(shuffled.data(), shuffled.size(), payload.data(), payload.size());
    if (ZSTD_isError(got) != 0 || got != expected) return false;
    std::size_t at = 0;
    for (const auto& field : fields) {
        unshuffle(shuffled.data() + at, field);
        at += field.size_bytes();
    }
    return true;
}

}  // namespace wade::recording
