#pragma once
// The solids that confine the water: bed, banks, end walls and box obstacles.
//
// Solids are smooth mirrors (method of images). A particle near a face sees the mirror images of its neighbours, and of
// itself, behind that face: their mass, pressure and mirrored velocity. Density, pressure and viscous forces then need
// no case for solids: a lattice next to a wall has exactly rest density, forces between particles and images are equal
// and opposite, energy is neither gained nor lost, the flow slips freely along the face and none crosses it.
//
//        images across y | fluid             A concave edge such as bed and bank shows three families of images: mirrored
//         and z, twice   | images across y   across either face, and across both.
//       -----------------+-----------------
//         images across  |                   At a convex edge of an obstacle visibility decides: a particle sees
//         z              |  o   fluid        another if the straight line between them is free, and the image of another
//                                            if the line to the image passes through the mirror's face. So all space
//                                            round a particle is filled exactly once. Close to the edge it sees a part
//                                            of either (sight-inl.hpp), or water would never rest there.
//
// Images of images are left out: of obstacles and banks nearer than two support radii, and of opposite walls.
//
// A bed with bed_points consists of facets (bed_profile.hpp). A particle sees another in the facet below the point
// halfway between them: pairs stay symmetric, and gentle changes of slope leave neither gap nor overlap that matters.
//
// At a no-slip face (channel.no_slip) the viscosity uses another velocity of the images, see ImageVelocity; for
// pressure every face is smooth.
//
// Contact is for what pressure cannot carry: single particles and sheets thinner than the spacing have less than rest
// density and so no pressure. Their centres stay a contact distance away from every face.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/box_index.hpp"
#include "fluid_server/particles/mirror.hpp"
#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

// A particle stands for a cube of side d; its centre may come as near to a face as this fraction of d. Pressure keeps
// a filled layer at about d/2, so that contact acts on thin sheets only.
inline constexpr float contact_fraction = 0.4F;

// Visibility fades over this fraction of d on either side of an edge. Measured with a house in a lake at rest, RMS
// speed of the water and largest compression: sharp 0.050 m/s and 0.21, 0.15 d 0.039 m/s, 0.3 d 0.010 m/s and 0.013.
// Less than the contact fraction, so that a flat face is seen as a whole.
inline constexpr float sight_fraction = 0.3F;
static_assert(sight_fraction < contact_fraction);

// Positions of particles, m, as arrays.
struct Places {
    const float *x, *y, *z;
};

// Velocities of the particles of a block, m/s.
struct BlockVelocities {
    std::array<float, block_size> x, y, z;
};

class Solids {
    // Number of consecutive particles that share one obstacle query for their displacements.
    static constexpr std::size_t contact_group = 16;

 public:
    // Bed, lid if there is one, banks unless the sides are periodic, end walls if the channel is closed, and all obstacles.
    explicit Solids(const Scene& scene);

    // Replaces `found` by the obstacles that matter to the particles of a box: all that are nearer to it than the
    // support radius plus sight_delta().
    void find_obstacles(const Box& box, BoxNumbers& found) const;

    // Replaces `mirrors` by the mirrors that may show a particle of a box images nearer than the support radius.
    void mirrors_near(const Box& box, const BoxNumbers& obstacles, std::vector<Mirror>& mirrors) const;

    // Returns true if an obstacle is nearer to a box than the support radius plus sight_delta(), so that visibility
    // must be tested per pair (sight.hpp). A particle farther away sees all neighbours past it and no images in its
    // faces, whatever else is in the box.
    [[nodiscard]] bool obstacle_near(const Box& box, const BoxNumbers& obstacles) const;

    // Return the obstacle with the mirror as a face, and the bed facet that is the mirror; null if there is none.
    [[nodiscard]] const Box* obstacle_of(const Mirror& mirror) const {
        return mirror.obstacle < 0 ? nullptr : &obstacles_[static_cast<std::size_t>(mirror.obstacle)];
    }
    [[nodiscard]] const BedFacet* facet_of(const Mirror& mirror) const {
        return mirror.facet < 0 ? nullptr : &bed_[static_cast<std::size_t>(mirror.facet)];
    }

