#include <catch2/catch.hpp>

#include "configs/numbers/splitmix.hpp"

using namespace wade;

TEST_CASE("the stream of seed 0 is that of the published generator", "[numbers]") {
    // The first outputs of splitmix64.c by Vigna for the state 0.
    CHECK(mix_bits(1 * splitmix_step) == 0xe220a8397b1dcdafULL);
    CHECK(mix_bits(2 * splitmix_step) == 0x6e789e6aa1b965f4ULL);
    CHECK(mix_bits(3 * splitmix_step) == 0x06c45d188009454fULL);
}

TEST_CASE("fractions of bits fill [0, 1) and leave 1 out", "[numbers]") {
    CHECK(unit_fraction(0) == 0);
    CHECK(unit_fraction(1ULL << 63) == 0.5);
    CHECK(unit_fraction(~0ULL) == 1 - 0x1p-53);
}
