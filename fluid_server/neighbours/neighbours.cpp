#include "fluid_server/neighbours/neighbours.hpp"

#include <algorithm>
#include <span>

#include "fluid_server/neighbours/cluster_places.hpp"
#include "fluid_server/neighbours/sight.hpp"
#include "fluid_server/neighbours/sweeps.hpp"

namespace wade::fluid {

namespace {

// A box round the images of those places from which a particle nearer than h may be seen in the face of an obstacle; its upper
// bounds are below its lower ones if there are none. A line that is no longer than h meets the face.
Box box_facing(const ClusterPlaces& places, const ClusterPlaces& image, const Mirror& mirror, const Box& obstacle,
               float h) {
    const std::array<const float*, 3> x{places.x.data(), places.y.data(), places.z.data()};
    const std::array<const float*, 3> at{image.x.data(), image.y.data(), image.z.data()};
    const float reach = (1 + for_rounding) * h;
    Box face = grown(obstacle, reach);
    const std::size_t k = mirror.obstacle_axis;
    const bool upper = mirror.plane[k] == obstacle.hi[k];
    face.lo[k] = upper ? mirror.plane[k] : mirror.plane[k] - reach;
    face.hi[k] = upper ? mirror.plane[k] + reach : mirror.plane[k];
    Box box{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
    for (std::size_t l = 0; l < places.size; ++l) {
        if (!contains(face, {x[0][l], x[1][l], x[2][l]})) continue;
        for (std::size_t m = 0; m < 3; ++m) {
            box.lo[m] = std::min(box.lo[m], at[m][l] - for_rounding * h);
            box.hi[m] = std::max(box.hi[m], at[m][l] + for_rounding * h);
        }
    }
    return box;
}

// Room of a thread for the search.
struct Room {
    BoxNumbers obstacles;
    std::vector<Box> boxes;  // of them
    NearParticlesOfCluster near;
    std::vector<Mirror> mirrors;
    std::vector<Run> runs;
    std::vector<std::uint32_t> candidates;
    std::vector<std::uint16_t> shares;  // of a block
};
Room& room_of_thread() {
    thread_local Room room;
    return room;
}

// Finds the lists of one block.
class BlockSearch {
 public:
    BlockSearch(const CellGrid& grid, const Solids& solids, const Particles& particles, float support_radius,
                std::size_t cluster_size, NeighbourBlock& block)
        : grid_(grid), solids_(solids), p_(particles), h_(support_radius), size_(cluster_size), block_(block) {}

    void find(std::size_t begin, std::size_t end) {
        entries_ = shares_ = 0;
        block_.segments.clear();
        block_.views.clear();
        block_.first_segment[0] = 0;
        for (std::size_t c = 0; c < block_size / size_; ++c) {
            const std::size_t first = begin + c * size_;
            if (first < end) {
                add_cluster(first, std::min(first + size_, end));
            }
            block_.first_segment[c + 1] = static_cast<std::uint32_t>(block_.segments.size());
        }
        make_room_for_lanes();
        if (shares_ > 0) {
            // What is loaded may reach beyond the last.
            make_room(block_.factor, shares_ + largest_cluster);
            std::copy_n(room_.shares.data(), shares_, block_.factor.data());
        }
    }

 private:
    void add_cluster(std::size_t begin, std::size_t end) {
        const ClusterPlaces places = places_of(p_, begin, end, size_);
        const Box box = box_round(places);
        solids_.find_obstacles(box, room_.obstacles);
        room_.boxes.clear();
        if (solids_.obstacle_near(box, room_.obstacles)) {
            for (const std::uint32_t o : room_.obstacles) room_.boxes.push_back(solids_.obstacles()[o]);
        }
        const Watchers watchers{places, box, room_.boxes, solids_.sight_delta()};
        const Mirror none;
        add_segments(watchers, {places, none}, box);
        solids_.mirrors_near(box, room_.obstacles, room_.mirrors);
        for (const Mirror& mirror : room_.mirrors) {
            const ClusterPlaces image = mapped(places, mirror.map());
            const Box* const obstacle = solids_.obstacle_of(mirror);
            const Box round = obstacle == nullptr ? box_round(image) : box_facing(places, image, mirror, *obstacle, h_);
            if (round.lo[0] > round.hi[0]) continue;
            add_segments(watchers, {image, mirror, obstacle, solids_.facet_of(mirror)}, round);
        }
    }

    // The segments of what is seen in a mirror, or without one: one, and one for each periodic border across which some of it
    // lies. box: round the images of those watchers that may see something so.
    void add_segments(const Watchers& watchers, Sight sight, const Box& box) {
        const Box near = grown(box, h_);
        const Mirror& mirror = sight.mirror;
        const ClusterPlaces& image = sight.image;
        grid_.for_each_period(near.lo, near.hi, [&](const Vec3& period) {
            const std::size_t first = entries_;
            NeighbourBlock::View view{mirror.map(),
                                      mirror.viscous,
                                      static_cast<std::int16_t>(mirror.obstacle),
                                      static_cast<std::int16_t>(mirror.obstacle_axis),
                                      !watchers.obstacles.empty() || mirror.facet >= 0,
                                      !watchers.obstacles.empty()};
            if (period == Vec3{}) {
                append(image, box, way_of(watchers, sight));
                if (view.by_sight) keep_seen(watchers, sight, first);
            } else {
                for (std::size_t k = 0; k < 3; ++k) {
                    view.map.shift[k] -= period[k];  // instead of shifting the particles
                }
                const ClusterPlaces shifted = mapped(watchers.places, view.map);
                append(shifted, box_round(shifted), Search::grid);
                if (view.by_sight) {
                    keep_seen(watchers, {shifted, mirror, sight.obstacle, sight.facet, period}, first);
                }
            }
            if (entries_ > first) {
                add(block_.segments, {static_cast<std::uint32_t>(entries_), number_of(view)});
            }
        });
    }

    // Where particles are looked for. Both places of a pair that see one another in the face of an obstacle, or in walls and a
    // level bed besides, lie on the same side of each: they are no farther apart than place and image, so that the particles
    // near the cluster are enough. A facet may have one of them a little below it.
    enum class Search { grid, grid_and_note, noted };
    [[nodiscard]] static Search way_of(const Watchers& watchers, const Sight& sight) {
        if (watchers.obstacles.empty()) return Search::grid;
        if (&sight.image == &watchers.places) return Search::grid_and_note;
        return sight.obstacle != nullptr && sight.facet == nullptr ? Search::noted : Search::grid;
    }

    void make_room_for_lanes() {
        std::visit([this](auto& masks) { make_room(masks, entries_); }, block_.lanes);
    }

    // Where a view stands among those of the block.
    std::uint32_t number_of(const NeighbourBlock::View& view) {
        std::vector<NeighbourBlock::View>& views = block_.views;
        const auto at = std::find(views.begin(), views.end(), view) - views.begin();
        if (static_cast<std::size_t>(at) == views.size()) add(views, view);
        return static_cast<std::uint32_t>(at);
    }

    // Appends the particles that are nearer than the support radius to one of these places and to the box.
    void append(const ClusterPlaces& places, const Box& box, Search search) {
        const std::span candidates = search == Search::noted ? find_noted(box) : find_by_grid(box, search);
        make_room(block_.j, entries_ + candidates.size() + 1);
        entries_ += find_near_places(places, h_, p_, candidates, block_.j.data() + entries_);
    }

    // Particles that are nearer to the box than the support radius, or, if they are noted, a little farther than that, which is
    // more than what rounding moves.
    std::span<const std::uint32_t> find_by_grid(const Box& box, Search search) {
        const float reach = search == Search::grid_and_note ? (1 + for_rounding) * h_ : h_;
        const Box near = grown(box, reach);
        room_.runs.clear();
        std::size_t most = largest_cluster;
        grid_.for_each_run(near.lo, near.hi, [&](std::uint32_t begin, std::uint32_t end) {
            room_.runs.push_back({begin, end});
            most += end - begin;
        });
        make_room(room_.candidates, most);
        std::uint32_t* const to = room_.candidates.data();
        const std::span<const std::uint32_t> found{to, find_near_box(box, reach, p_, room_.runs, to)};
        if (search == Search::grid_and_note) room_.near.assign(found, p_);
        return found;
    }

    std::span<const std::uint32_t> find_noted(const Box& box) {
        make_room(room_.candidates, room_.near.size + largest_cluster);
        std::uint32_t* const to = room_.candidates.data();
        return {to, find_near_box_among(box, h_, room_.near, to)};
    }

    void keep_seen(const Watchers& watchers, const Sight& sight, std::size_t first) {
        make_room_for_lanes();
        if (watchers.obstacles.empty()) {
            entries_ = keep_seen_over_facet(watchers, sight, h_, p_, first, entries_, block_);
            return;
        }
        make_room(room_.shares, shares_ + (entries_ - first) * size_);
        std::uint16_t* to = room_.shares.data() + shares_;
        entries_ = keep_seen_in_part(watchers, sight, h_, p_, first, entries_, block_, to);
        shares_ = static_cast<std::size_t>(to - room_.shares.data());
    }

    const CellGrid& grid_;
    const Solids& solids_;
    const Particles& p_;
    float h_;
    std::size_t size_;  // of a cluster
    NeighbourBlock& block_;
    Room& room_ = room_of_thread();
    std::size_t entries_ = 0;
    std::size_t shares_ = 0;  // of what is seen in part
};

}  // namespace

void find_neighbours(const CellGrid& grid, const Solids& solids, const Particles& p, float support_radius,
                     NeighbourLists& lists) {
    lists.count = p.count;
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockSearch(grid, solids, p, support_radius, lists.cluster_size, lists.blocks[b]).find(begin, end);
    });
}

}  // namespace wade::fluid
