// Drowning of people adrift: the hazard of people/drift.hpp through the states of people.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/people/states.hpp"

namespace wade::crowd::drift_test {

constexpr double best = 0.006;  // lambda, 1/s

// A person of 1.7 m in water too strong for any posture.
Strain adrift(double depth, double hazard, double drowns_at) {
    Strain s;
    s.at_rest.fill(9);
    s.weight = 400;
    s.arm = 0.15;
    s.depth = depth;
    s.hazard = hazard;
    s.drowns_at = drowns_at;
    return s;
}

// Of draws of a person: E.
double limit_of(std::size_t id) {
    return -std::log1p(-counter_uniform(1, id, 0));
}

// When a carried person drowns, s; 0: not within 300 s. M = 1.
double drowns(const Strain& s, double rate) {
    Condition condition;
    condition.state = PersonState::carried;
    for (int i = 1; i <= 300 * rate; ++i) {
        condition = next_condition(condition, s, 1 / rate);
        if (condition.state == PersonState::drowned) return i / rate;
    }
    return 0;
}

TEST_CASE("Of 10,000 people adrift as many have drowned by 30 to 300 s as the hazard says") {
    struct Row {
        double time, percent;
    };
    // 1 - exp(-0.006 (t - 20)). Three standard deviations of a share of 10,000 are 1.5 points at most.
    constexpr std::array rows{Row{30, 5.8}, Row{60, 21.3}, Row{120, 45.1}, Row{300, 81.4}};
    std::array<int, rows.size()> dead{};
    constexpr int people = 10000;
    for (std::size_t id = 0; id < people; ++id) {
        const double time = drowns(adrift(1.5, best, limit_of(id)), 5);
        for (std::size_t i = 0; i < rows.size(); ++i) dead[i] += time > 0 && time <= rows[i].time + 1e-9 ? 1 : 0;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CAPTURE(rows[i].time);
        CHECK(100.0 * dead[i] / people == Approx(rows[i].percent).margin(1.5));
    }
}

TEST_CASE("People adrift drown at the same time at any rate of steps, and no later with a larger hazard") {
    int dead = 0;
    for (std::size_t id = 0; id < 100; ++id) {
        const double limit = limit_of(id);
        const double reference = drowns(adrift(1.5, best, limit), 120);
        const double expected = struggle_time + limit / best;
        CAPTURE(id, limit);
        if (expected > 301) CHECK(reference == 0);
        if (expected < 299) CHECK(reference == Approx(expected).margin(1 / 120.0 + 1e-9));
        for (const double rate : {5.0, 15.0, 30.0}) {
            const double time = drowns(adrift(1.5, best, limit), rate);
            if (expected < 299) CHECK(time == Approx(expected).margin(1 / rate + 1e-9));
        }
        CHECK(drowns(adrift(1.5, 0, limit), 5) == 0);
        const double sooner = drowns(adrift(1.5, 0.02, limit), 15), later = drowns(adrift(1.5, 0.002, limit), 15);
        if (reference > 0) CHECK((sooner > 0 && sooner <= reference + 1 / 15.0));
        if (later > 0) CHECK((reference > 0 && reference <= later + 1 / 15.0));
        dead += reference > 0 ? 1 : 0;
    }
    CHECK(dead > 60);
}

TEST_CASE("Exposure waits for the first 20 s, for a quarter of the height and for the loss of any hold") {
    Condition condition;
    condition.state = PersonState::carried;
    const auto pass = [&](const Strain& s, double time) {
        for (int i = 0; i < std::lround(time * 15); ++i) condition = next_condition(condition, s, 1 / 15.0);
    };
    pass(adrift(0.24 * 1.7, best, 9), 100);
    CHECK(condition.drift.exposure == 0);
    CHECK(condition.drift.time == Approx(100));
    pass(adrift(0.26 * 1.7, best, 9), 20);
    CHECK(condition.drift.exposure == Approx(0).margin(1e-9));
    Strain wild = adrift(1.2, best, 9);
    wild.drift_weight = 3;
    pass(wild, 10);
    CHECK(condition.drift.exposure == Approx(30));
    CHECK(condition.drift.end == DriftEnd::adrift);
    Strain held = adrift(1.2, best, 9);
    held.hold = 100;
    pass(held, 5);
    CHECK(condition.state == PersonState::holding);
    CHECK(condition.drift.end == DriftEnd::held);
    CHECK(condition.drift.exposure == Approx(30).margin(0.21));  // the step that takes the hold counts
    pass(adrift(1.2, best, 9), 15);                              // three times 5 s of the first 20 s came back
    CHECK(condition.drift.exposure == Approx(30).margin(0.21));
    pass(adrift(1.2, best, 9), 10);
    CHECK(condition.drift.exposure == Approx(40).margin(0.21));
    CHECK(condition.drift.time == Approx(155).margin(0.15));
    Strain calm = adrift(0.5, best, 9);
    calm.at_rest.fill(0);
    pass(calm, 1);
    CHECK(condition.drift.end == DriftEnd::feet_down);
}

TEST_CASE("The weight of the hazard is that of swimmers, children, fast water and cold") {
    const auto speed_at = [](double froude) { return froude * std::sqrt(9.81 * 1.0); };
    const auto weight = [&](double height, bool swims, double froude) {
        return drift_weight({height, swims, speed_at(froude), 1, 9.81});
    };
    CHECK(weight(1.7, false, 0.6) == Approx(1));
    CHECK(weight(1.7, true, 0.6) == Approx(0.25));
    CHECK(weight(1.39, false, 0.6) == Approx(1.5));
    CHECK(weight(1.4, false, 0.6) == Approx(1));
    CHECK(weight(1.7, false, 0) == Approx(0.5));
    CHECK(weight(1.7, false, 0.3) == Approx(0.5));
    CHECK(weight(1.7, false, 0.45) == Approx(0.75));
    CHECK(weight(1.7, false, 0.8) == Approx(2));
    CHECK(weight(1.7, false, 1) == Approx(3));
    CHECK(weight(1.7, false, 2) == Approx(3));
    CHECK(cold_weight({}, 0) == 1);
    CHECK(cold_weight(10, 0) == Approx(38 / 24.21));
    CHECK(cold_weight(10, 120) == 1);
    CHECK(cold_weight(30, 0) == 1);
}

}  // namespace wade::crowd::drift_test
