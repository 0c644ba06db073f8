#include <catch2/catch.hpp>
#include <cmath>

#include "fluid_server/filling.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

TEST_CASE("a block is filled with the mass of its water to within half a particle", "[fluid][filling]") {
    for (const double spacing : {0.4642, 0.5, 0.25, 0.3137}) {
        Particles particles(400000);
        fill_block(particles, {0, 100}, 1, {11.5, 38.5}, spacing, -1.5F);
        const double volume = static_cast<double>(particles.count) * std::pow(spacing, 3);
        CHECK(std::abs(volume - 2700) <= 0.5 * std::pow(spacing, 3) + 1e-9);
    }
}

TEST_CASE("a filled block keeps within its bounds and moves as asked", "[fluid][filling]") {
    Particles particles(5000);
    fill_block(particles, {2, 5}, 1, {-1, 1}, 0.23, -2.5F);
    REQUIRE(particles.count > 0);
    bool inside = true;
    for (std::size_t i = 0; i < particles.count; ++i) {
        inside = inside && particles.x[i] > 2 && particles.x[i] < 5 && particles.y[i] > 0 && particles.y[i] < 1 &&
                 particles.z[i] > -1 && particles.z[i] < 1 && particles.vx[i] == -2.5F;
    }
    CHECK(inside);
}

TEST_CASE("a block whose sides are multiples of the spacing becomes a perfect cubic lattice", "[fluid][filling]") {
    const Lattice lattice = lattice_over(10, 1, 2, 0.25, 40 * 4 * 8);
    CHECK(lattice.nx == 40);
    CHECK(lattice.ny == 4);
    CHECK(lattice.nz == 8);
    CHECK(lattice.dx == 0.25F);
}
