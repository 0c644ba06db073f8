#pragma once
// Neighbours that a cluster sees: past boxes, in the face of a box, in a facet of the bed. solids.hpp states the rules.
//
// The neighbours that a particle sees, their fractions and their order do not depend on the other particles of its
// cluster: vectors of any length give the same bits. A cluster as a whole leaves out only neighbours that none of its
// particles sees, and on a site the walls beyond the 64 that may block its view (docs/limits.md).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fluid_server/neighbours/neighbour_lists.hpp"

namespace wade::fluid {

// A cluster that searches for visible neighbours.
struct Watchers {
    const ClusterPositions& places;
    const Box& box;  // round them
    std::span<const Box>
        obstacles;    // that may block the view; none unless one is nearer than the support radius plus delta
    float delta = 0;  // half the width of the fade of visibility at their edges, m
};

// The view of a cluster: direct, in a mirror, or across a periodic border.
struct Sight {
    const ClusterPositions& image;  // of the watchers, as far from a particle as the watchers are from its image
    const Mirror& mirror;
    const Box* obstacle = nullptr;    // obstacle with the mirror as a face, or null
    const BedFacet* facet = nullptr;  // bed facet that is the mirror, or null
    Vec3 period{};                    // shift of the neighbours, m
};

// Filters the entries [first, last) of a block: keeps an entry if some watcher sees it within the support radius, and
// writes the mask of these lanes. Returns the end of the kept entries. The block needs room for the masks. Without
// obstacles, over a facet of the bed:
std::size_t keep_seen_over_facet(const Watchers& watchers, const Sight& sight, float support_radius,
                                 const Particles& particles, std::size_t first, std::size_t last,
                                 NeighbourBlock& block);
// and past obstacles, in part. Writes the visible fraction of each lane, in units of 1 / whole_share, from `shares` on,
// and moves `shares` behind the last; there must be room for cluster_size fractions an entry.
std::size_t keep_seen_in_part(const Watchers& watchers, const Sight& sight, float support_radius,
                              const Particles& particles, std::size_t first, std::size_t last, NeighbourBlock& block,
                              std::uint16_t*& shares);

// The particles near a cluster, side by side.
struct NearParticlesOfCluster {
    std::size_t size = 0;  // particles in use; there is room for a vector more
    std::vector<std::uint32_t> j;
    std::vector<float> x, y, z;
    // Room for a search: bits of the cluster's lanes, some of the particles, the lanes that are near these.
    std::vector<std::int32_t> lanes;
    std::vector<std::uint32_t> chosen, near_lanes;

    void assign(std::span<const std::uint32_t> numbers, const Particles& particles);
};

// The same for all particles near a cluster, in half of the time: appends the visible ones behind `first` entries. box:
// encloses the images of the watchers. Without periods and facets; the block needs room for all particles. Past
// obstacles:
std::size_t append_seen_past(const Watchers& watchers, const Sight& sight, const Box& box, float support_radius,
                             NearParticlesOfCluster& near, std::size_t first, NeighbourBlock& block,
                             std::uint16_t*& shares);

// Returns a box round the images of the positions that may see a particle nearer than h in the face of an obstacle; its
// upper bounds are below its lower ones if there are none. Other positions see nothing there: an end of a line no
// longer than h is within delta of the face's edges.
Box box_facing(const ClusterPositions& places, const ClusterPositions& image, const Mirror& mirror, const Box& obstacle,
               float h, float delta);

// Near particles that lanes may see in a face of an obstacle, in views that differ by a bed or a lid only.
struct BeforeFace {
    std::size_t size = 0;
    std::vector<std::uint32_t> e, lanes;  // index of the near particle; lanes that may see it
    std::vector<std::uint8_t> known;      // whether `share` has its fraction visible in plan, cluster_size each
    std::vector<float> share;

    void make_room(std::size_t near);
};
// Finds these particles, and discards those of another face;
void note_before_face(const Watchers& watchers, const Mirror& mirror, const Box& obstacle, float support_radius,
                      const NearParticlesOfCluster& near, BeforeFace& before);
// appends the visible ones, and stores their fractions for the next view.
std::size_t append_seen_in_face(const Watchers& watchers, const Mirror& mirror, const Box& obstacle,
                                float support_radius, NearParticlesOfCluster& near, BeforeFace& before,
                                std::size_t first, NeighbourBlock& block, std::uint16_t*& shares);

// Writes those particles of the runs to `out` that are nearer than the support radius to a box. Returns their number. Needs
// room for all particles of the runs and largest_cluster more.
std::size_t find_near_box(const Box& box, float support_radius, const Particles& particles, std::span<const Run> runs,
                          std::uint32_t* out);

// Writes those candidates to `out` that are nearer than the support radius to some position of a cluster. Returns their
// number. Needs room for all candidates and one more.
std::size_t find_near_particles(const ClusterPositions& places, float support_radius, const Particles& particles,
                                std::span<const std::uint32_t> candidates, std::uint32_t* out);

}  // namespace wade::fluid
