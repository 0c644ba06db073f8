#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

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

namespace {

struct Pair {
    double x = 0, z = 0;
};

// Sends what is due, rounded to float, and adds it to what was sent: the loop of impulses to the water.
[[gnu::noinline]] void send(const std::vector<Pair>& due, std::vector<Pair>& sent, std::vector<float>& to_x,
                            std::vector<float>& to_z) {
    for (std::size_t i = 0; i < due.size(); ++i) {
        const auto x = static_cast<float>(due[i].x - sent[i].x), z = static_cast<float>(due[i].z - sent[i].z);
        sent[i].x += static_cast<double>(x);
        sent[i].z += static_cast<double>(z);
        to_x[i] = x;
        to_z[i] = z;
    }
}

}  // namespace

// g++ 12 with vectorisation of straight-line code loses the rounding of pairs (wade_target.cmake).
TEST_CASE("a value that is rounded to float and read back is the rounded one", "[numbers]") {
    constexpr std::size_t n = 50;
    std::vector<Pair> due(n), sent(n), received(n);
    std::vector<float> x(n), z(n);
    std::uint64_t state = 1;
    const auto draw = [&] { return 3 * unit_fraction(mix_bits(state += splitmix_step)); };
    double worst = 0;
    for (int step = 0; step < 100; ++step) {
        for (Pair& pair : due) pair.x += draw(), pair.z += draw();
        send(due, sent, x, z);
        for (std::size_t i = 0; i < n; ++i) {
            received[i].x += static_cast<double>(x[i]);
            received[i].z += static_cast<double>(z[i]);
            worst = std::max({worst, std::abs(received[i].x - sent[i].x), std::abs(received[i].z - sent[i].z)});
        }
    }
    CHECK(worst == 0);
}
