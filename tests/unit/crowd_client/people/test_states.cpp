// Each row of the table of people/states.hpp: what leads into a state and out of it, and when.

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <functional>

#include "crowd_client/people/states.hpp"

using namespace wade::crowd;

namespace {

constexpr double height = 1.7, lever = 0.09 * height, weight = 400;

// S and T as given, D of a body at rest the larger one in all postures, in water of a depth.
Strain strain(double slip, double topple, double depth) {
    Strain s;
    s.slip = slip;
    s.moment = topple * weight * lever;
    s.at_rest.fill(std::max(slip, topple));
    s.weight = weight;
    s.height = height;
    s.arm = lever;
    s.depth = depth;
    s.drifts_under = true;
    return s;
}

Condition in(PersonState state) {
    Condition condition;
    condition.state = state;
    return condition;
}

struct Passage {
    PersonState state;  // the next one
    double time;        // after which, s; 1000: never within that
};

Passage leaves(Condition condition, const Strain& s, double rate) {
    const PersonState from = condition.state;
    for (int i = 1; i <= 1000 * rate; ++i) {
        condition = next_condition(condition, s, 1 / rate);
        if (condition.state != from) return {condition.state, i / rate};
    }
    return {from, 1000};
}

struct Row {
    PersonState from;
    Strain strain;
    PersonState to;
    double time;  // s; 0: at once
};

using S = PersonState;

// D at rest sitting, kneeling, squatting and standing; an upright person is firm.
Strain resting(const std::array<double, rests>& at_rest, double depth) {
    Strain s = strain(0, 0, depth);
    s.at_rest = at_rest;
    return s;
}

Strain swimming(double depth) {
    Strain s = strain(0, 0, depth);
    s.can_swim = true;
    return s;
}

}  // namespace

TEST_CASE("Each state is left for the next when its row says, at any rate of steps") {
    const Row row = GENERATE(
        Row{S::walking, strain(0.4, 0.49, 0.5), S::walking, 1000}, Row{S::walking, strain(0.5, 0, 0.5), S::effort, 0},
        Row{S::walking, strain(0, 0.5, 0.5), S::effort, 0}, Row{S::effort, strain(0.46, 0, 0.5), S::effort, 1000},
        Row{S::effort, strain(0.44, 0.44, 0.5), S::walking, 0}, Row{S::effort, strain(1, 0, 0.5), S::sliding, 0.1},
        Row{S::sliding, strain(0.95, 0, 0.5), S::sliding, 1000}, Row{S::sliding, strain(0.89, 0, 0.5), S::effort, 0.3},
        Row{S::sliding, strain(3, 1, 1), S::toppled, 0.3}, Row{S::toppled, strain(3, 3, 1), S::carried, 0.3},
        Row{S::toppled, strain(0, 0, 0.1), S::carried, 0.3}, Row{S::walking, strain(0, 0, 0.87 * height), S::afloat, 0},
        Row{S::sliding, strain(2, 2, 0.88 * height), S::afloat, 0},
        Row{S::afloat, strain(0, 0, 0.81 * height), S::carried, 0.3},
        Row{S::afloat, strain(0, 0, 0.79 * height), S::sliding, 0}, Row{S::afloat, swimming(2), S::afloat, 1000},
        Row{S::afloat, swimming(0.79 * height), S::sliding, 0}, Row{S::carried, swimming(1.6), S::afloat, 0},
        // Sits or kneels where it can, unless the water holds it upright on its feet.
        Row{S::carried, resting({0.99, 9, 9, 9}, 0.59 * height), S::recovering, 0},
        Row{S::carried, resting({9, 0.99, 9, 9}, 0.59 * height), S::recovering, 0},
        Row{S::carried, resting({0.9, 0.9, 0.9, 0.7}, 0.24 * height), S::recovering, 0},
        Row{S::carried, resting({0.9, 0.9, 0.9, 0.7}, 0.26 * height), S::sliding, 0},
        Row{S::carried, resting({9, 9, 9, 0.79}, 0.24 * height), S::sliding, 0},
        Row{S::carried, resting({9, 9, 9, 0.79}, 0.79 * height), S::sliding, 0},
        Row{S::carried, resting({1.01, 1.01, 0.5, 0.81}, 0.24 * height), S::carried, 1000},
        Row{S::carried, resting({1.01, 1.01, 0.5, 0.81}, 0.26 * height), S::drowned, 60},
        Row{S::carried, resting({0.5, 0.5, 0.5, 0.81}, 0.61 * height), S::drowned, 60},
        Row{S::carried, strain(0, 0, 0.81 * height), S::drowned, 60},
        Row{S::recovering, resting({0.3, 0.3, 0.3, 0.3}, 0.5), S::effort, 4},
        Row{S::recovering, resting({1.01, 0.5, 0.5, 0.5}, 0.5), S::carried, 0},
        Row{S::recovering, resting({0.9, 2, 2, 2}, 0.45 * height), S::drowned, 60},
        Row{S::recovering, resting({0.9, 2, 2, 2}, 0.43 * height), S::recovering, 1000},
        // Squatting is skipped where standing holds; else the person goes on kneeling.
        Row{S::recovering, resting({0.5, 0.5, 2, 0.9}, 0.5), S::effort, 4},
        Row{S::recovering, resting({0.5, 0.5, 2, 1.1}, 0.5), S::recovering, 1000},
        Row{S::recovering, strain(0, 0, 0.9 * height), S::afloat, 0},
        Row{S::drowned, strain(0, 0, 0), S::drowned, 1000});
    for (const double rate : {15.0, 30.0, 120.0}) {
        const auto name = [](S state) { return std::string(person_states[static_cast<std::size_t>(state)]); };
        CAPTURE(name(row.from), row.strain.slip, topple_demand(row.strain), row.strain.depth, rate);
        const Passage found = leaves(in(row.from), row.strain, rate);
        CHECK(name(found.state) == name(row.to));
        if (row.time == 1000) CHECK(found.time == 1000);
        if (row.time < 1000) CHECK(std::abs(found.time - row.time) <= 1 / rate + 1e-9);
    }
}

