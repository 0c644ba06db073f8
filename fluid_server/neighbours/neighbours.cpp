#include "fluid_server/neighbours/neighbours.hpp"

#include <algorithm>
#include <span>

#include "fluid_server/neighbours/sweeps.hpp"

namespace wade::fluid {

namespace {

ClusterPlaces places_of(const Particles& p, std::size_t begin, std::size_t end, std::size_t size) {
    ClusterPlaces places;
    places.size = size;
    for (std::size_t l = 0; l < size; ++l) {
        const std::size_t i = std::min(begin + l, end - 1);
        places.x[l] = p.x[i], places.y[l] = p.y[i], places.z[l] = p.z[i];
    }
    return places;
}

ClusterPlaces mapped(const ClusterPlaces& places, const RigidMap& map) {
    ClusterPlaces image;
    image.size = places.size;
    for (std::size_t l = 0; l < places.size; ++l) {
        const Vec3 x = map({places.x[l], places.y[l], places.z[l]});
        image.x[l] = x[0], image.y[l] = x[1], image.z[l] = x[2];
    }
    return image;
}

Box box_round(const ClusterPlaces& places) {
    Box box{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
    const auto grow = [&](std::size_t axis, const std::array<float, largest_cluster>& x) {
        for (std::size_t l = 0; l < places.size; ++l) {
            box.lo[axis] = std::min(box.lo[axis], x[l]);
            box.hi[axis] = std::max(box.hi[axis], x[l]);
        }
    };
    grow(0, places.x), grow(1, places.y), grow(2, places.z);
    return box;
}

// Room of a thread for the search.
struct Room {
    BoxNumbers obstacles;
    std::vector<Mirror> mirrors;
    std::vector<Run> runs;
    std::vector<std::uint32_t> candidates;
};
Room& room_of_thread() {
    thread_local Room room;
    return room;
}

// As vector::resize to at least `size`, with less room to spare.
template <typename T>
void make_room(std::vector<T>& list, std::size_t size) {
    if (list.size() >= size) return;
    if (list.capacity() < size) list.reserve(size + size / 16);
    list.resize(list.capacity());
}

// As vector::push_back, with less room to spare.
template <typename T>
void add(std::vector<T>& list, const T& one_more) {
    if (list.size() == list.capacity()) list.reserve(list.size() + list.size() / 16 + 4);
    list.push_back(one_more);
}

// A cluster that looks round.
struct Watchers {
    const ClusterPlaces& places;
    const Box& box;    // round them
    bool by_obstacle;  // there is one near
};

// Finds the lists of one block.
class BlockSearch {
 public:
    BlockSearch(const CellGrid& grid, const Solids& solids, const Particles& particles, float support_radius,
                std::size_t cluster_size, NeighbourBlock& block)
        : grid_(grid), solids_(solids), p_(particles), h_(support_radius), size_(cluster_size), block_(block) {}

    void find(std::size_t begin, std::size_t end) {
        entries_ = 0;
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
    }

 private:
    void add_cluster(std::size_t begin, std::size_t end) {
        const ClusterPlaces places = places_of(p_, begin, end, size_);
        const Box box = box_round(places);
        solids_.find_obstacles(box, room_.obstacles);
        const bool by_obstacle = solids_.obstacle_near(box, room_.obstacles);
        const Watchers watchers{places, box, by_obstacle};
        add_segments(watchers, places, box, {});
        solids_.mirrors_near(box, room_.obstacles, room_.mirrors);
        for (const Mirror& mirror : room_.mirrors) {
            const ClusterPlaces image = mapped(places, mirror.map());
            add_segments(watchers, image, box_round(image), mirror);
        }
    }

    // The segments of what is seen in a mirror, or without one: one, and one for each periodic border across which some of it
    // lies. image: of the watchers in the mirror; box: round the image.
    void add_segments(const Watchers& watchers, const ClusterPlaces& image, const Box& box, const Mirror& mirror) {
        const Box near = grown(box, h_);
        grid_.for_each_period(near.lo, near.hi, [&](const Vec3& period) {
            const std::size_t first = entries_;
            NeighbourBlock::View view{mirror.map(), mirror.viscous, static_cast<std::int16_t>(mirror.obstacle),
                                      static_cast<std::int16_t>(mirror.obstacle_axis),
                                      watchers.by_obstacle || mirror.facet >= 0};
            if (period == Vec3{}) {
                append(image, box);
                if (view.by_sight) keep_seen(watchers, image, mirror, period, first);
            } else {
                for (std::size_t k = 0; k < 3; ++k) {
                    view.map.shift[k] -= period[k];  // instead of shifting the particles
                }
                const ClusterPlaces shifted = mapped(watchers.places, view.map);
                append(shifted, box_round(shifted));
                if (view.by_sight) keep_seen(watchers, shifted, mirror, period, first);
            }
            if (entries_ > first) {
                add(block_.segments, {static_cast<std::uint32_t>(entries_), number_of(view)});
            }
        });
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

    // Appends the particles that are nearer than the support radius to one of these places, which lie in the box.
    void append(const ClusterPlaces& places, const Box& box) {
        const Box near = grown(box, h_);
        room_.runs.clear();
        std::size_t most = largest_cluster;
        grid_.for_each_run(near.lo, near.hi, [&](std::uint32_t begin, std::uint32_t end) {
            room_.runs.push_back({begin, end});
            most += end - begin;
        });
        make_room(room_.candidates, most);
        std::uint32_t* const to = room_.candidates.data();
        const std::span candidates{to, find_near_box(box, h_, p_, room_.runs, to)};
        make_room(block_.j, entries_ + candidates.size() + 1);
        entries_ += find_near_places(places, h_, p_, candidates, block_.j.data() + entries_);
    }

    // Keeps of the entries from `first` on those that some lane sees, and notes which do. image: of the watchers.
    void keep_seen(const Watchers& watchers, const ClusterPlaces& image, const Mirror& mirror, const Vec3& period,
                   std::size_t first) {
        make_room_for_lanes();
        std::size_t kept = first;
        for (std::size_t k = first; k < entries_; ++k) {
            const std::uint32_t j = block_.j[k];
            const Vec3 at{p_.x[j] + period[0], p_.y[j] + period[1], p_.z[j] + period[2]};
            const unsigned lanes = near(image, {p_.x[j], p_.y[j], p_.z[j]}) & seen(watchers, at, mirror);
            block_.j[kept] = j;
            set_lanes_of_entry(block_, kept, lanes);
            kept += lanes != 0 ? 1U : 0U;
        }
        entries_ = kept;
    }

    // The lanes that are nearer to y than the support radius.
    [[nodiscard]] unsigned near(const ClusterPlaces& places, const Vec3& y) const {
        unsigned lanes = 0;
#pragma omp simd reduction(| : lanes)
        for (unsigned l = 0; l < places.size; ++l) {
            const float dx = places.x[l] - y[0];
            const float dy = places.y[l] - y[1];
            const float dz = places.z[l] - y[2];
            lanes |= static_cast<unsigned>(dx * dx + dy * dy + dz * dz < h_ * h_) << l;
        }
        return lanes;
    }

    // The lanes that see a particle at y, or its image in a mirror.
    [[nodiscard]] unsigned seen(const Watchers& watchers, const Vec3& y, const Mirror& mirror) const {
        const ClusterPlaces& x = watchers.places;
        unsigned lanes = ~0U;
        for (unsigned l = 0; mirror.facet >= 0 && l < size_; ++l) {
            if (!solids_.sees_in_facet({x.x[l], x.y[l], x.z[l]}, y, mirror)) lanes &= ~(1U << l);
        }
        if (!watchers.by_obstacle || lanes == 0) return lanes;
        const Places from{x.x.data(), x.y.data(), x.z.data()};
        return lanes &
               (mirror.obstacle < 0 ? solids_.visible(from, size_, watchers.box, mirror.reflect(y), room_.obstacles)
                                    : solids_.sees_image(from, size_, y, mirror));
    }

    const CellGrid& grid_;
    const Solids& solids_;
    const Particles& p_;
    float h_;
    std::size_t size_;  // of a cluster
    NeighbourBlock& block_;
    Room& room_ = room_of_thread();
    std::size_t entries_ = 0;
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
