// What the instruments read in still water, where it is known.

#include <catch2/catch.hpp>

#include "probes.hpp"

using namespace wade;
using namespace wade::validation;

namespace {

constexpr double d = 0.1;     // m, spacing
constexpr int layers = 8;     // of the water, in a tank of 1 m x 1 m with a wall at x = 0
constexpr double rho = 1000;  // kg/m^3

// A lattice at rest with hydrostatic pressure.
fluid::Particles still_water() {
    fluid::Particles p(1000);
    for (int i = 0; i < 10 * layers * 10; ++i) {
        const auto along = [](int k) { return static_cast<float>((k + 0.5) * d); };
        p.add({along(i % 10), along(i / 10 % layers), along(i / 10 / layers)}, {0, 0, 0}, fluid::Kind::fluid);
        const float pressure = 9.81F * (static_cast<float>(layers * d) - p.y[p.count - 1]);
        p.pressure[p.count - 1] = pressure;
    }
    return p;
}

}  // namespace

TEST_CASE("a wire in still water is wet up to the surface, wherever it stands", "[probes]") {
    const fluid::Particles p = still_water();
    for (const double x : {0.5, 0.517, 0.55}) {
        for (const double z : {0.4, 0.45, 0.49}) {
            CHECK(wet_length(p, x, z, d) == Approx(layers * d).epsilon(1e-4));
        }
    }
    CHECK(wet_length(p, 3, 0.5, d) == 0);
}

TEST_CASE("a sensor in a wall reads the hydrostatic pressure, and nothing above the water", "[probes]") {
    const fluid::Particles p = still_water();
    for (const double y : {0.3, 0.41, 0.5}) {
        CHECK(wall_pressure(p, {0, y, 0.5}, d, rho) == Approx(rho * 9.81 * (layers * d - y)).epsilon(0.02));
    }
    CHECK(wall_pressure(p, {0, layers * d + 2 * d, 0.5}, d, rho) == 0);
    // The last layer alone touches the sensor: less than half of a wet wall.
    CHECK(wall_pressure(p, {0, layers * d + 0.5 * d, 0.5}, d, rho) < 0.5 * rho * 9.81 * 0.5 * d);
}
