#include "shm_protocol/inside/crc32c.hpp"

#include <array>

namespace wade::shm {
namespace {

constexpr std::array<std::uint32_t, 256> make_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t r = i;
        for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1U) ? 0x82F63B78U : 0U);  // reflected polynomial
        table[i] = r;
    }
    return table;
}

constexpr std::array<std::uint32_t, 256> table = make_table();

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) {
    std::uint32_t r = 0xFFFFFFFFU;
    for (const std::byte b : bytes) r = (r >> 8) ^ table[(r ^ static_cast<std::uint32_t>(b)) & 0xFFU];
    return ~r;
}

}  // namespace wade::shm
