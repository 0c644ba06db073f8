#include <algorithm>
#include <cmath>
#include <span>

#include "configs/numbers/portable.hpp"
#include "fluid_server/neighbours/billiard.hpp"
#include "fluid_server/neighbours/cluster_positions.hpp"
#include "fluid_server/neighbours/neighbours.hpp"

// For each cluster: the particles near it, once. Then, for each sequence of walls that some path may meet, which of them it sees how
// much; these make a segment, and one more for each plane of the ground that mirrors some of them. An image in a wall is no nearer than
// what it is an image of, nor is one in the ground unless that falls away between the two by more than 1 in 1, so that the particles
// near the cluster are enough.

namespace wade::fluid {

namespace {

// What the particles near a cluster span along a wall and in front of it, m.
struct Span {
    float first = Box::inf, last = -Box::inf, nearest = Box::inf;
};

// A wall near a cluster.
struct NearWall {
    std::uint32_t number = 0;
    Wall wall;
    Span span;
    bool is_whole = false;  // none of the paths that it reflects comes near an end, or behind it
};

// A path, and the number of the first with its image that meets the same walls.
struct PathOrder {
    const WallPath* path = nullptr;
    std::size_t like = 0;
};

// Buffers of a thread for the search among walls.
struct WallSearchBuffers {
    NearParticlesOfCluster near;
    std::vector<Run> runs;
    std::vector<std::uint32_t> candidates, wall_numbers;
    std::vector<NearWall> walls;
    Obstruction obstruction;
    std::vector<WallPath> paths;
    std::vector<bool> done;
    PathsFound found;
    std::vector<SeenNear> all, some;
    std::vector<SeenByKey> by_key;
    std::vector<PathOrder> orders;
    std::vector<std::uint16_t> shares;  // of a block
};
WallSearchBuffers& wall_search_buffers() {
    thread_local WallSearchBuffers buffers;
    return buffers;
}

class SiteSearch {
 public:
    SiteSearch(const CellGrid& grid, const SiteSolids& solids, const Particles& particles, float support_radius,
               std::size_t cluster_size, NeighbourBlock& block)
        : grid_(grid), solids_(solids), p_(particles), h_(support_radius), size_(cluster_size), block_(block) {}

    void find(std::size_t begin, std::size_t end) {
        block_.segments.clear();
        block_.views.clear();
        block_.turned.clear();
        block_.first_segment[0] = 0;
        for (std::size_t c = 0; c < block_size / size_; ++c) {
            const std::size_t first = begin + c * size_;
            if (first < end) add_cluster(first, std::min(first + size_, end));
            block_.first_segment[c + 1] = static_cast<std::uint32_t>(block_.segments.size());
        }
        make_room_for(0);
        if (block_.turned.empty()) block_.turned.emplace_back();
        if (block_.views.empty()) block_.views.emplace_back();
        if (shares_ > 0) {
            make_room(block_.factor, shares_ + largest_cluster);  // what is loaded may reach beyond the last
            std::copy_n(buffers_.shares.data(), shares_, block_.factor.data());
        }
    }

 private:
    void add_cluster(std::size_t begin, std::size_t end) {
        places_ = places_of(p_, begin, end, size_);
        const Box box = box_round(places_);
        is_near_ground_ = solids_.is_near_ground(box);
        note_near_particles(box);
        note_near_walls(box);
        static const WallPath no_walls;
        add_paths(std::array{PathOrder{&no_walls}}, 0, is_free());
        find_paths_of_walls();
        for (std::size_t n = 0; n < buffers_.paths.size(); ++n) {
            if (!buffers_.done[n]) add_paths_like(n);
        }
    }

    void note_near_particles(const Box& box) {
        const float reach = (1 + for_rounding) * h_;
        const Box round = grown(box, reach);
        buffers_.runs.clear();
        std::size_t most = largest_cluster;
        grid_.for_each_run(round.lo, round.hi, [&](std::uint32_t first, std::uint32_t last) {
            buffers_.runs.push_back({first, last});
            most += last - first;
        });
        make_room(buffers_.candidates, 2 * most);
        std::uint32_t* const found = buffers_.candidates.data();
        const std::size_t count = find_near_box(box, reach, p_, buffers_.runs, found);
        std::uint32_t* const nearer = found + most;
        const std::size_t kept = find_near_particles(places_, reach, p_, {found, count}, nearer);
        buffers_.near.assign({nearer, kept}, p_);
        buffers_.all.clear();
        const auto all_lanes = static_cast<std::uint16_t>((1U << size_) - 1);
        for (std::uint32_t k = 0; k < kept; ++k) buffers_.all.push_back({k, all_lanes});
    }