    // Unilateral, inelastic contact: reduces the velocities v of `count` particles, at most block_size, at positions x
    // so that after x + dt v their centres are no nearer than the contact distance to any face. Bed, lid, banks and
    // ends come first, then each obstacle. Calls on_obstacle(its index, particle, the velocity it took away).
    template <typename OnObstacle>
    void apply_contact(const Places& x, std::size_t count, float dt, BlockVelocities& v,
                       OnObstacle&& on_obstacle) const {
        apply_border_contact(x, count, dt, v);
        if (obstacles_.empty()) return;
        for (std::size_t begin = 0; begin < count; begin += contact_group) {
            const std::size_t end = std::min(begin + contact_group, count);
            const Box way = way_of(x, begin, end, dt, v);
            for (const std::uint32_t o : obstacles_on(way)) {
                if (!may_enter(way, obstacles_[o])) continue;
                const std::array<bool, contact_group> enters = who_enters(obstacles_[o], x, begin, end, dt, v);
                for (std::size_t i = begin; i < end; ++i) {
                    if (!enters[i - begin]) continue;
                    Vec3 u{v.x[i], v.y[i], v.z[i]};
                    if (apply_obstacle_contact(obstacles_[o], {x.x[i], x.y[i], x.z[i]}, dt, u)) {
                        on_obstacle(o, i, Vec3{v.x[i] - u[0], v.y[i] - u[1], v.z[i] - u[2]});
                        v.x[i] = u[0], v.y[i] = u[1], v.z[i] = u[2];
                    }
                }
            }
        }
    }

    // Moves a point that is inside a solid to the nearest free point; true if it had to. A last guard.
    bool clamp(Vec3& x) const {
        const bool free = bed_.empty() && contains(interior_, x) && !is_in_obstacle(x);
        return !free && push_out(x);
    }

    // Half the width of the fade of visibility at an edge of an obstacle, m: sight-inl.hpp.
    [[nodiscard]] float sight_delta() const { return sight_delta_; }

    [[nodiscard]] const Box& interior() const { return interior_; }
    [[nodiscard]] const std::vector<Box>& obstacles() const { return obstacles_; }

 private:
    [[nodiscard]] bool near(const Box& a, const Box& b) const;  // as obstacle_near() says
    void add_facet_mirrors(const Box& box, std::size_t before, std::vector<Mirror>& mirrors) const;
    void add_obstacle_mirrors(const Box& box, const BoxNumbers& obstacles, std::vector<Mirror>& mirrors) const;
    // Returns a box round the displacements of particles [begin, end). Contact makes no displacement longer.
    [[nodiscard]] Box way_of(const Places& x, std::size_t begin, std::size_t end, float dt,
                             const BlockVelocities& v) const;
    // Returns the obstacles near a displacement; valid until the next call of the thread.
    [[nodiscard]] const BoxNumbers& obstacles_on(const Box& way) const;
    [[nodiscard]] bool may_enter(const Box& way, const Box& obstacle) const;
    // Which of particles [begin, end) would come nearer to an obstacle than the contact distance.
    [[nodiscard]] std::array<bool, contact_group> who_enters(const Box& obstacle, const Places& x, std::size_t begin,
                                                             std::size_t end, float dt, const BlockVelocities& v) const;
    void apply_border_contact(const Places& x, std::size_t count, float dt, BlockVelocities& v) const;
    [[nodiscard]] bool is_in_obstacle(const Vec3& x) const {
        if (obstacles_.empty()) return false;
        const std::span<const std::uint32_t> here = index_.at(x[0], x[2]);
        return std::any_of(here.begin(), here.end(), [&](std::uint32_t o) { return is_inside(obstacles_[o], x); });
    }
    bool push_out(Vec3& x) const;
    bool apply_obstacle_contact(const Box& box, const Vec3& x, float dt, Vec3& v) const;

    Box interior_;
    std::vector<BedFacet> bed_;  // empty: the plane y = 0, part of the interior
    std::vector<float> falls_;   // of the bed below each of its facets nearby, m
    // Velocity of the no-slip planes: at the lower and the upper end of each axis, and of the obstacles.
    std::array<std::array<std::optional<Vec3>, 2>, 3> sticks_;
    std::optional<Vec3> obstacles_stick_;
    std::vector<Box> obstacles_;  // reach down through the bed, and through a wall that they touch
    BoxIndex index_;              // of them
    float support_radius_;
    float contact_distance_;
    float sight_delta_;
};

}  // namespace wade::fluid
