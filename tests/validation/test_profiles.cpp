#include <catch2/catch.hpp>
#include <cmath>

#include "profiles.hpp"

using namespace wade;
using namespace wade::validation;

TEST_CASE("columns hold all the water, whatever their length", "[profiles]") {
    fluid::Particles particles(40);
    const double d = 0.1;
    for (int i = 0; i < 10; ++i) {
        for (int j = 0; j < 4; ++j) {
            particles.add({static_cast<float>(d * (i + 0.5)), static_cast<float>(d * (j + 0.5)), 0.05F}, {-2, 0, 0},
                          fluid::Kind::fluid);
        }
    }
    for (const double column : {0.1, 0.125, 0.25, 0.35}) {
        Columns columns = make_columns({0, 1}, d, column);
        sample(particles, d, columns);
        sample(particles, d, columns);
        for (std::size_t k = 0; k < columns.count(); ++k) {
            CHECK(columns.depth(k) == Approx(0.4).epsilon(1e-5));
            CHECK(columns.velocity(k) == Approx(-2));
        }
    }
    CHECK(leading_x(particles, 1) == Approx(0.05));
}

TEST_CASE("water beyond the columns does not count", "[profiles]") {
    fluid::Particles particles(3);
    particles.add({-0.05F, 0, 0}, {1, 0, 0}, fluid::Kind::fluid);
    particles.add({0, 0, 0}, {1, 0, 0}, fluid::Kind::fluid);
    particles.add({0.5F, 0, 0}, {1, 0, 0}, fluid::Kind::inflow);
    Columns columns = make_columns({0, 1}, 0.1, 0.5);
    sample(particles, 0.1, columns);
    CHECK(columns.volume[0] == Approx(0.0005));
    CHECK(columns.volume[1] == 0);
    CHECK(columns.velocity(1) == 0);
}

TEST_CASE("quantiles", "[profiles]") {
    CHECK(quantile({3, 1, 2}, 0.5) == 2);
    CHECK(quantile({1, 2, 3, 4}, 0.5) == 2.5);
    CHECK(quantile({5}, 0.95) == 5);
    CHECK(std::isnan(quantile({}, 0.5)));
}