    // Walls near the cluster; and those that may stand in the way: a particle near, or another wall, is behind them.
    void note_near_walls(const Box& box) {
        solids_.find_walls(box, buffers_.wall_numbers);
        buffers_.walls.clear();
        Obstruction& obstruction = buffers_.obstruction;
        obstruction.numbers.clear(), obstruction.walls.clear(), obstruction.edges.clear();
        const NearParticlesOfCluster& near = buffers_.near;
        const float delta = solids_.sight_delta();
        const Box reach = grown(box, (1 + for_rounding) * h_ + delta);
        const auto is_near = [&](const PlanPoint& p) {
            return p.x >= reach.lo[0] && p.x <= reach.hi[0] && p.z >= reach.lo[2] && p.z <= reach.hi[2];
        };
        for (const std::uint32_t number : buffers_.wall_numbers) {
            const Wall& wall = solids_.walls()[number];
            Span span;
            for (std::size_t k = 0; k < near.size; ++k) {
                const float s = wall.along(near.x[k], near.z[k]);
                span.first = std::min(span.first, s), span.last = std::max(span.last, s);
                span.nearest = std::min(span.nearest, wall.distance(near.x[k], near.z[k]));
            }
            const float first = wall.edge_before ? delta : 0, last = wall.length - (wall.edge_after ? delta : 0);
            buffers_.walls.push_back(
                {number, wall, span, span.nearest >= 0 && span.first >= first && span.last <= last});
            const auto is_behind = [&](std::uint32_t other) { return reaches_behind(solids_.walls()[other], wall); };
            const bool edge_near = (wall.edge_before && is_near(wall.a)) || (wall.edge_after && is_near(wall.end()));
            const bool stands_between =
                span.nearest < 0 || edge_near ||
                std::any_of(buffers_.wall_numbers.begin(), buffers_.wall_numbers.end(), is_behind);
            if (!stands_between || obstruction.walls.size() == Obstruction::most) continue;
            obstruction.numbers.push_back(number);
            obstruction.walls.push_back(wall);
            if (wall.edge_before && is_near(wall.a)) add_edge(wall.a, obstruction.walls.size() - 1);
            if (wall.edge_after && is_near(wall.end())) add_edge(wall.end(), obstruction.walls.size() - 1);
        }
    }

    // Whether a part of a wall lies behind another.
    static bool reaches_behind(const Wall& wall, const Wall& other) {
        constexpr float slack = 1e-4F;  // m
        const PlanPoint end = wall.end();
        return std::min(other.distance(wall.a.x, wall.a.z), other.distance(end.x, end.z)) < -slack;
    }

    void add_edge(const PlanPoint& at, std::size_t wall) {
        constexpr float same_place = 1e-4F;  // m
        std::vector<Obstruction::Edge>& edges = buffers_.obstruction.edges;
        auto edge = std::find_if(edges.begin(), edges.end(), [&](const Obstruction::Edge& e) {
            return length_of(e.at.x - at.x, e.at.z - at.z) < same_place;
        });
        if (edge == edges.end()) {
            if (edges.size() == Obstruction::most) return;
            edge = edges.insert(edge, {at, 0});
        }
        edge->walls |= std::uint64_t{1} << wall;
    }

    [[nodiscard]] bool is_free() const { return buffers_.obstruction.walls.empty(); }

    // Finds all sequences of walls that may give an image near the cluster.
    void find_paths_of_walls() {
        buffers_.paths.clear();
        const std::vector<NearWall>& walls = buffers_.walls;
        for (std::size_t a = 0; a < walls.size(); ++a) {
            WallPath path;
            if (!go_on(path, walls[a], 0)) continue;
            for (std::size_t b = 0; b < walls.size(); ++b) {
                WallPath second = path;
                if (b == a || !go_on(second, walls[b], distance_between(walls[a].wall, walls[b].wall))) continue;
                for (std::size_t c = 0; c < walls.size(); ++c) {
                    if (c == b || (c == a && meet_at_no_less_than_right_angle(walls[a].wall, walls[b]))) continue;
                    WallPath third = second;
                    go_on(third, walls[c],
                          distance_between(walls[a].wall, walls[b].wall) +
                              distance_between(walls[b].wall, walls[c].wall));
                }
            }
        }
        buffers_.done.assign(buffers_.paths.size(), false);
    }

    // Returns whether a path may continue to a wall; records it with that wall if an image may be near. way: lower
    // bound of its length between walls, m.
    bool go_on(WallPath& path, const NearWall& to, float way) {
        if (way >= h_) return false;
        if (path.length > 0) {
            const Wall& last = path.wall[path.length - 1];
            constexpr float slack = 1e-5F;
            const auto is_before = [](const Wall& wall, const Wall& other) {
                const PlanPoint end = other.end();
                return std::max(wall.distance(other.a.x, other.a.z), wall.distance(end.x, end.z)) > slack;
            };
            if (!is_before(last, to.wall) || !is_before(to.wall, last)) return false;
        }
        path.number[path.length] = to.number;
        path.wall[path.length] = to.wall;
        path.beside[path.length] = buffers_.obstruction.beside(to.number, to.wall);
        ++path.length;
        path.map = {};
        for (std::size_t m = path.length; m > 0; --m) path.map = reflected_first(path.map, path.wall[m - 1]);
        if (comes_near(path.map)) buffers_.paths.push_back(path);
        return true;
    }

