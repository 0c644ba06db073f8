// Visibility past walls at any angle: each position round a particle is seen once, and visibility is symmetric.

#include <omp.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "configs/scene/world.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace wade::fluid::billiard_test {

using test::house_of;
using test::SiteTank;

// Lists, densities and gradients of particles on a site.
struct Seen {
    Particles particles;
    NeighbourLists lists;
    ParticleFields fields;

    // spacing: of the particles, whatever the scene's
    Seen(const Scene& scene, const SiteSolids& solids, const Particles& all, double spacing)
        : particles(all), lists(all.capacity()), fields(all.capacity()) {
        CellGrid grid(scene, static_cast<float>(support_radius_of(scene.fluid)));
        grid.sort(particles, -Box::inf);
        find_neighbours(grid, solids, particles, static_cast<float>(support_radius_of(scene.fluid)), lists);
        compute_density_and_diagonal(particles, make_kernel(scene.fluid),
                                     static_cast<float>(spacing * spacing * spacing), false, lists, fields);
        lists.x = particles.x, lists.y = particles.y, lists.z = particles.z;
    }
};

// The densities of a fine lattice, turned so that no wall runs along it, round a corner at a point of the map.
struct Range {
    double least = 2, most = 0;
};
Range densities_round(const MapPoint& corner, const Scene& scene) {
    const SiteSolids solids = test::solids_of(scene);
    constexpr double fine = 0.02, reach = 0.44, asked_within = 0.2, cosine = 0.9844, sine = 0.1759;
    Particles p(40000);
    for (double a = -reach; a < reach; a += fine) {
        for (double b = -reach; b < reach; b += fine) {
            const Vec3 x{static_cast<float>(corner.x + cosine * a - sine * b), 0,
                         static_cast<float>(corner.z + sine * a + cosine * b)};
            if (std::hypot(a, b) > reach || !solids.is_water(x)) continue;
            for (double y = fine / 2; y < 0.4; y += fine)
                p.add({x[0], 1 + static_cast<float>(y), x[2]}, {}, Kind::fluid);
        }
    }
    const Seen seen(scene, solids, p, fine);
    Range range;
    for (std::size_t i = 0; i < seen.particles.count; ++i) {
        const Vec3 x{seen.particles.x[i], seen.particles.y[i], seen.particles.z[i]};
        Vec3 away = x;
        solids.keep_away(away, 0.04F);  // no centre comes nearer
        const double from_corner =
            std::hypot(static_cast<double>(x[0]) - corner.x, static_cast<double>(x[2]) - corner.z);
        if (from_corner > asked_within || std::abs(x[1] - 1.2F) > 0.011F || away != x) continue;
        const auto density = static_cast<double>(seen.fields.density[i]);
        range = {std::min(range.least, density), std::max(range.most, density)};
    }
    return range;
}

TEST_CASE("in corners of any angle every place round a particle is filled once", "[billiard]") {
    const double angle = GENERATE(90, 80, 100, 60, 120);
    const SiteTank tank{2, 2, 17, angle};
    const Range range = densities_round(tank.at(-1, -1), test::site_scene(tank, 0, 0.1));
    // Walls cut cells of 0.02 m, which are full or empty: within 0.2 m that is 4 %, twice with the images. An image too many or too
    // few in a corner is more than 12 %.
    CHECK(range.least > 0.92);
    CHECK(range.most < 1.08);
}

TEST_CASE("round the edges of houses every place is filled once, to what soft sight leaves", "[billiard]") {
    const double turned = 45;
    const SiteTank tank{3, 3, turned};
    Scene scene = test::site_scene(tank, 0, 0.1);
    // An L, with edges of 90 degrees and an inner corner.
    scene.site->houses.push_back(house_of({{tank.at(-0.5, -0.5), tank.at(0.5, -0.5), tank.at(0.5, 0), tank.at(0, 0),
                                            tank.at(0, 0.5), tank.at(-0.5, 0.5)}}));
    for (const MapPoint& corner : {tank.at(-0.5, -0.5), tank.at(0.5, 0), tank.at(0, 0)}) {
        const Range range = densities_round(corner, scene);
        CHECK(range.least > 0.92);
        CHECK(range.most < 1.08);
    }
}

