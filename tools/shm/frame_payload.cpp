#include "tools/shm/frame_payload.hpp"

#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace wade::recording {
namespace {

constexpr std::size_t value_bytes = sizeof(float);

// The exponents of neighbouring particles are alike: their bytes side by side compress, the mantissas between do not.
template <typename T>
std::byte* shuffle(std::span<const T> values, std::byte* out) {
    const auto bytes = std::as_bytes(values);
    for (std::size_t b = 0; b < sizeof(T); ++b)
        for (std::size_t k = 0; k < values.size(); ++k) *out++ = bytes[sizeof(T) * k + b];
    return out;
}

template <typename T>
const std::byte* unshuffle(const std::byte* in, std::span<T> values) {
    const auto bytes = std::as_writable_bytes(values);
    for (std::size_t b = 0; b < sizeof(T); ++b)
        for (std::size_t k = 0; k < values.size(); ++k) bytes[sizeof(T) * k + b] = *in++;
    return in;
}

void append_compressed(const std::vector<std::byte>& bytes, int level, std::vector<std::byte>& out) {
    const std::size_t begin = out.size();
    out.resize(begin + ZSTD_compressBound(bytes.size()));
    const std::size_t written =
        ZSTD_compress(out.data() + begin, out.size() - begin, bytes.data(), bytes.size(), level);
    if (ZSTD_isError(written) != 0)
        throw std::runtime_error(std::string("Compressing a frame failed: ") + ZSTD_getErrorName(written) + ".");
    out.resize(begin + written);
}

bool decompress(std::span<const std::byte> payload, std::vector<std::byte>& out) {
    const std::size_t got = ZSTD_decompress(out.data(), out.size(), payload.data(), payload.size());
    return ZSTD_isError(got) == 0 && got == out.size();
}

// A quantised frame: mass as float32, velocities as int16, positions as uint16.
constexpr std::size_t velocity_fields = 1, place_fields = 4, quantised_fields = 7;
constexpr std::size_t quantised_bytes = value_bytes + 3 * sizeof(std::int16_t) + 3 * sizeof(std::uint16_t);
constexpr double most_velocity_steps = 32767, place_steps = 65535;

// Of 24 bits, so that its products with 16 bits are exact and all readers get the same float32.
float place_step(const Thinning& t, std::size_t axis) {
    return static_cast<float>((static_cast<double>(t.high[axis]) - static_cast<double>(t.low[axis])) / place_steps);
}

float place_of(const Thinning& t, std::size_t axis, std::uint16_t steps) {
    return static_cast<float>(static_cast<double>(t.low[axis]) +
                              static_cast<double>(steps) * static_cast<double>(place_step(t, axis)));
}

float velocity_of(const Thinning& t, std::int16_t steps) {
    return static_cast<float>(steps) * t.velocity_step_m_s;
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
    if (level == 0) {
        for (const auto& field : fields) {
            const auto bytes = std::as_bytes(field);
            out.insert(out.end(), bytes.begin(), bytes.end());
        }
        return payload_plain;
    }
    std::vector<std::byte> shuffled(plain_bytes(fields));
    std::byte* at = shuffled.data();
    for (const auto& field : fields) at = shuffle(field, at);
    append_compressed(shuffled, level, out);
    return payload_shuffled_zstd;
}

std::size_t append_quantised(std::span<const std::span<float>> fields, const Thinning& thinning, int level,
                             std::vector<std::byte>& out) {
    const std::size_t count = fields[0].size();
    const double velocity_step_m_s = thinning.velocity_step_m_s;
    std::vector<std::byte> shuffled(quantised_bytes * count);
    std::byte* at = shuffle(std::span<const float>(fields[0]), shuffled.data());
    std::size_t cut = 0;
    std::vector<std::int16_t> velocities(count);
    for (const auto& field : fields.subspan(velocity_fields, 3)) {
        for (std::size_t k = 0; k < count; ++k) {
            const double steps = std::nearbyint(static_cast<double>(field[k]) / velocity_step_m_s);
            const double kept = std::clamp(steps, -most_velocity_steps, most_velocity_steps);
            cut += kept == steps ? 0U : 1U;
            velocities[k] = static_cast<std::int16_t>(kept);
            field[k] = velocity_of(thinning, velocities[k]);
        }
        at = shuffle(std::span<const std::int16_t>(velocities), at);
    }
    std::vector<std::uint16_t> places(count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& field = fields[place_fields + axis];
        const double low = thinning.low[axis], step = place_step(thinning, axis);
        for (std::size_t k = 0; k < count; ++k) {
            const double steps = std::nearbyint((static_cast<double>(field[k]) - low) / step);
            places[k] = static_cast<std::uint16_t>(std::clamp(steps, 0.0, place_steps));
            field[k] = place_of(thinning, axis, places[k]);
        }
        at = shuffle(std::span<const std::uint16_t>(places), at);
    }
    append_compressed(shuffled, level, out);
    return cut;
}

float position_error(const Thinning& thinning) {
    double error = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // Half a step, and the rounding of the position and, at the box's end, of 65535 steps to float32.
        const float most = std::max(std::abs(thinning.low[axis]), std::abs(thinning.high[axis]));
        const double rounding = static_cast<double>(std::nextafter(most, 2 * most)) - static_cast<double>(most);
        error = std::max(error, 0.5 * static_cast<double>(place_step(thinning, axis)) + rounding);
    }
    return static_cast<float>(error);
}

std::size_t largest_payload(PayloadEncoding encoding, std::size_t values) {
    return encoding == payload_plain ? values * value_bytes : ZSTD_compressBound(values * value_bytes);
}

namespace {

bool decode_quantised(std::span<const std::byte> payload, const Thinning& thinning,
                      std::span<const std::span<float>> fields) {
    const std::size_t count = fields[0].size();
    std::vector<std::byte> shuffled(quantised_bytes * count);
    if (fields.size() != quantised_fields || !decompress(payload, shuffled)) return false;
    const std::byte* at = unshuffle(shuffled.data(), fields[0]);
    std::vector<std::int16_t> velocities(count);
    for (const auto& field : fields.subspan(velocity_fields, 3)) {
        at = unshuffle(at, std::span(velocities));
        std::transform(velocities.begin(), velocities.end(), field.begin(),
                       [&](std::int16_t steps) { return velocity_of(thinning, steps); });
    }
    std::vector<std::uint16_t> places(count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        at = unshuffle(at, std::span(places));
        std::transform(places.begin(), places.end(), fields[place_fields + axis].begin(),
                       [&](std::uint16_t steps) { return place_of(thinning, axis, steps); });
    }
    return true;
}

}  // namespace

bool decode_payload(std::span<const std::byte> payload, PayloadEncoding encoding, const Thinning& thinning,
                    std::span<const std::span<float>> fields) {
    if (encoding == payload_quantised_zstd) return decode_quantised(payload, thinning, fields);
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
    if (!decompress(payload, shuffled)) return false;
    const std::byte* at = shuffled.data();
    for (const auto& field : fields) at = unshuffle(at, field);
    return true;
}

}  // namespace wade::recording