    [[nodiscard]] bool comes_near(const TurnedMap& map) const {
        const Box image = grown(box_round(mapped(places_, map)), (1 + for_rounding) * h_);
        const NearParticlesOfCluster& near = buffers_.near;
        for (std::size_t k = 0; k < near.size; ++k) {
            if (contains(image, {near.x[k], near.y[k], near.z[k]})) return true;
        }
        return false;
    }

    // Two walls of an inner corner of 90 degrees or more: no path meets one of them twice.
    static bool meet_at_no_less_than_right_angle(const Wall& a, const NearWall& b) {
        constexpr float right = -1e-4F;
        const bool meet = a.before == b.number || a.after == b.number;
        return meet && a.nx * b.wall.nx + a.nz * b.wall.nz >= right;
    }

    // Paths that meet the walls of one of them, with the same image; and those of this image past other walls, such as those of a house
    // that goes on in line: what is seen is the most by any of them.
    void add_paths_like(std::size_t first) {
        std::vector<PathOrder>& orders = buffers_.orders;
        orders.clear();
        const std::size_t most_orders = SightKey::most_orders(solids_.ground().planes.size());
        const PlanPoint& start = buffers_.paths[first].wall[0].a;
        const Vec3 at{start.x, 0, start.z};
        bool is_whole = is_free();
        std::size_t of_these = 0, like = 0;
        for (std::size_t n = 0; n < buffers_.paths.size(); ++n) {
            const WallPath& path = buffers_.paths[n];
            if (!is_same(path.map, buffers_.paths[first].map, at, h_) || orders.size() == most_orders) continue;
            const auto same = std::find_if(orders.begin(), orders.end(), [&](const PathOrder& other) {
                return meet_the_same_walls(path, *other.path);
            });
            orders.push_back({&path, static_cast<std::size_t>(same - orders.begin())});
            is_whole = is_whole && walls_are_whole(path);
            if (!meet_the_same_walls(path, buffers_.paths[first])) continue;
            buffers_.done[n] = true;
            like = orders.back().like, ++of_these;
        }
        if (of_these == 0) return;  // one order too many, over ground of millions of planes
        // One wall, or a right corner in both orders, misses nothing.
        const bool misses_nothing = orders.size() == of_these && of_these == orders[0].path->length && of_these < 3;
        add_paths(orders, like, is_whole && misses_nothing);
    }

    static bool meet_the_same_walls(const WallPath& a, const WallPath& b) {
        return a.length == b.length && std::is_permutation(a.number.begin(), a.number.end(), b.number.begin());
    }

    [[nodiscard]] bool walls_are_whole(const WallPath& path) const {
        for (std::size_t m = 0; m < path.length; ++m) {
            const auto at = std::find_if(buffers_.walls.begin(), buffers_.walls.end(),
                                         [&](const NearWall& wall) { return wall.number == path.number[m]; });
            if (!at->is_whole) return false;
        }
        return true;
    }

    // Adds the neighbours seen by the orders with the same walls as order `like`, and their mirror images in the
    // ground. Each path uses its own walls, so that its map does not depend on the other paths near the cluster.
    // is_whole: all near particles are seen.
    void add_paths(std::span<const PathOrder> orders, std::size_t like, bool is_whole) {
        const WallPath& path = *orders[like].path;
        const bool by_others = std::any_of(orders.begin(), orders.end(), [&](auto& one) { return one.like != like; });
        const GroundFacets& ground = solids_.ground();
        const GroundPlane& plane = ground.planes[0];
        const bool is_level = ground.is_one_plane() && plane.n[1] == 1;
        const bool by_ground = is_near_ground_ && (!ground.is_one_plane() || (!is_level && path.length > 0));
        PathsFound& found = buffers_.found;
        if (!is_whole || by_ground) {
            found.make_room(buffers_.near.size, size_);
            for (std::size_t n = 0; n < orders.size(); ++n) {
                PathQuestion question{*orders[n].path};
                question.obstruction = is_whole ? nullptr : &buffers_.obstruction;
                question.order = static_cast<std::int32_t>(n);
                question.orders = static_cast<std::int32_t>(orders.size());
                question.like = static_cast<std::int32_t>(orders[n].like);
                question.has_keys = by_ground || by_others;
                question.ground = by_ground ? &ground : nullptr;
                question.support_radius = h_, question.delta = solids_.sight_delta();
                find_paths(places_, buffers_.near, question, found);
            }
            if (by_others) forget_what_is_seen_by_others(orders, like);
        }
        add_segment({path.map, false, path.house()}, nullptr, is_whole, list_of_seen(is_whole));
        if (!is_near_ground_) return;
        if (!by_ground) {
            add_segment({with_ground(path, 0, plane), true, path.house()}, nullptr, is_whole, list_of_seen(is_whole));
            return;
        }
        const std::size_t keys = sort_by_key(found, buffers_.near.size, buffers_.by_key);
        // In an order that does not depend on the size of clusters.
        std::sort(buffers_.by_key.begin(), buffers_.by_key.begin() + static_cast<std::ptrdiff_t>(keys),
                  [](const SeenByKey& one, const SeenByKey& other) { return one.key.value < other.key.value; });
        for (std::size_t n = 0; n < keys; ++n) {
            const SeenByKey& list = buffers_.by_key[n];
            const GroundPlane& under = ground.planes[list.key.plane(orders.size())];
            const WallPath& order = *orders[list.key.order(orders.size())].path;
            add_segment({with_ground(order, list.key.walls_before(), under), true, path.house()},
                        ground.is_one_plane() ? nullptr : &under, false, list.seen);
        }
    }

