// Kernel gradients that are exact for velocities that change linearly in space.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/neighbours/gradient_correction.hpp"
#include "scenes.hpp"

namespace wade::fluid {
namespace {

constexpr float d = 0.1F;
constexpr int n = 16;  // particles along an axis

// A lattice in the middle of a wide tank: what is read are the particles that see no end of it.
struct Packing {
    Scene scene;
    Particles particles;
    NeighbourLists lists;
    ParticleFields fields;

    // noise: largest displacement of a particle along an axis, d. shear: x += shear * y.
    Packing(float noise, float shear)
        : scene(scene_in_tank()), particles(n * n * n), lists(particles.capacity()), fields(particles.capacity()) {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> jitter(-noise * d, noise * d);
        Particles& p = particles;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                for (int k = 0; k < n; ++k) {
                    const auto y = static_cast<float>(j) * d + jitter(random);
                    p.x[p.count] = 2 + static_cast<float>(i) * d + jitter(random) + shear * y;
                    p.y[p.count] = 2 + y;
                    p.z[p.count] = 2 + static_cast<float>(k) * d + jitter(random);
                    p.kind[p.count++] = Kind::fluid;
                }
            }
        }
        CellGrid grid(scene, 2 * d);
        REQUIRE(grid.sort(p, -Box::inf) == 0);
        find_neighbours(grid, Solids(scene), p, 2 * d, lists);
        compute_density_and_diagonal(p, CubicSpline(2 * d), d * d * d, false, lists, fields);
    }

    static Scene scene_in_tank() {
        Scene scene;
        scene.world = {.length = 6, .width = 6};
        scene.channel.x = {0, 6};
        scene.channel.z = {0, 6};
        scene.channel.flow = Flow::closed;
        scene.channel.height = 6;
        scene.fluid = test::fluid_of(static_cast<double>(d), n * n * n);
        return scene;
    }

    // Whether particle i is at least `layers` spacings from the faces of the block.
    [[nodiscard]] bool inside(std::size_t i, float layers) const {
        const float y = particles.y[i] - 2;
        const float lo = layers * d;
        const float hi = (n - 1) * d - lo;
        const float z = particles.z[i] - 2;
        const float x = particles.x[i] - 2;
        return y > lo && y < hi && z > lo && z < hi && x > lo + 0.3F * hi && x < hi;
    }

    // Root mean square of sum_j (u_i - u_j) . g_ij over the inner particles for u = (y, 0, 0), whose divergence is zero.
    [[nodiscard]] double divergence_of_shear(const GradientCorrection* correction) const {
        const std::vector<float> zero(particles.y.size());
        const ConstVectorArrays u{particles.y.data(), zero.data(), zero.data()};
        double squares = 0;
        int count = 0;
        std::vector<float> sums(block_size);
        for (std::size_t b = 0; b < block_count(particles.count); ++b) {
            if (correction != nullptr) {
                sum_corrected_divergence(b, particles, lists, correction->arrays(), u, sums.data());
            } else {
                sum_divergence(b, particles, lists, u, sums.data());
            }
            for (std::size_t i = b * block_size; i < std::min((b + 1) * block_size, particles.count); ++i) {
                if (inside(i, 4.5F)) {
                    squares += std::pow(static_cast<double>(u.x[i] * fields.gx[i] - sums[i - b * block_size]), 2);
                    ++count;
                }
            }
        }
        REQUIRE(count > 10);
        return std::sqrt(squares / count);
    }
};

}  // namespace

TEST_CASE("Corrected gradients see no divergence in a lattice that was sheared") {
    Packing packing(0, 0.3F);
    CHECK(packing.divergence_of_shear(nullptr) > 1e-3);
    GradientCorrection correction;
    correct_gradients(packing.particles, packing.lists, correction, packing.fields);
    // All particles have the same correction, so it is exact but for rounding.
    CHECK(packing.divergence_of_shear(&correction) < 1e-5);
}

TEST_CASE("Corrected gradients see less of the divergence that a random packing feigns") {
    Packing packing(0.2F, 0);
    const double before = packing.divergence_of_shear(nullptr);
    GradientCorrection correction;
    correct_gradients(packing.particles, packing.lists, correction, packing.fields);
    // L_i takes away half of it exactly. The other half stays, and beside it the noise of its neighbours' L_j, which is at
    // most as large and independent of it.
    CHECK(packing.divergence_of_shear(&correction) < std::sqrt(0.5) * before);
}

TEST_CASE("Corrected gradients of a pair stay opposite") {
    Packing packing(0.2F, 0.1F);
    const Particles& p = packing.particles;
    GradientCorrection correction;
    correct_gradients(p, packing.lists, correction, packing.fields);
    // Then a force p_i h_ij on i and one p_i h_ji on j add up to nothing: sum_i sum_j (p_i + p_j) h_ij is zero.
    std::mt19937 random(2);
    std::uniform_real_distribution<float> any(0, 1);
    std::vector<float> pressure(p.x.size());
    for (std::size_t i = 0; i < p.count; ++i) {
        pressure[i] = any(random);
    }
    std::vector<float> x(p.x.size());
    std::vector<float> y(p.x.size());
    std::vector<float> z(p.x.size());
    double total = 0;
    double size = 0;
    for (std::size_t b = 0; b < block_count(p.count); ++b) {
        sum_corrected_gradients(b, p, packing.lists, correction.arrays(), pressure.data(),
                                {x.data(), y.data(), z.data()});
    }
    for (std::size_t i = 0; i < p.count; ++i) {
        const double force = static_cast<double>(pressure[i] * packing.fields.gx[i] + x[i]);
        total += force;
        size += std::abs(force);
    }
    CHECK(std::abs(total) < 1e-5 * size);
    CHECK(size > 1);
}

}  // namespace wade::fluid
