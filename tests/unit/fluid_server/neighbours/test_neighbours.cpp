#include <omp.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/obstacle.hpp"
#include "fluid_server/neighbours/cluster_positions.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/neighbours/sight.hpp"
#include "fluid_server/neighbours/sweeps.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

Particles random_particles(const Scene& scene, std::size_t n) {
    Particles particles(static_cast<std::size_t>(scene.fluid->max_particles));
    std::mt19937 random(7);
    const auto in = [&](double lo, double hi) {
        return static_cast<float>(std::uniform_real_distribution<double>(lo, hi)(random));
    };
    for (std::size_t i = 0; i < n; ++i) {
        particles.add(
            {in(scene.channel->x.lo, scene.channel->x.hi), in(0, 2), in(scene.channel->z.lo, scene.channel->z.hi)},
            {static_cast<float>(i), 0, 0}, Kind::fluid);
    }
    return particles;
}

float nearest_image(float d, float period) {
    return period > 0 ? d - period * std::round(d / period) : d;
}

}  // namespace

TEST_CASE("the search finds exactly the pairs that a double loop finds", "[fluid][neighbours]") {
    Scene scene = test::tank(6, 5, 1, 0.3);
    const bool periodic = GENERATE(false, true);
    if (periodic) {
        scene.channel->flow = Flow::recirculating;
        scene.channel->sides = Sides::periodic;
        scene.channel->top = Top::periodic;
        scene.channel->height = 2;
    }
    const float h = 0.6F;
    Particles p = random_particles(scene, 2000);
    CellGrid grid(scene, h);
    CHECK(grid.sort(p, -Box::inf) == 0);
    NeighbourLists lists(p.capacity());
    const Solids solids(scene);
    find_neighbours(grid, solids, p, h, lists);

    const float px = periodic ? 6.0F : 0.0F;
    const float py = periodic ? 2.0F : 0.0F;
    const float pz = periodic ? 5.0F : 0.0F;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        std::vector<std::uint32_t> expected;
        for (std::size_t j = 0; j < p.count; ++j) {
            const float dx = nearest_image(p.x[i] - p.x[j], px);
            const float dy = nearest_image(p.y[i] - p.y[j], py);
            const float dz = nearest_image(p.z[i] - p.z[j], pz);
            if (j != i && dx * dx + dy * dy + dz * dz < h * h) {
                expected.push_back(static_cast<std::uint32_t>(j));
            }
        }
        std::vector<std::uint32_t> found;
        const NeighbourBlock& block = lists.blocks[i / block_size];
        for_each_segment(block, i % block_size / lists.cluster_size,
                         [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
                             const PlaneMap& r = view.map.rotation;
                             if (r.xx < 0 || r.yy < 0 || r.zz < 0) {
                                 return;  // images in the walls
                             }
                             const Vec3 at = view.map({p.x[i], p.y[i], p.z[i]});
                             for (std::size_t k = first; k < last; ++k) {
                                 const std::uint32_t j = block.j[k];
                                 const float dx = at[0] - p.x[j];
                                 const float dy = at[1] - p.y[j];
                                 const float dz = at[2] - p.z[j];
                                 if (j != i && dx * dx + dy * dy + dz * dz < h * h) {
                                     found.push_back(j);
                                 }
                             }
                         });
        std::sort(found.begin(), found.end());
        wrong += found == expected ? 0U : 1U;
    }
    // Rounding may decide differently about a pair at the support radius, to seven digits: none here.
    CHECK(wrong == 0);
}

TEST_CASE("every particle of a list is near some particle of its cluster", "[fluid][neighbours]") {
    const Scene scene = test::tank(6, 5, 1, 0.3);
    const float h = 0.6F;
    Particles p = random_particles(scene, 2000);
    CellGrid grid(scene, h);
    grid.sort(p, -Box::inf);
    NeighbourLists lists(p.capacity());
    find_neighbours(grid, Solids(scene), p, h, lists);
    int far = 0;
    for (std::size_t i = 0; i < p.count; i += lists.cluster_size) {
        const NeighbourBlock& block = lists.blocks[i / block_size];
        for_each_segment(block, i % block_size / lists.cluster_size,
                         [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
                             for (std::size_t k = first; k < last; ++k) {
                                 float nearest = Box::inf;
                                 for (std::size_t l = i; l < std::min(i + lists.cluster_size, p.count); ++l) {
                                     const Vec3 at = view.map({p.x[l], p.y[l], p.z[l]});
                                     nearest =
                                         std::min(nearest, std::hypot(at[0] - p.x[block.j[k]], at[1] - p.y[block.j[k]],
                                                                      at[2] - p.z[block.j[k]]));
                                 }
                                 far += nearest < h + 1e-5F ? 0 : 1;
                             }
                         });
    }
    CHECK(far == 0);
}