    void forget_what_is_seen_by_others(std::span<const PathOrder> orders, std::size_t like) {
        PathsFound& found = buffers_.found;
        for (std::size_t k = 0; k < buffers_.near.size * size_; ++k) {
            const SightKey key{found.key[k]};
            const auto lane = static_cast<std::uint16_t>(1U << k % size_);
            const bool is_seen = (found.seen[k / size_] & lane) != 0;  // else it has no key
            if (is_seen && orders[key.order(orders.size())].like != like) found.seen[k / size_] ^= lane;
        }
    }

    // Of what has been found, or of all that is near.
    std::span<const SeenNear> list_of_seen(bool is_whole) {
        if (is_whole) return buffers_.all;
        std::vector<SeenNear>& seen = buffers_.some;
        seen.clear();
        for (std::uint32_t k = 0; k < buffers_.near.size; ++k) {
            if (buffers_.found.seen[k] != 0) seen.push_back({k, buffers_.found.seen[k]});
        }
        return seen;
    }

    void add_segment(const NeighbourBlock::TurnedView& turned, const GroundPlane* plane, bool is_whole,
                     std::span<const SeenNear> seen) {
        const std::size_t first = entries_;
        make_room_for(seen.size());
        NeighbourBlock::View view;
        view.by_sight = !is_whole;
        view.in_part = !is_whole && buffers_.found.in_part;
        std::uint16_t* to = nullptr;
        if (view.in_part) {
            make_room(buffers_.shares, shares_ + seen.size() * size_ + largest_cluster);
            to = buffers_.shares.data() + shares_;
        }
        entries_ = append_seen(places_, mapped(places_, turned.map), h_, plane, buffers_.near, seen, buffers_.found,
                               entries_, block_, to == nullptr ? nullptr : &to);
        if (to != nullptr) shares_ = static_cast<std::size_t>(to - buffers_.shares.data());
        if (entries_ > first) add(block_.segments, {static_cast<std::uint32_t>(entries_), number_of(view, turned)});
    }

    void make_room_for(std::size_t more) {
        make_room(block_.j, entries_ + more + 1);
        std::visit([&](auto& masks) { make_room(masks, entries_ + more + 1); }, block_.lanes);
    }

    // Where a view stands among those of the block.
    std::uint32_t number_of(const NeighbourBlock::View& view, const NeighbourBlock::TurnedView& turned) {
        std::size_t n = 0;
        while (n < block_.turned.size() && !(block_.turned[n] == turned && block_.views[n] == view)) ++n;
        if (n == block_.turned.size()) add(block_.turned, turned), add(block_.views, view);
        return static_cast<std::uint32_t>(n);
    }

    const CellGrid& grid_;
    const SiteSolids& solids_;
    const Particles& p_;
    float h_;
    std::size_t size_;  // of a cluster
    NeighbourBlock& block_;
    ClusterPositions places_;
    bool is_near_ground_ = true;
    WallSearchBuffers& buffers_ = wall_search_buffers();
    std::size_t entries_ = 0;
    std::size_t shares_ = 0;  // of what is seen in part
};

}  // namespace

void find_neighbours(const CellGrid& grid, const SiteSolids& solids, const Particles& p, float support_radius,
                     NeighbourLists& lists) {
    lists.count = p.count;
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        SiteSearch(grid, solids, p, support_radius, lists.cluster_size, lists.blocks[b]).find(begin, end);
    });
}

}  // namespace wade::fluid
