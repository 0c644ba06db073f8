#include "fluid_server/neighbours.hpp"

#include <algorithm>

#include "configs/scene_capacity.hpp"
#include "fluid_server/sweeps.hpp"

namespace wade::fluid {

namespace {

ClusterPlaces places_of(const Particles& p, std::size_t begin, std::size_t end) {
    ClusterPlaces places;
    for (std::size_t l = 0; l < cluster_size; ++l) {
        const std::size_t i = std::min(begin + l, end - 1);
        places.x[l] = p.x[i], places.y[l] = p.y[i], places.z[l] = p.z[i];
    }
    return places;
}

ClusterPlaces mapped(const ClusterPlaces& places, const RigidMap& map) {
    ClusterPlaces image;
    for (std::size_t l = 0; l < cluster_size; ++l) {
        const Vec3 x = map({places.x[l], places.y[l], places.z[l]});
        image.x[l] = x[0], image.y[l] = x[1], image.z[l] = x[2];
    }
    return image;
}

Box box_round(const ClusterPlaces& places) {
    Box box{{Box::inf, Box::inf, Box::inf}, {-Box::inf, -Box::inf, -Box::inf}};
    const auto grow = [&](std::size_t axis, const std::array<float, cluster_size>& x) {
        for (const float v : x) {
            box.lo[axis] = std::min(box.lo[axis], v);
            box.hi[axis] = std::max(box.hi[axis], v);
        }
    };
    grow(0, places.x), grow(1, places.y), grow(2, places.z);
    return box;
}

// Whether a particle at x sees one at y, or its image in a mirror.
bool sees(const Solids& solids, const Vec3& x, const Vec3& y, const Mirror& mirror, bool by_obstacle) {
    if (mirror.facet >= 0 && !solids.sees_in_facet(x, y, mirror)) {
        return false;
    }
    return !by_obstacle ||
           (mirror.obstacle < 0 ? solids.visible(x, mirror.reflect(y)) : solids.sees_image(x, y, mirror));
}

// Room of a thread.
std::vector<std::uint32_t>& room_for_candidates() {
    thread_local std::vector<std::uint32_t> room;
    return room;
}

// Finds the lists of one block.
class BlockSearch {
 public:
    BlockSearch(const CellGrid& grid, const Solids& solids, const Particles& particles, float support_radius,
                NeighbourBlock& block)
        : grid_(grid), solids_(solids), p_(particles), h_(support_radius), block_(block) {}

    void find(std::size_t begin, std::size_t end) {
        entries_ = 0;
        block_.segments.clear();
        block_.first_segment.fill(0);
        for (std::size_t c = 0; c < clusters_per_block; ++c) {
            const std::size_t first = begin + c * cluster_size;
            if (first < end) {
                add_cluster(first, std::min(first + cluster_size, end));
            }
            block_.first_segment[c + 1] = static_cast<std::uint32_t>(block_.segments.size());
        }
    }

 private:
    void add_cluster(std::size_t begin, std::size_t end) {
        const ClusterPlaces places = places_of(p_, begin, end);
        const Box box = box_round(places);
        const bool by_obstacle = solids_.obstacle_near(box);
        add_segments(places, {}, by_obstacle);
        solids_.mirrors_near(box, block_.mirrors);
        for (const Mirror& mirror : block_.mirrors) {
            add_segments(places, mirror, by_obstacle);
        }
    }