TEST_CASE("sorting keeps each particle's values together and drops what has left", "[fluid][neighbours]") {
    const Scene scene = test::emitter_channel(1, 1, 5000);
    Particles p = random_particles(scene, 3000);
    for (std::size_t i = 0; i < p.count; ++i) {
        p.vy[i] = p.x[i];
    }
    CellGrid grid(scene, 0.9284F);
    std::size_t left = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        left += p.x[i] <= 3 ? 1U : 0U;
    }
    CHECK(grid.sort(p, 3) == left);
    CHECK(p.count == 3000 - left);
    bool together = true;
    for (std::size_t i = 0; i < p.count; ++i) {
        together = together && p.vy[i] == p.x[i] && p.x[i] > 3;
    }
    CHECK(together);
}

TEST_CASE("sorting gives the same order for any number of threads, and keeps an order that it made",
          "[fluid][neighbours]") {
    const Scene scene = test::emitter_channel(1, 1, 8000);
    const int before = omp_get_max_threads();
    // Three times: as they come, again, and after half of them have moved.
    const auto orders = [&](int threads) {
        omp_set_num_threads(threads);
        Particles p = random_particles(scene, 7000);
        CellGrid grid(scene, 0.9284F);
        std::vector<std::vector<float>> numbers;
        for (const float outflow_x : {3.0F, 3.0F, 5.0F}) {
            if (numbers.size() == 2) {
                for (std::size_t i = 0; i < p.count; i += 2) p.x[i] += 1;
            }
            grid.sort(p, outflow_x);
            numbers.emplace_back(p.vx.begin(), p.vx.begin() + static_cast<std::ptrdiff_t>(p.count));
        }
        return numbers;
    };
    const auto expected = orders(1);
    CHECK(expected[1] == expected[0]);
    CHECK(expected[2].size() < expected[1].size());
    for (const int threads : {2, 3, 7}) CHECK(orders(threads) == expected);
    omp_set_num_threads(before);
}

TEST_CASE("a grid of pages in use sorts and finds as a grid of all cells does", "[fluid][neighbours]") {
    const float h = 0.9284F;
    Scene scene = test::tank(1000, 150, 1, 0.4642);  // 2 million cells
    scene.fluid->max_particles = 6000;
    Scene roomy = scene;
    roomy.fluid->max_particles = 300000;  // so that all cells are kept
    const auto far_apart = [&] {
        Particles p(6000);
        std::mt19937 random(5);
        const auto in = [&](double lo, double hi) {
            return static_cast<float>(std::uniform_real_distribution<double>(lo, hi)(random));
        };
        // Two pools at the ends and drops between, some of them beyond the channel.
        for (int i = 0; i < 5000; ++i) {
            const bool drop = i % 20 == 0;
            const double x = drop ? 0 : i % 2 == 0 ? 20 : 900, z = drop ? 0 : 100;
            const Vec3 at{in(drop ? -1 : x, drop ? 1001 : x + 12), in(0, drop ? 5 : 1), in(z, drop ? 150 : z + 12)};
            p.add(at, {static_cast<float>(i), 0, 0}, Kind::fluid);
        }
        return p;
    };
    Particles few = far_apart(), all = far_apart();
    CellGrid pages(scene, h), cells(roomy, h);
    int runs = 0, wrong = 0;
    for (const float outflow : {-Box::inf, 25.0F, 905.0F, 1e6F}) {  // in the end all have left
        CHECK(pages.sort(few, outflow) == cells.sort(all, outflow));
        const auto order = [](const Particles& p) { return std::vector<float>(p.vx.data(), p.vx.data() + p.count); };
        CHECK(order(few) == order(all));
        std::mt19937 random(7);
        for (int asked = 0; asked < 500; ++asked) {
            const float x = std::uniform_real_distribution<float>(-10, 1010)(random);
            const float z = std::uniform_real_distribution<float>(90, 115)(random);
            const float length = asked % 3 == 0 ? 500.0F : 4.0F;
            const Vec3 lo{asked % 2 == 0 ? x : 20 + 0.01F * x, 0, z}, hi{lo[0] + length, 1, z + 3};
            std::vector<std::uint32_t> a, b;
            pages.for_each_run(lo, hi, [&](std::uint32_t begin, std::uint32_t end) {
                a.insert(a.end(), {begin, end});
            });
            cells.for_each_run(lo, hi, [&](std::uint32_t begin, std::uint32_t end) {
                b.insert(b.end(), {begin, end});
            });
            wrong += a == b ? 0 : 1;
            runs += static_cast<int>(b.size());
        }
    }
    CHECK(wrong == 0);
    CHECK(runs > 1000);
    CHECK(memory_of_cells(scene, h, 5000) < 0.01 * memory_of_cells(roomy, h, 5000));
}

