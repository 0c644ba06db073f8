// The exact dam breaks against states published in textbooks and against their own conservation laws.

#include <catch2/catch.hpp>
#include <cmath>

#include "shallow_water_exact.hpp"

using namespace wade::validation;

TEST_CASE("Ritter: critical state at the dam, front at 2 c", "[exact]") {
    const double g = 9.81;
    const FlowState dam = ritter(0, 1, 1, g);
    CHECK(dam.depth == Approx(4.0 / 9));
    CHECK(dam.velocity == Approx(2.0 / 3 * std::sqrt(g)));
    CHECK(ritter(2.001 * std::sqrt(g), 1, 1, g).depth == 0);
    CHECK(ritter(-1.001 * std::sqrt(g), 1, 1, g).depth == 1);
    CHECK(ritter(0.9, 0.5, 1, g).depth == Approx(0.22575).epsilon(1e-3));
}

TEST_CASE("Stoker: states between wave and shock", "[exact]") {
    // depth and velocity of the middle state and speed of the shock for h_l = 1 m, g = 9.81 m/s2
    const double table[][4] = {{0.05, 0.310085, 2.77595, 3.30962},
                               {0.1, 0.396175, 2.32135, 3.10513},
                               {0.2, 0.507871, 1.80001, 2.96933},
                               {0.5, 0.72692, 0.923364, 2.95792}};
    for (const auto& row : table) {
        const WetDamBreak dam = solve_wet_dam_break(1, row[0], 9.81);
        CHECK(dam.h_middle == Approx(row[1]).epsilon(1e-5));
        CHECK(dam.u_middle == Approx(row[2]).epsilon(1e-5));
        CHECK(dam.shock_speed == Approx(row[3]).epsilon(1e-5));
    }
}

TEST_CASE("Stoker: the water is neither more nor less than before the break", "[exact]") {
    const WetDamBreak dam = solve_wet_dam_break(1, 0.2, 9.81);
    double volume = 0;
    const double ds = 0.001;
    for (double s = -8 + ds / 2; s < 8; s += ds) {
        volume += stoker(dam, s, 2).depth * ds;
    }
    CHECK(volume == Approx(8 * 1 + 8 * 0.2).epsilon(1e-4));
}
