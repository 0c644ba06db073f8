// The vectorised sums against plain loops over all pairs, and kernel gradients that are exact for velocities that change linearly.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/neighbours/gradient_correction.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// Random water in the corner of a tank: bed, bank and end wall are near.
struct Corner {
    Scene scene;
    Kernel kernel;
    float h, volume;
    Particles particles;
    NeighbourLists lists;
    ParticleFields fields;

    explicit Corner(KernelKind kind)
        : scene(test::tank(2, 2, 1, 0.1)),
          kernel(CubicSpline(1)),
          h(0),
          volume(1e-3F),
          particles(600),
          lists(600),
          fields(600) {
        scene.fluid->kernel = kind;
        kernel = make_kernel(scene.fluid);
        h = static_cast<float>(support_radius_of(scene.fluid));
        std::mt19937 random(11);
        std::uniform_real_distribution<float> in(0.02F, 0.8F);
        std::uniform_real_distribution<float> any(-1, 1);
        for (int n = 0; n < 555; ++n) {  // not a multiple of a cluster
            particles.add({in(random), in(random), in(random)}, {any(random), any(random), any(random)}, Kind::fluid,
                          1 + any(random));
        }
        CellGrid grid(scene, h);
        grid.sort(particles, -Box::inf);
        find_neighbours(grid, Solids(scene), particles, h, lists);
        compute_density_and_diagonal(particles, kernel, volume, true, lists, fields);
    }

    // Calls body(i, j, R, x_i - R-image of x_j) for all pairs and images nearer than h.
    template <typename Body>
    void for_each(std::size_t i, Body&& body) const {
        const Particles& p = particles;
        for (std::size_t j = 0; j < p.count; ++j) {
            for (int mirror = 0; mirror < 8; ++mirror) {
                const std::array<double, 3> r{(mirror & 1) != 0 ? -1.0 : 1.0, (mirror & 2) != 0 ? -1.0 : 1.0,
                                              (mirror & 4) != 0 ? -1.0 : 1.0};
                const std::array<double, 3> way{static_cast<double>(p.x[i]) - r[0] * static_cast<double>(p.x[j]),
                                                static_cast<double>(p.y[i]) - r[1] * static_cast<double>(p.y[j]),
                                                static_cast<double>(p.z[i]) - r[2] * static_cast<double>(p.z[j])};
                const double distance = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
                if (distance < static_cast<double>(h)) {
                    body(j, r, way, distance);
                }
            }
        }
    }
    [[nodiscard]] double weight(double r) const {
        return static_cast<double>(volume) *
               std::visit([&](const auto& k) { return static_cast<double>(k.value(static_cast<float>(r))); }, kernel);
    }
    [[nodiscard]] double factor(double r) const {
        return static_cast<double>(volume) *
               std::visit([&](const auto& k) { return static_cast<double>(k.gradient_factor(static_cast<float>(r))); },
                          kernel);
    }
};

}  // namespace

TEST_CASE("the sums of a sweep are those of a loop over all pairs and images", "[fluid][sweeps]") {
    const Corner corner(GENERATE(KernelKind::cubic_spline, KernelKind::quartic_spline, KernelKind::wendland_c2));
    const Particles& p = corner.particles;
    const VectorArrays velocity{const_cast<float*>(p.vx.data()), const_cast<float*>(p.vy.data()),
                                const_cast<float*>(p.vz.data())};
    std::vector<float> divergence(p.x.size() + block_size);
    std::vector<float> together(p.x.size() + block_size);
    std::vector<float> fx(p.x.size()), fy(p.x.size()), fz(p.x.size());
    std::vector<float> gx(p.x.size()), gy(p.x.size()), gz(p.x.size());
    const std::vector<float>&sx = corner.fields.ax, &sz = corner.fields.az;
    for (std::size_t b = 0; b < block_count(p.count); ++b) {
        sum_divergence(b, p, corner.lists, velocity, divergence.data() + b * block_size);
        sum_gradients(b, p, corner.lists, p.pressure.data(), {gx.data(), gy.data(), gz.data()});
        sum_gradients_and_divergence(b, p, corner.lists, p.pressure.data(), {fx.data(), fy.data(), fz.data()}, velocity,
                                     together.data() + b * block_size);
    }
    // One sweep for two sums gives the bits of two sweeps.
    CHECK(std::equal(gx.begin(), gx.begin() + static_cast<std::ptrdiff_t>(p.count), fx.begin()));
    CHECK(std::equal(gz.begin(), gz.begin() + static_cast<std::ptrdiff_t>(p.count), fz.begin()));
    CHECK(std::equal(divergence.begin(), divergence.begin() + static_cast<std::ptrdiff_t>(p.count), together.begin()));
    // A factor is a multiple of 1.5e-5 of its value at r = 0, and off by half of that at most: times the support radius and
    // the 200 neighbours and images that the densest particle has, all with the same sign, 1e-2 / m; by chance, as they are,
    // a tenth of it. Sums are of the order of 100 / m.
    const double margin = 1e-3 * std::abs(corner.factor(0)) * static_cast<double>(corner.h);
    for (std::size_t i = 0; i < p.count; ++i) {
        double density = 0;
        double sum_divergences = 0;
        std::array<double, 3> gradients{};
        std::array<double, 3> shear{};
        double squares = 0;
        std::array<double, 3> all{};
        corner.for_each(i, [&](std::size_t j, const auto& r, const auto& way, double distance) {
            const double f = corner.factor(distance);
            const std::array<double, 3> u{static_cast<double>(p.vx[j]), static_cast<double>(p.vy[j]),
                                          static_cast<double>(p.vz[j])};
            const std::array<double, 3> own{static_cast<double>(p.vx[i]), static_cast<double>(p.vy[i]),
                                            static_cast<double>(p.vz[i])};
            density += corner.weight(distance);
            for (std::size_t a = 0; a < 3; ++a) {
                sum_divergences += r[a] * u[a] * f * way[a];
                gradients[a] += static_cast<double>(p.pressure[j]) * f * way[a];
                shear[a] += (own[a] - r[a] * u[a]) * f;
                all[a] += f * way[a];
                squares += f * way[a] * f * way[a];
            }
        });
        REQUIRE(static_cast<double>(corner.fields.density[i]) == Approx(density).epsilon(1e-5));
        REQUIRE(static_cast<double>(corner.fields.gx[i]) == Approx(all[0]).margin(margin));
        REQUIRE(static_cast<double>(corner.fields.inverse_diagonal[i]) ==
                Approx(1 / (all[0] * all[0] + all[1] * all[1] + all[2] * all[2] + squares)).epsilon(1e-3));
        REQUIRE(static_cast<double>(divergence[i]) == Approx(sum_divergences).margin(margin));
        REQUIRE(static_cast<double>(gx[i]) == Approx(gradients[0]).margin(margin));
        REQUIRE(static_cast<double>(gy[i]) == Approx(gradients[1]).margin(margin));
        REQUIRE(static_cast<double>(gz[i]) == Approx(gradients[2]).margin(margin));
        REQUIRE(static_cast<double>(sx[i]) == Approx(shear[0]).margin(margin / static_cast<double>(corner.h)));
        REQUIRE(static_cast<double>(sz[i]) == Approx(shear[2]).margin(margin / static_cast<double>(corner.h)));
    }
}