namespace {

// How much each particle sees of each other one, in units of 1 / whole_share, in a view: how it turns x, y, z, and by how much it
// shifts them.
using WhoSeesWhom = std::map<std::tuple<std::size_t, std::uint32_t, std::array<float, 6>>, unsigned>;

std::array<float, 6> key_of(const RigidMap& map) {
    return {map.rotation.xx, map.rotation.yy, map.rotation.zz, map.shift[0], map.shift[1], map.shift[2]};
}

// Adds the shares of entries [first, last) of a cluster; next: where those begin, which moves behind them.
void add_shares(const NeighbourBlock& block, std::size_t first, std::size_t last, const std::uint16_t*& next,
                std::size_t cluster, const RigidMap& map, WhoSeesWhom& seen) {
    for (std::size_t k = first; k < last; ++k) {
        const unsigned lanes = lanes_of_entry(block, k);
        for (std::size_t l = 0; l < cluster_size_here(); ++l) {
            if ((lanes >> l & 1U) != 0) seen[{cluster + l, block.j[k], key_of(map)}] = *next++;
        }
    }
}

// By a search that asks every line.
WhoSeesWhom seen_plainly(const Solids& solids, const Particles& p, float h) {
    WhoSeesWhom seen;
    const std::size_t size = cluster_size_here();
    for (std::size_t i = 0; i < p.count; i += size) {
        const ClusterPositions places = places_of(p, i, std::min(i + size, p.count), size);
        const Box box = box_round(places);
        BoxNumbers numbers;
        solids.find_obstacles(box, numbers);
        if (!solids.obstacle_near(box, numbers)) continue;
        std::vector<Box> boxes;
        for (const std::uint32_t o : numbers) boxes.push_back(solids.obstacles()[o]);
        std::vector<Mirror> mirrors;
        solids.mirrors_near(box, numbers, mirrors);
        for (std::size_t n = 0; n <= mirrors.size(); ++n) {
            const Mirror mirror = n == 0 ? Mirror{} : mirrors[n - 1];
            NeighbourLists lists(p.capacity());
            NeighbourBlock& block = lists.blocks[0];
            for (std::uint32_t j = 0; j < p.count; ++j) block.j.push_back(j);
            std::visit([&](auto& masks) { masks.resize(p.count + 1); }, block.lanes);
            std::vector<std::uint16_t> shares((p.count + 1) * size);
            std::uint16_t* end = shares.data();
            const ClusterPositions image = mapped(places, mirror.map());
            const Watchers watchers{places, box, boxes, solids.sight_delta()};
            const Sight sight{image, mirror, solids.obstacle_of(mirror), nullptr};
            const std::size_t kept = keep_seen_in_part(watchers, sight, h, p, 0, p.count, block, end);
            const std::uint16_t* next = shares.data();
            add_shares(block, 0, kept, next, i, mirror.map(), seen);
        }
    }
    return seen;
}

// Boxes of any size, low ones among them, some beside a bank or another; and particles as near to them as contact lets them be.
Scene scene_with_boxes(std::mt19937& random) {
    const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
    Scene scene = test::tank(6, 5, 1, 0.3);
    for (int k = 0; k < 5; ++k) {
        Obstacle box;
        box.x.lo = k == 1 ? scene.obstacles[0].x.hi : in(0, 5), box.x.hi = box.x.lo + in(0.05, 1.5);
        box.z.lo = k == 2 ? 0 : in(0, 4), box.z.hi = box.z.lo + in(0.05, 1.5);
        box.height = k % 2 == 0 ? 3 : in(0.2, 0.8);
        scene.obstacles.push_back(box);
    }
    return scene;
}
Particles particles_beside(const Solids& solids, const Scene& scene, std::mt19937& random, std::size_t n = 700) {
    const auto in = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
    Particles p(static_cast<std::size_t>(scene.fluid->max_particles));
    const std::vector<BedFacet> bed = bed_facets(scene.channel);
    while (p.count < n) {
        const Vec3 x{in(0.01F, 5.99F), in(0.01F, 1.2F), in(0.01F, 4.99F)};
        const bool free = std::none_of(solids.obstacles().begin(), solids.obstacles().end(), [&](const Box& box) {
            return contains(grown(box, contact_fraction * 0.3F), x);
        });
        const bool over_bed = bed.empty() || facet_at(bed, x[0]).distance(x[0], x[1]) > contact_fraction * 0.3F;
        if (free && over_bed) p.add(x, {}, Kind::fluid);
    }
    return p;
}

}  // namespace

