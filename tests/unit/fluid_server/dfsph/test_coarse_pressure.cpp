// The coarse grid of deep water beside the sweeps of the solver.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "fluid_server/dfsph/coarse_pressure.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/solids.hpp"
#include "scenes.hpp"

namespace wade::fluid::coarse_test {

// Water in a shaft, its lists and gradients, and what the coarse grid is made of where all of it has pressure.
struct Shaft {
    Scene scene;
    Particles p;
    NeighbourLists lists;
    ParticleFields f;
    std::vector<float> mask, cx, cy, cz;

    Shaft(double width, double depth) : scene(test::tank(width, width, depth, 0.1)), p(20000), lists(20000), f(20000) {
        const float h = 0.2F;
        CellGrid grid(scene, h);
        fill_scene(p, scene);
        grid.sort(p, -Box::inf);
        find_neighbours(grid, Solids(scene), p, h, lists);
        compute_density_and_diagonal(p, CubicSpline(h), 1e-3F, false, lists, f);
        mask.assign(padded(p.capacity()), 1);
        for (auto* c : {&cx, &cy, &cz}) c->resize(mask.size());
        gradients(mask, {cx.data(), cy.data(), cz.data()});
    }

    // sum_j (q_i + q_j) g_ij, which is -G q.
    void gradients(const std::vector<float>& q, const VectorArrays& out) const {
        for (std::size_t b = 0; b < block_count(p.count); ++b) sum_gradients(b, p, lists, q.data(), out);
        for (std::size_t i = 0; i < p.count; ++i) {
            out.x[i] += q[i] * f.gx[i];
            out.y[i] += q[i] * f.gy[i];
            out.z[i] += q[i] * f.gz[i];
        }
    }

    // |G q|^2.
    [[nodiscard]] double energy(const std::vector<float>& q) const {
        std::vector<float> x(mask.size()), y(mask.size()), z(mask.size());
        gradients(q, {x.data(), y.data(), z.data()});
        double sum = 0;
        for (std::size_t i = 0; i < p.count; ++i) sum += static_cast<double>(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        return sum;
    }

    // G^T G q.
    [[nodiscard]] std::vector<float> system(const std::vector<float>& q) const {
        std::vector<float> x(mask.size()), y(mask.size()), z(mask.size()), result(mask.size());
        gradients(q, {x.data(), y.data(), z.data()});
        for (std::size_t b = 0; b < block_count(p.count); ++b) {
            sum_divergence(b, p, lists, {x.data(), y.data(), z.data()}, result.data() + b * block_size);
        }
        for (std::size_t i = 0; i < p.count; ++i) {
            result[i] = x[i] * f.gx[i] + y[i] * f.gy[i] + z[i] * f.gz[i] - result[i];
        }
        return result;
    }
};

}  // namespace wade::fluid::coarse_test

using namespace wade;
using namespace wade::fluid;
using coarse_test::Shaft;

// Of the energy of the error, which Galerkin's correction makes least, no more than 0.25 may be left: conjugate gradients end at
// 0.3 of the residual, 0.09 of the energy; the slopes beside bed and walls, where images make them vanish, cost more.
TEST_CASE("a coarse correction takes most of a long wave of the pressure away", "[fluid][deep]") {
    const Shaft shaft(0.8, 4.8);
    const double waves = GENERATE(0.5, 1.5);
    std::vector<float> wave(shaft.mask.size()), left(shaft.mask.size());
    for (std::size_t i = 0; i < shaft.p.count; ++i) {
        wave[i] = static_cast<float>(std::cos(waves * std::numbers::pi * static_cast<double>(shaft.p.y[i]) / 4.8));
    }
    CoarsePressure coarse(shaft.scene);
    REQUIRE(coarse.place(shaft.p));
    coarse.build(shaft.p, shaft.mask, {shaft.cx.data(), shaft.cy.data(), shaft.cz.data()});
    std::vector<float> correction = shaft.system(wave);
    coarse.solve(correction);
    for (std::size_t i = 0; i < shaft.p.count; ++i) left[i] = wave[i] - correction[i];
    CHECK(shaft.energy(left) < 0.25 * shaft.energy(wave));
}

TEST_CASE("nodes with little water leave its pressure alone", "[fluid][deep]") {
    Shaft shaft(0.8, 4.8);
    // One particle far above the others has pressure, and a residual that nothing can answer.
    shaft.p.add({0.4F, 7, 0.4F}, {0, 0, 0}, Kind::fluid);
    const std::size_t last = shaft.p.count - 1;
    std::vector<float> residual(shaft.mask.size());
    residual[last] = 1;
    shaft.cx[last] = 1e-6F;
    CoarsePressure coarse(shaft.scene);
    REQUIRE(coarse.place(shaft.p));
    coarse.build(shaft.p, shaft.mask, {shaft.cx.data(), shaft.cy.data(), shaft.cz.data()});
    coarse.solve(residual);
    CHECK(residual[last] == 0);
}

TEST_CASE("there is no coarse grid over water that fills little of the box round it", "[fluid][deep]") {
    const Scene scene = test::tank(8, 8, 8, 0.1);
    Particles p(1000);
    for (int n = 0; n < 999; ++n) p.add({static_cast<float>(n % 2) * 0.1F, 0.05F, 0.05F}, {0, 0, 0}, Kind::fluid);
    CoarsePressure coarse(scene);
    CHECK(coarse.place(p));
    p.add({7.9F, 7.9F, 7.9F}, {0, 0, 0}, Kind::fluid);
    CHECK(!coarse.place(p));
}
