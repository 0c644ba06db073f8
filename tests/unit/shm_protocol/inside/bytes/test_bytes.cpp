#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "shm_protocol/inside/bytes/crc32c.hpp"
#include "shm_protocol/inside/bytes/text.hpp"

using namespace wade::shm;

namespace {

std::string shown(std::string_view text) {
    return printable(text.data(), text.size());
}

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

TEST_CASE("a text from another process is cut at its room") {
    char field[8];
    store_text(field, sizeof field, "much too long");
    CHECK(shown({field, sizeof field}) == "much to");
    const char endless[4] = {'a', 'b', 'c', 'd'};
    CHECK(printable(endless, 4) == "abcd");
    CHECK(shown("") == "");
}

TEST_CASE("a text is cut before a character and not in it") {
    char field[8];
    store_text(field, sizeof field,
               "Uferst\xC3\xBC"
               "ck");
    CHECK(shown({field, sizeof field}) == "Uferst");
    store_text(field, sizeof field,
               "a\xF0\x9F\x8C\x8A"
               "bcd");
    CHECK(shown({field, sizeof field}) ==
          "a\xF0\x9F\x8C\x8A"
          "bc");
    store_text(field, sizeof field, "\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80");
    CHECK(shown({field, sizeof field}) == "????");
}

TEST_CASE("a text from another process cannot disturb a terminal") {
    CHECK(shown("a\x1b[2J\nb\x7F") == "a?[2J?b?");
    CHECK(shown("a\x9b"
                "2Jb") == "a?2Jb");  // the control sequence introducer in one byte
    CHECK(shown("a\xC2\x9B"
                "2Jb") == "a?2Jb");  // and as UTF-8
    CHECK(shown("a\xE2\x80\xAE"
                "b") == "a?b");  // text runs from right to left from here
    CHECK(shown("a\xE2\x80\x8B\xEF\xBB\xBF"
                "b") == "a??b");  // without width
}

TEST_CASE("what is UTF-8 stays, what is not is replaced byte by byte") {
    for (const char* const text : {"Stra\xC3\x9F"
                                   "e",
                                   "\xE6\xB5\xB8\xE6\xB0\xB4", "\xF0\x9F\x8C\x8A", "\xC2\xA0"})
        CHECK(shown(text) == text);
    CHECK(shown("\xC3(") == "?(");               // no continuation
    CHECK(shown("\xC3") == "?");                 // cut off
    CHECK(shown("\xC0\x80") == "??");            // overlong
    CHECK(shown("\xE0\x80\x80") == "???");       // overlong
    CHECK(shown("\xED\xA0\x80") == "???");       // half of a pair
    CHECK(shown("\xF4\x90\x80\x80") == "????");  // beyond the last character
    CHECK(shown("\xFF\xFE\x80") == "???");
}

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