TEST_CASE("A demand that ends before its time is over leads nowhere") {
    Condition condition = in(S::effort);
    for (int i = 0; i < 100; ++i) {
        const bool slips = i % 3 < 2;  // two steps of 1/30 s at a time
        condition = next_condition(condition, strain(slips ? 2 : 0.6, 0, 0.5), 1 / 30.0);
        REQUIRE(condition.state == S::effort);
    }
}

TEST_CASE("Air comes back three times as fast as it goes, and who is in shallow water loses none") {
    Condition condition = in(S::carried);
    for (int i = 0; i < 300; ++i) condition = next_condition(condition, strain(0, 3, 1.5), 0.1);
    CHECK(condition.air == Approx(30));
    condition.state = S::recovering;
    for (int i = 0; i < 50; ++i) {
        condition = next_condition(condition, strain(0, 0, 0.3), 0.1);
    }
    CHECK(condition.air == Approx(45));
    for (int i = 0; i < 100; ++i) condition = next_condition(condition, strain(0, 0, 0.3), 0.1);
    CHECK(condition.air == air_budget);
}

TEST_CASE("Who can sit but not stand sits until the water lets it stand, and is carried off by more") {
    for (const double rate : {15.0, 30.0, 120.0}) {
        Condition condition = in(S::carried);
        const auto pass = [&](const std::array<double, rests>& at_rest, double time) {
            for (int i = 0; i < std::lround(time * rate); ++i) {
                condition = next_condition(condition, resting(at_rest, 0.4), 1 / rate);
            }
            return condition.state;
        };
        CHECK(pass({0.5, 0.8, 1.5, 1.3}, 60) == S::recovering);  // kneels
        CHECK(posture_of(condition) == Rest::kneels);
        CHECK(pass({0.7, 1.2, 2.2, 2}, 60) == S::recovering);
        CHECK(posture_of(condition) == Rest::sits);
        CHECK(pass({0.2, 0.2, 0.4, 0.4}, 2.5) == S::recovering);
        CHECK(pass({0.2, 0.2, 0.4, 0.4}, 1) == S::walking);
        condition = in(S::recovering);
        CHECK(pass({0.7, 1.2, 2.2, 2}, 10) == S::recovering);
        CHECK(pass({1.1, 1.8, 3.3, 3}, 1 / rate) == S::carried);
    }
}