TEST_CASE("the forces between two particles are opposite to the last bit of their factor", "[fluid][sweeps]") {
    const Corner corner(KernelKind::cubic_spline);
    std::size_t pairs = 0;
    std::size_t different = 0;
    std::vector<std::vector<std::pair<std::size_t, float>>> own(corner.particles.count);
    NeighbourLists lists = corner.lists;
    lists.x = corner.particles.x, lists.y = corner.particles.y, lists.z = corner.particles.z;
    for (std::size_t b = 0; b < block_count(lists.count); ++b) {
        for_each_pair(lists, b, [&](const ListedPair& pair) {
            const PlaneMap& r = pair.view.map.rotation;
            if (r.xx > 0 && r.yy > 0 && r.zz > 0) {
                own[pair.i].emplace_back(pair.j, pair.factor);
            }
        });
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
        for (const auto& [j, factor] : own[i]) {
            ++pairs;
            bool same = false;
            for (const auto& [back, other] : own[j]) {
                same = same || (back == i && other == factor);
            }
            different += same ? 0U : 1U;
        }
    }
    CHECK(pairs > 10000);
    CHECK(different == 0);
}

namespace wade::fluid {
namespace {

constexpr float packing_d = 0.1F;
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
        std::uniform_real_distribution<float> jitter(-noise * packing_d, noise * packing_d);
        Particles& p = particles;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                for (int k = 0; k < n; ++k) {
                    const auto y = static_cast<float>(j) * packing_d + jitter(random);
                    p.x[p.count] = 2 + static_cast<float>(i) * packing_d + jitter(random) + shear * y;
                    p.y[p.count] = 2 + y;
                    p.z[p.count] = 2 + static_cast<float>(k) * packing_d + jitter(random);
                    p.kind[p.count++] = Kind::fluid;
                }
            }
        }
        CellGrid grid(scene, 2 * packing_d);
        REQUIRE(grid.sort(p, -Box::inf) == 0);
        find_neighbours(grid, Solids(scene), p, 2 * packing_d, lists);
        compute_density_and_diagonal(p, CubicSpline(2 * packing_d), packing_d * packing_d * packing_d, false, lists,
                                     fields);
    }

    static Scene scene_in_tank() {
        Scene scene;
        scene.world = {.length = 6, .width = 6};
        scene.channel->x = {0, 6};
        scene.channel->z = {0, 6};
        scene.channel->flow = Flow::closed;
        scene.channel->height = 6;
        scene.fluid = test::fluid_of(static_cast<double>(packing_d), n * n * n);
        return scene;
    }

    // Whether particle i is at least `layers` spacings from the faces of the block.
    [[nodiscard]] bool inside(std::size_t i, float layers) const {
        const float y = particles.y[i] - 2;
        const float lo = layers * packing_d;
        const float hi = (n - 1) * packing_d - lo;
        const float z = particles.z[i] - 2;
        const float x = particles.x[i] - 2;
        return y > lo && y < hi && z > lo && z < hi && x > lo + 0.3F * hi && x < hi;
    }

    // Returns the root mean square of sum_j (u_i - u_j) . g_ij over inner particles for u = (y, 0, 0), divergence 0.
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
