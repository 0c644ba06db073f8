#pragma once
// Who is near a cluster, and whom it sees: past boxes, in the face of one of them, in a facet of the bed. The rules stand in solids.hpp.
//
// Whom a particle sees, how much of it, and in which order does not depend on who else is in its cluster: vectors of any length give
// the same bits. What is left out for a cluster as a whole is what none of its particles sees anything of, and on a site walls beyond
// the 64 that may stand in the way of one cluster (docs/limits.md).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fluid_server/neighbours/neighbour_lists.hpp"

namespace wade::fluid {

// A cluster that looks round.
struct Watchers {
    const ClusterPlaces& places;
    const Box& box;  // round them
    std::span<const Box>
        obstacles;    // that may stand in the way; none unless one is nearer than the support radius and delta
    float delta = 0;  // half the width over which sight fades at their edges, m
};

// How it looks: as it is, in a mirror, beyond a border.
struct Sight {
    const ClusterPlaces& image;  // of the watchers, as near to a particle as they are to what they see
    const Mirror& mirror;
    const Box* obstacle = nullptr;    // whose face the mirror is
    const BedFacet* facet = nullptr;  // that the mirror is
    Vec3 period{};                    // m, by which what is seen is shifted
};

// Keeps of the entries [first, last) of a block those that some watcher sees and that are nearer to it than the support radius;
// writes which lanes do. Returns the end of those that are left. The block needs room for the masks. Without obstacles, over a
// facet of the bed:
std::size_t keep_seen_over_facet(const Watchers& watchers, const Sight& sight, float support_radius,
                                 const Particles& particles, std::size_t first, std::size_t last,
                                 NeighbourBlock& block);
// and past obstacles, in part. Writes how much each of the lanes sees, in units of 1 / whole_share, from `shares` on, which moves
// behind the last; there must be room for cluster_size of them an entry.
std::size_t keep_seen_in_part(const Watchers& watchers, const Sight& sight, float support_radius,
                              const Particles& particles, std::size_t first, std::size_t last, NeighbourBlock& block,
                              std::uint16_t*& shares);

// The particles near a cluster, side by side.
struct NearParticlesOfCluster {
    std::size_t size = 0;  // of those in use; there is room for a vector more
    std::vector<std::uint32_t> j;
    std::vector<float> x, y, z;
    // Room for a search: bits of the cluster's lanes, some of the particles, the lanes that are near these.
    std::vector<std::int32_t> lanes;
    std::vector<std::uint32_t> chosen, near_lanes;

    void assign(std::span<const std::uint32_t> numbers, const Particles& particles);
};

// The same of all particles near a cluster, in half of the time: appends those that are seen behind `first` entries. box: round the
// images of the watchers. Without periods and facets; the block needs room for all of them. Past obstacles:
std::size_t append_seen_past(const Watchers& watchers, const Sight& sight, const Box& box, float support_radius,
                             NearParticlesOfCluster& near, std::size_t first, NeighbourBlock& block,
                             std::uint16_t*& shares);

// A box round the images of those places from which a particle nearer than h may be seen in the face of an obstacle; its upper
// bounds are below its lower ones if there are none. The others see nothing there: an end of a line no longer than h is within
// delta of the face's edges.
Box box_facing(const ClusterPlaces& places, const ClusterPlaces& image, const Mirror& mirror, const Box& obstacle,
               float h, float delta);

// Those near particles that lanes may see in a face of an obstacle, in views that differ by a bed or a lid only.
struct BeforeFace {
    std::size_t size = 0;
    std::vector<std::uint32_t> e, lanes;  // which near particle; who may see it
    std::vector<std::uint8_t> known;      // whether `share` tells how much of it is seen in plan, cluster_size each
    std::vector<float> share;

    void make_room(std::size_t near);
};
// Finds these, and forgets those of another face;
void note_before_face(const Watchers& watchers, const Mirror& mirror, const Box& obstacle, float support_radius,
                      const NearParticlesOfCluster& near, BeforeFace& before);
// appends those that are seen, and keeps what it learns for the next view.
std::size_t append_seen_in_face(const Watchers& watchers, const Mirror& mirror, const Box& obstacle,
                                float support_radius, NearParticlesOfCluster& near, BeforeFace& before,
                                std::size_t first, NeighbourBlock& block, std::uint16_t*& shares);

// Writes those particles of the runs to `out` that are nearer than the support radius to a box. Returns their number. Needs
// room for all particles of the runs and largest_cluster more.
std::size_t find_near_box(const Box& box, float support_radius, const Particles& particles, std::span<const Run> runs,
                          std::uint32_t* out);

// Writes those candidates to `out` that are nearer than the support radius to some place of a cluster. Returns their number.
// Needs room for all candidates and one more.
std::size_t find_near_places(const ClusterPlaces& places, float support_radius, const Particles& particles,
                             std::span<const std::uint32_t> candidates, std::uint32_t* out);

}  // namespace wade::fluid
