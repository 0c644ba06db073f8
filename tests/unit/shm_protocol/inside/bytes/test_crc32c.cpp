#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "shm_protocol/inside/bytes/crc32c.hpp"

using wade::shm::crc32c;

namespace {

// The definition, bit by bit.
std::uint32_t by_the_book(std::span<const std::byte> bytes) {
    std::uint32_t r = 0xFFFFFFFFU;
    for (const std::byte b : bytes) {
        r ^= static_cast<std::uint32_t>(b);
        for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1U) ? 0x82F63B78U : 0U);
    }
    return ~r;
}

}  // namespace

TEST_CASE("CRC-32C has its check value") {
    const std::string text = "123456789";
    CHECK(crc32c(std::as_bytes(std::span(text.data(), text.size()))) == 0xE3069283U);
    CHECK(crc32c({}) == 0);
}

TEST_CASE("CRC-32C of any length at any place is that of its definition") {
    std::vector<std::byte> bytes(100);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * i + 37 * i);
    for (std::size_t from = 0; from < 9; ++from)
        for (std::size_t length = 0; length < 70; ++length) {
            const auto part = std::span(bytes).subspan(from, length);
            REQUIRE(crc32c(part) == by_the_book(part));
        }
}