TEST_CASE("the search among boxes finds the images and shares that asking every line finds", "[fluid][neighbours]") {
    const float h = 0.6F;
    const bool widest = GENERATE(true, false);
    use_widest_vectors(widest);
    std::mt19937 random(3);
    std::size_t in_part = 0, in_faces = 0;
    for (int trial = 0; trial < 6; ++trial) {
        Scene scene = scene_with_boxes(random);
        if (trial == 5) scene.channel->top = Top::wall, scene.channel->height = 1.25;
        const Solids solids(scene);
        Particles p = particles_beside(solids, scene, random);
        CellGrid grid(scene, h);
        grid.sort(p, -Box::inf);
        NeighbourLists lists(p.capacity());
        find_neighbours(grid, solids, p, h, lists);
        WhoSeesWhom found;
        for (std::size_t b = 0; b < block_count(p.count); ++b) {
            const NeighbourBlock& block = lists.blocks[b];
            const std::uint16_t* next = block.factor.data();
            for (std::size_t c = 0; c < lists.clusters_per_block(); ++c) {
                for_each_segment(block, c, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
                    if (!view.in_part) return;
                    const std::size_t before = found.size();
                    add_shares(block, first, last, next, b * block_size + c * lists.cluster_size, view.map, found);
                    if (view.obstacle >= 0) in_faces += found.size() - before;
                });
            }
        }
        for (const auto& [who, share] : found) in_part += share < 65535 ? 1U : 0U;
        const WhoSeesWhom expected = seen_plainly(solids, p, h);
        CHECK(found.size() == expected.size());
        CHECK(found == expected);
    }
    CHECK(in_part > 500);
    CHECK(in_faces > 1000);
    use_widest_vectors(true);
}

namespace {

// Neighbours that each particle sees, with view and visible fraction, in the order of its list. Without a visibility
// test these are all near particles, with the whole fraction.
using SeenInOrder = std::vector<std::vector<std::tuple<std::uint32_t, std::array<float, 6>, unsigned>>>;

SeenInOrder seen_in_order(const CellGrid& grid, const Solids& solids, const Particles& p, float h) {
    SeenInOrder seen(padded(p.count));
    test::for_each_seen(grid, solids, p, h,
                        [&](std::size_t i, std::uint32_t j, const auto& view, const auto*, unsigned share) {
                            seen[i].emplace_back(j, key_of(view.map), share);
                        });
    seen.resize(p.count);
    return seen;
}

}  // namespace

TEST_CASE("whom a particle sees among boxes does not depend on who is in its cluster", "[fluid][neighbours]") {
    const float h = GENERATE(0.6F, 0.72F);
    std::mt19937 random(3);
    std::size_t in_part = 0;
    for (int trial = 0; trial < 6; ++trial) {
        Scene scene = scene_with_boxes(random);
        scene.fluid->kernel = h < 0.7F ? KernelKind::cubic_spline : KernelKind::quartic_spline;
        for (Obstacle& box : scene.obstacles) box.height = std::uniform_real_distribution<double>(0.1, 0.9)(random);
        if (trial % 3 == 1) scene.channel->bed_points = {{1.5, 0}, {2, 0.25}, {2.5, 0}, {3.5, 0}, {4, 0.25}, {4.5, 0}};
        if (trial % 3 == 2) scene.channel->flow = Flow::recirculating, scene.channel->sides = Sides::periodic;
        const Solids solids(scene);
        Particles p = particles_beside(solids, scene, random, 4000);
        CellGrid grid(scene, h);
        grid.sort(p, -Box::inf);
        use_widest_vectors(false);
        const SeenInOrder narrow = seen_in_order(grid, solids, p, h);
        use_widest_vectors(true);
        CHECK((seen_in_order(grid, solids, p, h) == narrow));  // in words, not in thousands of numbers
        for (const auto& of_one : narrow) {
            for (const auto& one : of_one) in_part += std::get<2>(one) < 65535 ? 1U : 0U;
        }
    }
    CHECK(in_part > 1000);
}
