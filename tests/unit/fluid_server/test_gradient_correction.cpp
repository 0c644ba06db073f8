// Kernel gradients that are exact for velocities that change linearly in space.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "fluid_server/gradient_correction.hpp"
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

    // noise: largest displacement of a particle along an axis, d. shear: x += shear * y.
    Packing(float noise, float shear) : scene(scene_in_tank()), particles(n * n * n), lists(particles.capacity()) {
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
        find_neighbours(grid, Solids(scene), p, CubicSpline(2 * d), 2 * d, d * d * d, lists);
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
    [[nodiscard]] double divergence_of_shear() const {
        double squares = 0;
        int count = 0;
        for_each_list(particles.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
            if (!inside(i, 4.5F)) {
                return;
            }
            double sum = 0;
            const auto [first, last] = all_pairs(block, place);
            for (std::size_t k = first; k < last; ++k) {
                sum += static_cast<double>((particles.y[i] - particles.y[block.j[k]]) * block.gx[k]);
            }
            squares += sum * sum;
            ++count;
        });
        REQUIRE(count > 10);
        return std::sqrt(squares / count);
    }
};

}  // namespace

TEST_CASE("Corrected gradients see no divergence in a lattice that was sheared") {
    Packing packing(0, 0.3F);
    CHECK(packing.divergence_of_shear() > 1e-3);
    std::vector<Eigen::Matrix3f> corrections;
    correct_gradients(packing.particles, packing.lists, corrections);
    // All particles have the same correction, so it is exact but for rounding.
    CHECK(packing.divergence_of_shear() < 1e-5);
}

TEST_CASE("Corrected gradients see less of the divergence that a random packing feigns") {
    Packing packing(0.2F, 0);
    const double before = packing.divergence_of_shear();
    std::vector<Eigen::Matrix3f> corrections;
    correct_gradients(packing.particles, packing.lists, corrections);
    // L_i takes away half of it exactly. The other half stays, and beside it the noise of its neighbours' L_j, which is at
    // most as large and independent of it.
    CHECK(packing.divergence_of_shear() < std::sqrt(0.5) * before);
}

TEST_CASE("Corrected gradients of a pair stay opposite") {
    Packing packing(0.2F, 0.1F);
    std::vector<Eigen::Matrix3f> corrections;
    correct_gradients(packing.particles, packing.lists, corrections);
    const NeighbourLists& lists = packing.lists;
    double largest = 0;
    for_each_list(packing.particles.count, lists, [&](std::size_t i, const NeighbourBlock& block, std::size_t place) {
        const auto [first, last] = all_pairs(block, place);
        for (std::size_t k = first; k < last; ++k) {
            const std::size_t j = block.j[k];
            if (j == i) {
                continue;
            }
            const NeighbourBlock& other = lists.blocks[j / block_size];
            const auto [from, to] = all_pairs(other, j % block_size);
            for (std::size_t l = from; l < to; ++l) {
                if (other.j[l] == i) {
                    largest = std::max(largest, static_cast<double>(std::abs(block.gx[k] + other.gx[l])));
                }
            }
        }
    });
    CHECK(largest < 1e-5);  // of gradients up to 1 / d = 10
}

}  // namespace wade::fluid
