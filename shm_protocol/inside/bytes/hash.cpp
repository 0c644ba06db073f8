#include "shm_protocol/inside/bytes/hash.hpp"

#include <bit>

namespace wade::shm {
namespace {

constexpr std::uint32_t exponent_bits = 0x7F800000;  // all set in a NaN or an infinity

std::uint64_t mix(std::uint64_t z) {
    z ^= z >> 30;
    z *= 0xBF58476D1CE4E5B9;
    z ^= z >> 27;
    z *= 0x94D049BB133111EB;
    return z ^ (z >> 31);
}

// Its top bit is set if the bits of a float are those of a number that is 0 or has a minus.
constexpr std::uint32_t not_above_zero(std::uint32_t w) {
    return (w - 1U) | w;
}

struct FieldSum {
    std::uint64_t sum;
    bool nonfinite;
    bool not_positive;
};

// Plain loop without branches, so that the compiler turns it into vector code.
template <bool signs>
FieldSum sum_field(std::span<const float> values) {
    std::uint64_t sum = 0;
    std::uint32_t nonfinite = 0, not_positive = 0;
    const float* const data = values.data();
    const std::uint32_t count = static_cast<std::uint32_t>(values.size());
    std::uint32_t a = 0, b = 0;  // the two multiples of k + 1, added up: vectors add faster than they multiply
    for (std::uint32_t k = 0; k < count; ++k) {
        a += 0x9E3779B1U;
        b += 0x85EBCA77U;
        const std::uint32_t w = std::bit_cast<std::uint32_t>(data[k]);
        const std::uint32_t x = w + a;
        const std::uint32_t y = ((w << 16) | (w >> 16)) ^ b;
        sum += static_cast<std::uint64_t>(x) * y;
        nonfinite |= static_cast<std::uint32_t>((w & exponent_bits) == exponent_bits);
        if constexpr (signs) not_positive |= not_above_zero(w);
    }
    return {sum, nonfinite != 0, not_positive >> 31 != 0};
}

}  // namespace

ChainResult chain_frame(std::uint64_t previous, std::uint64_t frame, FieldSpans fields) {
    std::uint64_t h = mix(previous + 0x9E3779B97F4A7C15);
    h = mix(h ^ frame);
    h = mix(h ^ fields[0].size());
    const FieldSum mass = sum_field<true>(fields[0]);
    h = mix(h ^ mass.sum);
    bool nonfinite = mass.nonfinite;
    for (const auto& field : fields.subspan(1)) {
        const FieldSum part = sum_field<false>(field);
        h = mix(h ^ part.sum);
        nonfinite = nonfinite || part.nonfinite;
    }
    return {h == 0 ? 1 : h, nonfinite, mass.not_positive};
}

std::uint64_t chain_hash(std::uint64_t previous, std::uint64_t frame, FieldSpans fields) {
    return chain_frame(previous, frame, fields).hash;
}

std::size_t first_nonfinite(std::span<const float> values) {
    std::size_t k = 0;
    while (k < values.size() && (std::bit_cast<std::uint32_t>(values[k]) & exponent_bits) != exponent_bits) ++k;
    return k;
}

std::size_t first_massless(std::span<const float> mass) {
    std::size_t k = 0;
    while (k < mass.size() && not_above_zero(std::bit_cast<std::uint32_t>(mass[k])) >> 31 == 0) ++k;
    return k;
}

}  // namespace wade::shm
