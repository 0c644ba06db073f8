// The exact solutions of open_channel.hpp, against values that were computed independently of them (SWASHES, four to six
// digits) and against what they must fulfil.

#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "open_channel.hpp"

using namespace wade::validation;

namespace {
constexpr double g = 9.81;
}

TEST_CASE("alternate depths have the energy that was asked for", "[open_channel]") {
    const double q = 1.53;
    const double critical = critical_depth(q, g);
    CHECK(q * q / (g * critical * critical * critical) == Approx(1));
    CHECK(specific_energy(q, critical, g) == Approx(1.5 * critical));
    for (const double energy : {1.001 * 1.5 * critical, 1.2, 5.0}) {
        const double deep = subcritical_depth(q, energy, g);
        const double shallow = supercritical_depth(q, energy, g);
        CHECK(deep > critical);
        CHECK(shallow < critical);
        CHECK(specific_energy(q, deep, g) == Approx(energy).epsilon(1e-10));
        CHECK(specific_energy(q, shallow, g) == Approx(energy).epsilon(1e-10));
    }
    CHECK(subcritical_depth(q, 0.1, g) == critical);
    CHECK(supercritical_depth(q, 0.1, g) == critical);
}

TEST_CASE("Belanger's ratio", "[open_channel]") {
    CHECK(belanger_ratio(1) == Approx(1));
    CHECK(belanger_ratio(2) == Approx(2.37228).epsilon(1e-5));
    CHECK(belanger_ratio(3) == Approx(3.772).epsilon(1e-4));
    CHECK(belanger_ratio(5) == Approx(6.58872).epsilon(1e-5));
    const double h1 = 0.4;
    const double q = 3 * std::sqrt(g * h1) * h1;
    CHECK(momentum_function(q, h1, g) == Approx(momentum_function(q, belanger_ratio(3) * h1, g)));
}

TEST_CASE("subcritical flow over the bump", "[open_channel]") {
    const BumpFlow flow = subcritical_bump_flow(4.42, 2, g);
    CHECK(flow.depth(0) == Approx(2));
    CHECK(flow.depth(25) == Approx(2));
    CHECK(flow.depth(8.5) == Approx(1.87958).epsilon(1e-5));
    CHECK(flow.depth(10) == Approx(1.70735).epsilon(1e-5));
    CHECK(flow.depth(11) == Approx(1.78718).epsilon(1e-5));
    CHECK_THROWS_AS(subcritical_bump_flow(4.42, 1.3, g), std::invalid_argument);
    CHECK(mean_surface(flow, 0, 4) == Approx(2));
    CHECK(mean_surface(flow, 8, 12) < 2);
}

TEST_CASE("transcritical flow over the bump", "[open_channel]") {
    const BumpFlow flow = transcritical_bump_flow(1.53, g);
    CHECK(flow.depth(0) == Approx(1.01445).epsilon(1e-5));
    CHECK(flow.depth(9) == Approx(0.788465).epsilon(1e-5));
    CHECK(flow.depth(10) == Approx(0.620256).epsilon(1e-5));
    CHECK(flow.depth(11) == Approx(0.496622).epsilon(1e-5));
    CHECK(flow.depth(20) == Approx(0.405781).epsilon(1e-5));
}

TEST_CASE("flow over the bump with a jump", "[open_channel]") {
    const BumpFlow flow = bump_flow_with_jump(0.18, 0.33, g);
    CHECK(flow.depth(0) == Approx(0.413736).epsilon(1e-5));
    CHECK(flow.depth(10) == Approx(0.148922).epsilon(1e-5));
    CHECK(flow.depth(11.5) == Approx(0.0803969).epsilon(1e-5));
    CHECK(flow.depth(11.75) == Approx(0.276724).epsilon(1e-5));
    CHECK(flow.depth(25) == Approx(0.33).epsilon(1e-6));
    CHECK(flow.jump > 11.5);
    CHECK(flow.jump < 11.75);
    CHECK_THROWS_AS(bump_flow_with_jump(0.18, 0.2, g), std::invalid_argument);
    CHECK_THROWS_AS(bump_flow_with_jump(0.18, 0.6, g), std::invalid_argument);
}

TEST_CASE("curved streamlines let more water over the bump, and less so where it is shallow", "[open_channel]") {
    const auto lowered = [](double q) {
        const double hydrostatic = transcritical_bump_flow(q, g).energy_upstream;
        return (hydrostatic - curved_transcritical_bump_flow(q, g).energy) / (hydrostatic - bump_top);
    };
    // Of the order of the head over the crest's radius of curvature, 0.93 m / 10 m, times a factor below one.
    CHECK(lowered(1.53) > 0.01);
    CHECK(lowered(1.53) < 0.03);
    CHECK(lowered(0.18) > 0);
    CHECK(lowered(0.18) < 0.5 * lowered(1.53));
    const CurvedBumpFlow flow = curved_transcritical_bump_flow(1.53, g);
    CHECK(flow.depth(4) == Approx(subcritical_depth(1.53, flow.energy, g)));
    CHECK(flow.depth(20) == Approx(supercritical_depth(1.53, flow.energy, g)));
    for (double s = 5; s < 16; s += 0.01) {
        CHECK(std::abs(flow.depth(s + 0.01) - flow.depth(s)) < 0.005);  // no step where the parts meet
    }
}
