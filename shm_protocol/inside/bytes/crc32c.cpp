#include "shm_protocol/inside/bytes/crc32c.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace wade::shm {
namespace {

using Table = std::array<std::uint32_t, 256>;

// tables[n][b]: what byte b does to the remainder n bytes further on, so that eight bytes are taken at once
// ("slicing by 8", Kounavis and Berry 2005).
constexpr std::array<Table, 8> make_tables() {
    std::array<Table, 8> tables{};
    for (std::uint32_t b = 0; b < 256; ++b) {
        std::uint32_t r = b;
        for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1U) ? 0x82F63B78U : 0U);  // reflected polynomial
        tables[0][b] = r;
    }
    for (std::size_t n = 1; n < 8; ++n)
        for (std::uint32_t b = 0; b < 256; ++b)
            tables[n][b] = (tables[n - 1][b] >> 8) ^ tables[0][tables[n - 1][b] & 0xFFU];
    return tables;
}

constexpr std::array<Table, 8> tables = make_tables();

std::uint32_t eight_bytes(std::uint32_t r, const std::byte* at) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, sizeof word);
    word ^= r;
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 8; ++i) next ^= tables[7 - i][(word >> (8 * i)) & 0xFFU];
    return next;
}

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t before) {
    std::uint32_t r = ~before;
    std::size_t i = 0;
    if constexpr (std::endian::native == std::endian::little)
        for (; i + 8 <= bytes.size(); i += 8) r = eight_bytes(r, bytes.data() + i);
    for (; i < bytes.size(); ++i) r = (r >> 8) ^ tables[0][(r ^ static_cast<std::uint32_t>(bytes[i])) & 0xFFU];
    return ~r;
}

}  // namespace wade::shm
