#include "fluid_server/neighbours/neighbours.hpp"

#include <algorithm>
#include <span>

#include "fluid_server/neighbours/cluster_positions.hpp"
#include "fluid_server/neighbours/sight.hpp"
#include "fluid_server/neighbours/sweeps.hpp"

namespace wade::fluid {

namespace {

// Buffers of a thread for the search in a channel.
struct SearchBuffers {
    BoxNumbers obstacles;
    std::vector<Box> boxes;  // of them
    NearParticlesOfCluster near;
    BeforeFace before;     // of the cluster at hand,
    Mirror before_mirror;  // in this mirror
    std::vector<Mirror> mirrors;
    std::vector<Run> runs;
    std::vector<std::uint32_t> candidates;
    std::vector<std::uint16_t> shares;  // of a block
};
SearchBuffers& search_buffers() {
    thread_local SearchBuffers buffers;
    return buffers;
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
            std::copy_n(buffers_.shares.data(), shares_, block_.factor.data());
        }
    }

 private:
    void add_cluster(std::size_t begin, std::size_t end) {
        const ClusterPositions places = places_of(p_, begin, end, size_);
        const Box box = box_round(places);
        solids_.find_obstacles(box, buffers_.obstacles);
        buffers_.boxes.clear();
        if (solids_.obstacle_near(box, buffers_.obstacles)) {
            for (const std::uint32_t o : buffers_.obstacles) buffers_.boxes.push_back(solids_.obstacles()[o]);
        }
        const Watchers watchers{places, box, buffers_.boxes, solids_.sight_delta()};
        if (!buffers_.boxes.empty()) look_round(box);
        const Mirror none;
        add_segments(watchers, {places, none}, box);
        solids_.mirrors_near(box, buffers_.obstacles, buffers_.mirrors);
        for (const Mirror& mirror : buffers_.mirrors) {
            const Box* const obstacle = solids_.obstacle_of(mirror);
            const BedFacet* const facet = solids_.facet_of(mirror);
            if (obstacle != nullptr && facet == nullptr) {
                note_before(watchers, mirror, *obstacle);
                if (!at_border_ && buffers_.before.size == 0) continue;
            }
            const ClusterPositions image = mapped(places, mirror.map());
            if (obstacle != nullptr && facet == nullptr && !at_border_) {
                add_segment(watchers, {image, mirror, obstacle}, box, {});
                continue;
            }
            const Box round = obstacle == nullptr ? box_round(image)
                                                  : box_facing(places, image, mirror, *obstacle, h_, watchers.delta);
            if (round.lo[0] > round.hi[0]) continue;
            add_segments(watchers, {image, mirror, obstacle, facet}, round);
        }
    }

    // Finds the particles near the cluster, up to a little more than the support radius, to allow for rounding.
    void look_round(const Box& box) {
        buffers_.near.assign(find_by_grid(box, (1 + for_rounding) * h_), p_);
        buffers_.before_mirror = {};
        // Along an axis images in a face are twice as far away as the face, and what is seen there h farther.
        const Box far = grown(box, 3.125F * h_);
        int periods = 0;
        grid_.for_each_period(far.lo, far.hi, [&](const Vec3&) { ++periods; });
        at_border_ = periods > 1;
    }

    // Records which near particles the lanes may see in a face, unless another view of the face has done so.
    void note_before(const Watchers& watchers, const Mirror& mirror, const Box& obstacle) {
        const Mirror& last = buffers_.before_mirror;
        bool same = mirror.obstacle == last.obstacle && mirror.obstacle_axis == last.obstacle_axis;
        for (const std::size_t k : {std::size_t{0}, mirror.obstacle_axis, std::size_t{2}}) {
            same = same && mirror.axis[k] == last.axis[k] && mirror.plane[k] == last.plane[k];
        }
        if (same) return;
        note_before_face(watchers, mirror, obstacle, h_, buffers_.near, buffers_.before);
        buffers_.before_mirror = mirror;
    }

    // Adds the segments of the neighbours seen in a mirror, or without one: one segment, and one for each periodic
    // border between the cluster and some of them. box: encloses the images of the watchers that may see a neighbour in
    // this view.
    void add_segments(const Watchers& watchers, const Sight& sight, const Box& box) {
        const Box near = grown(box, h_);
        grid_.for_each_period(near.lo, near.hi, [&](const Vec3& period) { add_segment(watchers, sight, box, period); });
    }