    // The segments of what is seen in a mirror: one, and one for each periodic border across which some of it lies.
    void add_segments(const ClusterPlaces& places, const Mirror& mirror, bool by_obstacle) {
        const RigidMap map = mirror.map();
        const Box near = grown(box_round(mapped(places, map)));
        grid_.for_each_period(near.lo, near.hi, [&](const Vec3& period) {
            NeighbourBlock::Segment segment;
            segment.obstacle = static_cast<std::int16_t>(mirror.obstacle);
            segment.obstacle_axis = static_cast<std::int16_t>(mirror.obstacle_axis);
            segment.by_sight = by_obstacle || mirror.facet >= 0;
            segment.viscous = mirror.viscous;
            segment.map = map;
            for (std::size_t k = 0; k < 3; ++k) {
                segment.map.shift[k] -= period[k];  // instead of shifting the particles
            }
            const std::size_t first = entries_;
            const ClusterPlaces image = mapped(places, segment.map);
            append(image);
            if (segment.by_sight) {
                keep_seen(places, image, mirror, period, by_obstacle, first);
            }
            if (entries_ > first) {
                segment.end = static_cast<std::uint32_t>(entries_);
                block_.segments.push_back(segment);
            }
        });
    }

    [[nodiscard]] Box grown(Box box) const {
        for (std::size_t k = 0; k < 3; ++k) {
            box.lo[k] -= h_;
            box.hi[k] += h_;
        }
        return box;
    }

    // Appends the particles that are nearer than the support radius to one of these places.
    void append(const ClusterPlaces& places) {
        const Box box = box_round(places);
        const Box near = grown(box);
        block_.runs.clear();
        std::size_t most = cluster_size;
        grid_.for_each_run(near.lo, near.hi, [&](std::uint32_t begin, std::uint32_t end) {
            block_.runs.push_back({begin, end});
            most += end - begin;
        });
        std::vector<std::uint32_t>& room = room_for_candidates();
        room.resize(std::max(room.size(), most));
        const std::size_t found = append_near(places, box, h_, p_, block_.runs, room.data());
        const std::size_t end = entries_ + found;
        if (block_.j.size() < end) {
            block_.j.resize(end + end / 16);
            block_.lanes.resize(block_.j.size());
        }
        std::copy_n(room.begin(), found, block_.j.begin() + static_cast<std::ptrdiff_t>(entries_));
        entries_ = end;
    }

    // Keeps of the entries from `first` on those that some lane sees, and notes which do.
    void keep_seen(const ClusterPlaces& places, const ClusterPlaces& image, const Mirror& mirror, const Vec3& period,
                   bool by_obstacle, std::size_t first) {
        std::size_t kept = first;
        for (std::size_t k = first; k < entries_; ++k) {
            const std::uint32_t j = block_.j[k];
            const Vec3 at{p_.x[j] + period[0], p_.y[j] + period[1], p_.z[j] + period[2]};
            unsigned lanes = 0;
            for (std::size_t l = 0; l < cluster_size; ++l) {
                const float dx = image.x[l] - p_.x[j];
                const float dy = image.y[l] - p_.y[j];
                const float dz = image.z[l] - p_.z[j];
                if (dx * dx + dy * dy + dz * dz < h_ * h_ &&
                    sees(solids_, {places.x[l], places.y[l], places.z[l]}, at, mirror, by_obstacle)) {
                    lanes |= 1U << l;
                }
            }
            block_.j[kept] = j;
            block_.lanes[kept] = static_cast<std::uint16_t>(lanes);
            kept += lanes != 0 ? 1U : 0U;
        }
        entries_ = kept;
    }

    const CellGrid& grid_;
    const Solids& solids_;
    const Particles& p_;
    float h_;
    NeighbourBlock& block_;
    std::size_t entries_ = 0;
};

}  // namespace

Kernel make_kernel(const Fluid& fluid) {
    const auto h = static_cast<float>(support_radius_of(fluid));
    return fluid.kernel == KernelKind::wendland_c2 ? Kernel(WendlandC2(h)) : Kernel(CubicSpline(h, fluid.support_in_spacings));
}

void find_neighbours(const CellGrid& grid, const Solids& solids, const Particles& p, float support_radius,
                     NeighbourLists& lists) {
    lists.count = p.count;
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        BlockSearch(grid, solids, p, support_radius, lists.blocks[b]).find(begin, end);
    });
}

}  // namespace wade::fluid
