#include <catch2/catch.hpp>

#include "configs/numbers/fnv1a.hpp"
#include "configs/numbers/splitmix.hpp"

using namespace wade;

TEST_CASE("hashes of texts are those of the published test vectors", "[numbers]") {
    CHECK(fnv1a("") == 0xcbf29ce484222325ULL);
    CHECK(fnv1a("a") == 0xaf63dc4c8601ec8cULL);
    CHECK(fnv1a("foobar") == 0x85944171f73967e8ULL);
    CHECK(fnv1a("\xff") == fnv1a_next(fnv1a_basis, 0xff));  // bytes have no sign
}

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