    void add_segment(const Watchers& watchers, const Sight& sight, const Box& box, const Vec3& period) {
        const Mirror& mirror = sight.mirror;
        const bool in_part = !watchers.obstacles.empty();
        const bool by_sight = in_part || sight.facet != nullptr;
        const std::size_t first = entries_;
        if (period != Vec3{}) {
            const ClusterPositions shifted = mapped(watchers.places, shifted_map(mirror, period));
            append(shifted, box_round(shifted));
            if (by_sight) keep_seen(watchers, {shifted, mirror, sight.obstacle, sight.facet, period}, first);
        } else if (in_part && sight.facet == nullptr) {
            append_of_near(watchers, sight, box);
        } else {
            append(sight.image, box);
            if (by_sight) keep_seen(watchers, sight, first);
        }
        if (entries_ == first) return;
        add(block_.segments,
            {static_cast<std::uint32_t>(entries_),
             number_of({shifted_map(mirror, period), mirror.viscous, static_cast<std::int16_t>(mirror.obstacle),
                        static_cast<std::int16_t>(mirror.obstacle_axis), by_sight, in_part})});
    }

    // Across a border it is the cluster that moves, not the particles.
    static RigidMap shifted_map(const Mirror& mirror, const Vec3& period) {
        RigidMap map = mirror.map();
        for (std::size_t k = 0; k < 3; ++k) map.shift[k] -= period[k];
        return map;
    }

    void make_room_for_lanes() {
        std::visit([this](auto& masks) { make_room(masks, entries_); }, block_.lanes);
    }

    // Where a view stands among those of the block.
    std::uint32_t number_of(const NeighbourBlock::View& view) {
        std::vector<NeighbourBlock::View>& views = block_.views;
        std::size_t at = views.size();  // the cluster before may have had the same
        const auto is_same = [&](const NeighbourBlock::View& other) {
            return other.obstacle == view.obstacle && other.obstacle_axis == view.obstacle_axis && other == view;
        };
        while (at > 0 && !is_same(views[at - 1])) --at;
        if (at > 0) return static_cast<std::uint32_t>(at - 1);
        add(views, view);
        return static_cast<std::uint32_t>(views.size() - 1);
    }

    // Appends the particles that are nearer than the support radius to one of these places and to the box.
    void append(const ClusterPositions& places, const Box& box) {
        const std::span<const std::uint32_t> candidates = find_by_grid(box, h_);
        make_room(block_.j, entries_ + candidates.size() + 1);
        entries_ += find_near_particles(places, h_, p_, candidates, block_.j.data() + entries_);
    }

    std::span<const std::uint32_t> find_by_grid(const Box& box, float reach) {
        const Box near = grown(box, reach);
        buffers_.runs.clear();
        std::size_t most = largest_cluster;
        grid_.for_each_run(near.lo, near.hi, [&](std::uint32_t begin, std::uint32_t end) {
            buffers_.runs.push_back({begin, end});
            most += end - begin;
        });
        make_room(buffers_.candidates, most);
        std::uint32_t* const to = buffers_.candidates.data();
        return {to, find_near_box(box, reach, p_, buffers_.runs, to)};
    }

    // Appends the near particles that the cluster sees past obstacles, or in the face of one. Particles that see one
    // another lie on the same side of each mirror, and so are no farther apart than a particle and an image. (This does
    // not hold over a facet, where one of them may be a little below it.)
    void append_of_near(const Watchers& watchers, const Sight& sight, const Box& box) {
        make_room(block_.j, entries_ + buffers_.near.size + 1);
        std::visit([&](auto& masks) { make_room(masks, entries_ + buffers_.near.size + 1); }, block_.lanes);
        make_room(buffers_.shares, shares_ + (buffers_.near.size + 1) * size_);
        std::uint16_t* to = buffers_.shares.data() + shares_;
        entries_ = sight.obstacle == nullptr
                       ? append_seen_past(watchers, sight, box, h_, buffers_.near, entries_, block_, to)
                       : append_seen_in_face(watchers, sight.mirror, *sight.obstacle, h_, buffers_.near,
                                             buffers_.before, entries_, block_, to);
        shares_ = static_cast<std::size_t>(to - buffers_.shares.data());
    }

    void keep_seen(const Watchers& watchers, const Sight& sight, std::size_t first) {
        make_room_for_lanes();
        if (watchers.obstacles.empty()) {
            entries_ = keep_seen_over_facet(watchers, sight, h_, p_, first, entries_, block_);
            return;
        }
        make_room(buffers_.shares, shares_ + (entries_ - first) * size_);
        std::uint16_t* to = buffers_.shares.data() + shares_;
        entries_ = keep_seen_in_part(watchers, sight, h_, p_, first, entries_, block_, to);
        shares_ = static_cast<std::size_t>(to - buffers_.shares.data());
    }

    const CellGrid& grid_;
    const Solids& solids_;
    const Particles& p_;
    float h_;
    std::size_t size_;  // of a cluster
    NeighbourBlock& block_;
    SearchBuffers& buffers_ = search_buffers();
    bool at_border_ = false;  // something may be seen across a periodic border
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
