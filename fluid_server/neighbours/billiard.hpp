#pragma once
// Visibility between particles on a site: past walls at any angle, and of mirror images in these walls.
//
// An image is visible if the straight line to it, folded at the walls, is the path of a billiard ball in the water:
//
//      j'.     |           The path meets the walls s = (k1 .. kn) in this order; R_k x = x - 2 d_k(x) n_k.
//         ' .  |k1         The cluster moves, x~ = M x, M = R_kn .. R_k1, so that the list names ordinary particles.
//             '|. i        The line from x_i to M^-1 x_j meets k1, k2, .. in this order inside of the walls, and nothing
//             .|'          else. Each direction from a particle has one such path, so that any point round it is filled
//         . '  |           once, in corners of any angle. Walls at right angles commute: one image has two orders, and
//       j      |           the order with a free path counts.
//
// The path back from j is the same one with M^-1, so that forces are opposite: g_ji = -Q g_ij.
//
// All of this is in plan, because walls are vertical. The ground then mirrors in the plane below the middle of the
// path, with R_p between the walls met before the middle and the walls met after it: the ground continues evenly behind
// walls. A path meets up to three walls.
//
// Visibility fades at the edges of walls, where the water turns by more than a half turn (sight-inl.hpp). A path that
// passes an edge at a distance e in plan, negative if it hits a wall there, counts with the fraction
//
//   clamp(1/2 + e / (2 delta), 0, 1)
//
// A reflected path counts with the same formula; e is then the distance of its line from the wall's edge, positive if
// the path meets the wall within the edge. Both apply only if the foot of the edge lies on the unfolded path, so that
// the two fractions add up to one. A path that ends before it passes the edge sees all or nothing.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fluid_server/neighbours/neighbour_lists.hpp"
#include "fluid_server/neighbours/sight.hpp"
#include "fluid_server/particles/site/site_solids.hpp"

namespace wade::fluid {

inline constexpr std::size_t longest_path = 3;  // walls

// Walls of the site that may block a path near a cluster, and their edges.
struct Obstruction {
    static constexpr std::size_t most = 64;  // of either
    struct Edge {
        PlanPoint at;
        std::uint64_t walls = 0;  // that end there, a bit each
    };
    std::vector<std::uint32_t> numbers;  // of the walls, among all
    std::vector<Wall> walls;
    std::vector<Edge> edges;

    // The bits of a wall, of the walls that continue from its edges, and of these edges: a path reflected at the wall
    // meets none of them.
    struct Beside {
        std::uint64_t walls = 0, edges = 0;
    };
    [[nodiscard]] Beside beside(std::uint32_t wall, const Wall& at) const;
};

// A sequence of walls.
struct WallPath {
    std::size_t length = 0;
    std::array<std::uint32_t, longest_path> number{};
    std::array<Wall, longest_path> wall{};
    std::array<Obstruction::Beside, longest_path> beside{};
    TurnedMap map;  // M

    [[nodiscard]] std::int32_t house() const { return length > 0 ? wall[0].house : -1; }
};

inline TurnedMap reflected_first(const TurnedMap& after, const Wall& wall) {
    return reflected_first(after, {wall.nx, 0, wall.nz}, wall.nx * wall.a.x + wall.nz * wall.a.z);
}

// R_p between the walls that are met before and the others.
inline TurnedMap with_ground(const WallPath& path, std::size_t before, const GroundPlane& plane) {
    TurnedMap map;
    for (std::size_t m = path.length; m > before; --m) map = reflected_first(map, path.wall[m - 1]);
    map = reflected_first(map, plane.n, plane.c);
    for (std::size_t m = before; m > 0; --m) map = reflected_first(map, path.wall[m - 1]);
    return map;
}

// What is asked about the paths from a cluster to the particles near it.
struct PathQuestion {
    const WallPath& path;
    const Obstruction* obstruction = nullptr;  // null: all paths are free
    std::int32_t order = 0;   // its number among those of one image; from 1 on it adds to what has been found
    std::int32_t orders = 1;  // how many these are
    std::int32_t like = 0;    // that of the first that meets the same walls: in keys, but between two walls
    bool has_keys = false;    // whether keys are asked for
    const GroundFacets* ground = nullptr;  // if not null, asks for the plane under the middle too
    float support_radius = 0, delta = 0;   // m
};

// Key of an image path: its order of walls, the ground plane that mirrors it, and the number of walls before its
// middle, which lies over that plane.
struct SightKey {
    static constexpr std::int32_t places_of_middle = longest_path + 1;
    std::int32_t value = 0;

    // Of ground of so many planes: how many orders keys can tell apart, 16 at least (GroundFacets::most_planes).
    static constexpr std::size_t most_orders(std::size_t planes) {
        return static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() / places_of_middle) / planes;
    }
    // orders: how many there are of this image.
    [[nodiscard]] std::size_t plane(std::size_t orders) const { return of_all() / places_of_middle / orders; }
    [[nodiscard]] std::size_t order(std::size_t orders) const { return of_all() / places_of_middle % orders; }
    [[nodiscard]] std::size_t walls_before() const { return of_all() % places_of_middle; }

 private:
    [[nodiscard]] std::size_t of_all() const { return static_cast<std::size_t>(value); }
};
static_assert(SightKey::most_orders(GroundFacets::most_planes) >= 16);

// For each near particle, lanes as in the lists.
struct PathsFound {
    std::vector<float> share;         // of whole_share, whole numbers
    std::vector<std::int32_t> key;    // SightKey, if asked for
    std::vector<std::uint16_t> seen;  // lanes that see it
    bool in_part = false;             // some share is neither none nor all

    void make_room(std::size_t near, std::size_t lanes);
};
void find_paths(const ClusterPositions& places, const NearParticlesOfCluster& near, const PathQuestion& question,
                PathsFound& found);

// A near particle and lanes that see it.
struct SeenNear {
    std::uint32_t k = 0;
    std::uint16_t lanes = 0;
};
struct SeenByKey {
    SightKey key;
    std::vector<SeenNear> seen;
};
// Sorts by key what has been found; lists beyond the count returned are room.
std::size_t sort_by_key(const PathsFound& found, std::size_t near, std::vector<SeenByKey>& lists);

// Appends the seen particles within the support radius of the images to the list, the masks and, if `shares` is not
// null, the shares. plane: if not null, the middle of a path must lie above it. There must be room. Returns the end of
// the entries.
std::size_t append_seen(const ClusterPositions& places, const ClusterPositions& image, float support_radius,
                        const GroundPlane* plane, const NearParticlesOfCluster& near, std::span<const SeenNear> seen,
                        const PathsFound& found, std::size_t entries, NeighbourBlock& block, std::uint16_t** shares);

}  // namespace wade::fluid