TEST_CASE("images are one if they lie in one place, however far from the origin", "[billiard]") {
    const float away = GENERATE(1.0F, 100.0F, 2000.0F);
    const Vec3 at{away, 0, away}, n{0.6F, 0, 0.8F}, across{0.8F, 0, -0.6F};
    const auto mirrored = [&](const TurnedMap& after, const Vec3& normal, float beyond) {
        return reflected_first(after, normal, normal[0] * at[0] + normal[2] * at[2] + beyond);
    };
    const float h = 0.2F, beyond = 0.05F;
    const TurnedMap one = mirrored(mirrored({}, n, beyond), across, beyond);
    const TurnedMap other = mirrored(mirrored({}, across, beyond), n, beyond);  // walls at right angles commute
    CHECK(is_same(one, other, at, h));
    CHECK_FALSE(is_same(mirrored({}, n, beyond), mirrored({}, n, beyond + 0.02F), at, h));  // 2 cm out of line
}

TEST_CASE("a front in many pieces mirrors as one in one piece", "[billiard]") {
    const double pieces = GENERATE(4, 12);
    const int ground = GENERATE(0, 1);
    const double gap = 0.06;    // so narrow that paths go from one front to the other and back
    const double joint = 5e-4;  // half the width of what is between pieces
    const SiteTank tank{1.2, 1.2, 17, 90, 5};
    const auto scene_of = [&](double in_pieces) {
        Scene scene = test::site_scene(tank, 0, 0.1);
        if (ground == 1) scene.site->ground.slope_x = 0.2;
        std::vector<MapPoint> front{tank.at(-0.5, 0.4), tank.at(-0.5, gap / 2)};
        for (double n = 1; n < in_pieces; ++n) {
            const double x = -0.5 + n / in_pieces;
            for (const auto& [away, z] :
                 {std::pair{-joint, gap / 2}, {-joint, gap / 2 + joint}, {joint, gap / 2 + joint}, {joint, gap / 2}})
                front.push_back(tank.at(x + away, z));
        }
        front.push_back(tank.at(0.5, gap / 2)), front.push_back(tank.at(0.5, 0.4));
        scene.site->houses.push_back(house_of({front}));
        scene.site->houses.push_back(
            house_of({{tank.at(-0.5, -0.4), tank.at(0.5, -0.4), tank.at(0.5, -gap / 2), tank.at(-0.5, -gap / 2)}}));
        return scene;
    };
    Particles particles(600);
    std::mt19937 numbers(5);
    const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(numbers); };
    const Scene whole = scene_of(1);
    const SiteSolids solids = test::solids_of(whole);
    while (particles.count < 500) {
        const MapPoint at = tank.at(in(-0.45, 0.45), in(-0.02, 0.02));
        Vec3 x{static_cast<float>(at.x), 0, static_cast<float>(at.z)};
        x[1] = solids.ground().at(x[0], x[2]).height(x[0], x[2]) + static_cast<float>(in(0.04, 0.4));
        particles.add(x, {}, Kind::fluid);
    }
    const Seen by_one(whole, solids, particles, 0.1);
    const Scene other = scene_of(pieces);
    const Seen by_many(other, test::solids_of(other), particles, 0.1);
    float worst = 0;
    for (std::size_t i = 0; i < particles.count; ++i)
        worst = std::max(worst, std::abs(by_many.fields.density[i] / by_one.fields.density[i] - 1));
    CHECK(worst < 0.2F);  // 0.13 in four pieces as in twelve, as sight fades at the joints; images left out are a third
}

struct Felt {
    std::array<float, 3> felt, gradient;
};

