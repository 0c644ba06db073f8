#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <string_view>
#include <vector>

#include "shm_protocol/inside/bytes/hash.hpp"

using namespace wade::shm;

namespace {

// The definition in hash.hpp, word by word, without regard for speed.
std::uint64_t defined_chain(std::uint64_t previous, std::uint64_t frame, const HashedFields& fields) {
    const auto mix = [](std::uint64_t z) {
        z ^= z >> 30;
        z *= 0xBF58476D1CE4E5B9;
        z ^= z >> 27;
        z *= 0x94D049BB133111EB;
        z ^= z >> 31;
        return z;
    };
    std::uint64_t h = mix(previous + 0x9E3779B97F4A7C15);
    h = mix(h ^ frame);
    h = mix(h ^ fields[0].size());
    for (const auto& field : fields) {
        std::uint64_t s = 0;
        for (std::size_t k = field.size(); k-- > 0;) {
            std::uint32_t w = 0;
            std::memcpy(&w, &field[k], sizeof w);
            const auto n = static_cast<std::uint32_t>(k + 1);
            const std::uint64_t x = static_cast<std::uint32_t>(w + 0x9E3779B1U * n);
            const std::uint64_t y = std::rotl(w, 16) ^ (0x85EBCA77U * n);
            s += x * y;
        }
        h = mix(h ^ s);
    }
    return h == 0 ? 1 : h;
}

struct Sample {
    explicit Sample(std::size_t count) : values(7 * count) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.37F * static_cast<float>(i % 1013) - 55;
        for (std::size_t i = 0; i < 7; ++i) fields[i] = {values.data() + i * count, count};
    }
    std::vector<float> values;
    HashedFields fields;
};

}  // namespace

TEST_CASE("the chain follows its definition for every length around the width of a vector") {
    for (const std::size_t count : {0UL, 1UL, 2UL, 3UL, 7UL, 8UL, 15UL, 16UL, 17UL, 31UL, 33UL, 1000UL, 4099UL}) {
        const Sample sample(count);
        CAPTURE(count);
        CHECK(chain_hash(0, 1, sample.fields) == defined_chain(0, 1, sample.fields));
        CHECK(chain_hash(12345, 77, sample.fields) == defined_chain(12345, 77, sample.fields));
    }
}

TEST_CASE("the chain of a small frame has the value that an independent program in Python computes") {
    const std::vector<float> values{1.0F, -2.5F, 0.0F, -0.0F, 3.25e-3F};
    HashedFields fields;
    for (std::size_t i = 0; i < 7; ++i) fields[i] = values;
    CHECK(chain_hash(0, 1, fields) == 0x04E63C549AB64FEBULL);
    CHECK(chain_hash(chain_hash(0, 1, fields), 2, fields) == 0x89C41A41FD9478F6ULL);
    std::array<std::span<const float>, 10> agents;
    agents.fill(values);
    CHECK(chain_hash(0, 1, agents) == 0x5F841276364CDF92ULL);
    CHECK(chain_hash(chain_hash(0, 1, agents), 2, agents) == 0x097B819422230CDCULL);
}

TEST_CASE("any single changed bit of a frame changes the chain") {
    Sample sample(9);
    const std::uint64_t before = chain_hash(5, 3, sample.fields);
    for (float& value : sample.values)
        for (int bit = 0; bit < 32; ++bit) {
            const float original = value;
            value = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) ^ (1U << bit));
            REQUIRE(chain_hash(5, 3, sample.fields) != before);
            value = original;
        }
}

TEST_CASE("the chain depends on order, field, frame number, length and history") {
    Sample sample(20);
    const std::uint64_t before = chain_hash(5, 3, sample.fields);
    CHECK(chain_hash(6, 3, sample.fields) != before);
    CHECK(chain_hash(5, 4, sample.fields) != before);
    HashedFields shorter = sample.fields;
    for (auto& field : shorter) field = field.first(19);
    CHECK(chain_hash(5, 3, shorter) != before);
    HashedFields exchanged = sample.fields;
    std::swap(exchanged[1], exchanged[2]);
    CHECK(chain_hash(5, 3, exchanged) != before);
    std::swap(sample.values[3], sample.values[4]);
    CHECK(chain_hash(5, 3, sample.fields) != before);
}

TEST_CASE("two flipped signs do not cancel") {
    Sample sample(40);
    const std::uint64_t before = chain_hash(0, 1, sample.fields);
    for (std::size_t k = 1; k < 40; ++k) {
        sample.values[0] = -sample.values[0];
        sample.values[k] = -sample.values[k];
        CHECK(chain_hash(0, 1, sample.fields) != before);
        sample.values[0] = -sample.values[0];
        sample.values[k] = -sample.values[k];
    }
}

TEST_CASE("a NaN or an infinity anywhere is noticed, and nothing else is") {
    Sample sample(37);
    sample.values[5] = std::numeric_limits<float>::max();
    sample.values[6] = std::numeric_limits<float>::denorm_min();
    CHECK_FALSE(chain_frame(0, 1, sample.fields).nonfinite);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()})
        for (float& value : sample.values) {
            const float original = value;
            value = bad;
            REQUIRE(chain_frame(0, 1, sample.fields).nonfinite);
            value = original;
        }
    sample.values[11] = std::numeric_limits<float>::infinity();
    CHECK(first_nonfinite(sample.fields[0]) == 11);
    CHECK(first_nonfinite(sample.fields[1]) == 37);
}