TEST_CASE("forces between particles of a site are opposite, whatever stands between them", "[billiard]") {
    const double turned = GENERATE(0, 17);
    const int ground = GENERATE(0, 1, 2);
    const SiteTank tank{1.2, 1.2, turned, 80};
    Scene scene = test::site_scene(tank, 0, 0.1);
    scene.site->houses.push_back(house_of({{tank.at(-0.3, -0.3), tank.at(0.3, -0.3), tank.at(0.3, 0), tank.at(0, 0),
                                            tank.at(0, 0.3), tank.at(-0.3, 0.3)}}));
    if (ground == 1) scene.site->ground.slope_x = 0.2;
    if (ground == 2) {
        const auto raster = std::make_shared<Raster>();
        raster->cell = 0.1, raster->columns = raster->rows = 42;
        for (int n = 0; n < 42 * 42; ++n)
            raster->values.push_back(0.15 * std::sin(0.15 * (n % 42)) * std::cos(0.13 * (n / 42)));
        scene.site->ground.raster = raster;
    }
    const SiteSolids solids = test::solids_of(scene);
    Particles particles(2000);
    std::mt19937 numbers(7);
    std::uniform_real_distribution<float> plan(1.2F, 2.8F), height(0, 0.5F);
    while (particles.count < 1200) {
        Vec3 x{plan(numbers), 0, plan(numbers)};
        if (!solids.is_water(x)) continue;
        x[1] = solids.ground().at(x[0], x[2]).height(x[0], x[2]) + height(numbers);
        solids.keep_away(x, 0.04F);
        if (solids.is_water(x)) particles.add(x, {}, Kind::fluid);
    }
    const Seen seen(scene, solids, particles, 0.1);
    // g_ji = - Q g_ij: what j has in its list is minus what i feels.
    std::multimap<std::pair<std::size_t, std::size_t>, Felt> pairs;
    for (std::size_t b = 0; b < block_count(seen.particles.count); ++b) {
        for_each_pair(seen.lists, b, [&](const ListedPair& pair) {
            if (pair.i != pair.j) pairs.insert({{pair.i, pair.j}, {pair.felt(), pair.gradient}});
        });
    }
    double all = 0, without_answer = 0;
    for (const auto& [between, one] : pairs) {
        const auto [first, last] = pairs.equal_range({between.second, between.first});
        const double size = std::hypot(std::hypot(static_cast<double>(one.felt[0]), static_cast<double>(one.felt[1])),
                                       static_cast<double>(one.felt[2]));
        const bool answered = std::any_of(first, last, [&](const auto& other) {
            float off = 0;
            for (std::size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(other.second.gradient[k] + one.felt[k]));
            return off < 2e-3F + 1e-3F * static_cast<float>(size);
        });
        all += size;
        without_answer += answered ? 0 : size;
    }
    REQUIRE(pairs.size() > 50000);
    // What has none: paths that rounding lets end at an edge on one side only, or under another triangle of the ground.
    CHECK(without_answer < (ground == 0 ? 1e-4 : 1e-3) * all);
}

namespace {

// A neighbour that a particle sees: its index, its map and its visible fraction, in the order of the list.
struct SeenByMap {
    std::uint32_t j;
    TurnedMap map;
    unsigned share;  // of 65535
    bool operator==(const SeenByMap&) const = default;
};
using SeenInOrder = std::vector<std::vector<SeenByMap>>;

SeenInOrder seen_in_order(const CellGrid& grid, const SiteSolids& solids, const Particles& p, float h) {
    SeenInOrder seen(padded(p.count));
    test::for_each_seen(grid, solids, p, h,
                        [&](std::size_t i, std::uint32_t j, const auto&, const auto* turned, unsigned share) {
                            seen[i].push_back({j, turned->map, share});
                        });
    seen.resize(p.count);
    return seen;
}

// Four houses of random triangles and boxes, close together, on level, sloping or rough ground.
Scene scene_of_lanes(std::mt19937& random, int ground) {
    const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
    const SiteTank tank{2.6, 2.6, in(0, 90), in(60, 120), 5};
    Scene scene = test::site_scene(tank, 0, 0.1);
    for (int n = 0; n < 4; ++n) {
        const double x = in(-0.2, 0.2) + (n % 2 == 0 ? -0.5 : 0.5), z = in(-0.2, 0.2) + (n / 2 == 0 ? -0.5 : 0.5);
        const double turned = in(0, 6.3), size = in(0.2, 0.5);
        std::vector<MapPoint> corners;
        const int count = n % 2 == 0 ? 4 : 3;
        for (int c = 0; c < count; ++c) {
            const double angle = turned + 6.283185 * c / count;
            corners.push_back(tank.at(x + size * std::cos(angle), z + size * std::sin(angle)));
        }
        scene.site->houses.push_back(house_of({corners}));
    }
    if (ground == 1) scene.site->ground.slope_x = 0.2;
    if (ground == 2) {
        const auto raster = std::make_shared<Raster>();
        raster->cell = 0.1, raster->columns = raster->rows = 60;
        for (int n = 0; n < 60 * 60; ++n) raster->values.push_back(in(0, 0.03) + 0.1 * std::sin(0.15 * (n % 60)));
        scene.site->ground.raster = raster;
    }
    return scene;
}

Particles particles_of_lanes(const SiteSolids& solids, const MapPoint& middle, std::mt19937& random) {
    const auto in = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
    const auto mx = static_cast<float>(middle.x), mz = static_cast<float>(middle.z);
    Particles particles(4000);
    while (particles.count < 3000) {
        Vec3 x{mx + in(-1.3F, 1.3F), 0, mz + in(-1.3F, 1.3F)};
        if (!solids.is_water(x)) continue;
        x[1] = solids.ground().at(x[0], x[2]).height(x[0], x[2]) + in(0, 0.3F);
        solids.keep_away(x, 0.04F);
        if (solids.is_water(x)) particles.add(x, {}, Kind::fluid);
    }
    return particles;
}

// The same with others before them, far away: in clusters of any size each has other company.
SeenInOrder seen_in_other_company(const Scene& scene, const SiteSolids& solids, const Particles& p, float h) {
    constexpr std::uint32_t others = 3;
    Particles all(p.capacity());
    for (std::uint32_t k = 0; k < others; ++k) all.add({0.1F, 0.1F, 0.1F}, {}, Kind::fluid);
    for (std::size_t i = 0; i < p.count; ++i) all.add({p.x[i], p.y[i], p.z[i]}, {}, Kind::fluid);
    CellGrid grid(scene, h);
    grid.sort(all, -Box::inf);
    SeenInOrder seen = seen_in_order(grid, solids, all, h);
    seen.erase(seen.begin(), seen.begin() + others);
    for (auto& of_one : seen) {
        for (SeenByMap& one : of_one) one.j -= others;
    }
    return seen;
}

}  // namespace

TEST_CASE("whom a particle sees among houses does not depend on who is in its cluster", "[billiard]") {
    const int ground = GENERATE(0, 1, 2);
    std::mt19937 random(11);
    std::size_t in_part = 0, differ = 0;
    for (int trial = 0; trial < 20; ++trial) {
        const Scene scene = scene_of_lanes(random, ground);
        const SiteSolids solids = test::solids_of(scene);
        Particles p = particles_of_lanes(solids, SiteTank{2.6, 2.6, 0, 90, 5}.at(0, 0), random);
        const auto h = static_cast<float>(support_radius_of(scene.fluid));
        CellGrid grid(scene, h);
        grid.sort(p, -Box::inf);
        use_widest_vectors(false);
        const SeenInOrder narrow = seen_in_order(grid, solids, p, h);
        use_widest_vectors(true);
        const SeenInOrder wide = seen_in_order(grid, solids, p, h);
        const SeenInOrder in_other_company = seen_in_other_company(scene, solids, p, h);
        for (std::size_t i = 0; i < p.count; ++i) {
            differ += wide[i] == narrow[i] && in_other_company[i] == narrow[i] ? 0U : 1U;
            for (const SeenByMap& one : wide[i]) in_part += one.share < 65535 ? 1U : 0U;
        }
    }
    CHECK(differ == 0);
    CHECK(in_part > 1000);
}

TEST_CASE("a tank of a site sees what the same tank of a channel sees", "[billiard]") {
    Scene channel = test::tank(1.2, 1.2, 0.6, 0.1);
    Particles particles(2000);
    std::mt19937 numbers(3);
    std::uniform_real_distribution<float> plan(0.05F, 1.15F), height(0.05F, 0.5F);
    while (particles.count < 900) particles.add({plan(numbers), height(numbers), plan(numbers)}, {}, Kind::fluid);
    const auto h = static_cast<float>(support_radius_of(channel.fluid));
    CellGrid grid(channel, h);
    grid.sort(particles, -Box::inf);
    NeighbourLists of_channel(particles.capacity());
    ParticleFields expected(particles.capacity());
    find_neighbours(grid, Solids(channel), particles, h, of_channel);
    compute_density_and_diagonal(particles, make_kernel(channel.fluid), 1e-3F, false, of_channel, expected);
    Scene with_site = channel;
    with_site.world->length = with_site.world->width = 1.2;
    with_site.site = Site{};
    const Seen seen(with_site, test::solids_of(with_site), particles, 0.1);
    // The grid of a site is higher, which changes the order.
    for (std::size_t i = 0; i < particles.count; ++i) {
        const auto at = std::find(seen.particles.x.begin(), seen.particles.x.end(), particles.x[i]);
        const auto same = static_cast<std::size_t>(at - seen.particles.x.begin());
        REQUIRE(same < particles.count);
        CHECK(seen.fields.density[same] == Approx(expected.density[i]).epsilon(1e-4));
        CHECK(seen.fields.gx[same] == Approx(expected.gx[i]).margin(5e-3));  // of up to 40 / m
        CHECK(seen.fields.gy[same] == Approx(expected.gy[i]).margin(5e-3));
        CHECK(seen.fields.gz[same] == Approx(expected.gz[i]).margin(5e-3));
    }
}

TEST_CASE("maps of walls turn vectors and their transposed turn them back", "[billiard]") {
    const float s = std::sqrt(0.5F);
    const TurnedMap one = reflected_first({}, {s, 0, s}, 1), both = reflected_first(one, {0.6F, 0.8F, 0}, -2);
    const Vec3 x{0.3F, -1.2F, 2};
    const Vec3 image = one(x), twice = one(image);
    CHECK(s * (image[0] + x[0]) / 2 + s * (image[2] + x[2]) / 2 == Approx(1));  // the middle lies in the wall
    for (std::size_t k = 0; k < 3; ++k) CHECK(twice[k] == Approx(x[k]));
    const Vec3 there = both.turn(x), back = both.turn.back(there);
    for (std::size_t k = 0; k < 3; ++k) CHECK(back[k] == Approx(x[k]));
    const Vec3 in_turn = one(reflected_first({}, {0.6F, 0.8F, 0}, -2)(x)), at_once = both(x);
    for (std::size_t k = 0; k < 3; ++k) CHECK(at_once[k] == Approx(in_turn[k]));
}

TEST_CASE("water on a site has the same bits for any threads and vectors", "[billiard]") {
    const SiteTank tank{1, 0.8, 17};
    Scene scene = test::site_scene(tank, 0.4, 0.1);
    scene.site->houses.push_back(house_of({{tank.at(-0.2, -0.2), tank.at(0.2, -0.1), tank.at(0, 0.2)}}));
    scene.site->ground.slope_x = 0.05;
    const auto run = [&](int threads, bool widest) {
        omp_set_num_threads(threads);
        use_widest_vectors(widest);
        FluidWorld world(scene);
        for (int k = 0; k < 3; ++k) world.step(0.01);
        omp_set_num_threads(omp_get_num_procs());
        use_widest_vectors(true);
        return world.particles();
    };
    const Particles one = run(1, true);
    REQUIRE(one.count > 200);
    for (const auto& [threads, widest] : {std::pair{2, true}, std::pair{1, false}}) {
        const Particles other = run(threads, widest);
        REQUIRE(other.count == one.count);
        INFO(threads << " threads, widest vectors " << widest);
        CHECK(std::equal(one.x.begin(), one.x.begin() + static_cast<std::ptrdiff_t>(one.count), other.x.begin()));
        CHECK(std::equal(one.vy.begin(), one.vy.begin() + static_cast<std::ptrdiff_t>(one.count), other.vy.begin()));
    }
}

}  // namespace wade::fluid::billiard_test
