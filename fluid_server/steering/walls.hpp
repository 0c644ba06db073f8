#pragma once
// Walls that push and take speed: bed, banks, ends, lid, box obstacles. Their hard restriction is Solids::apply_contact.
//
//   push   w ((r / s)^2 - 1) n     loss   - l (1 - s / r) v      s < r: distance to the face, n: its normal

#include <vector>

#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/solids.hpp"
#include "fluid_server/steering/settings.hpp"

namespace wade::fluid::steering {

class Walls {
 public:
    Walls(const Solids& solids, const Channel& channel, const Settings& settings);

    // Adds the acceleration, m/s^2, of a particle of mass 1 at x with velocity v.
    void add_acceleration(const Vec3& x, const Vec3& v, Vec3& a) const {
        if (!is_far(x)) add_near(x, v, a);
    }

    // What a particle of mass 1 at x has in store of the push, m^2/s^2.
    [[nodiscard]] double energy(const Vec3& x) const;

 private:
    [[nodiscard]] bool is_far(const Vec3& x) const { return bed_.empty() && obstacles_.empty() && contains(quiet_, x); }
    void add_near(const Vec3& x, const Vec3& v, Vec3& a) const;
    // Calls on_face(normal, distance) for each face nearer than the radius.
    template <typename OnFace>
    void for_each_face(const Vec3& x, OnFace&& on_face) const;

    Box interior_;
    Box quiet_;  // the interior less the radius
    std::vector<Box> obstacles_;
    BoxIndex index_;  // of the obstacles with what lies within the radius
    std::vector<BedFacet> bed_;
    float radius_, push_, loss_;
};

// Pushes a sphere of radius R, m, out of walls: what its velocity, m/s, may be so that it does not enter one within dt, s.
void keep_sphere_out(const Solids& solids, const std::vector<BedFacet>& bed, const std::array<double, 3>& centre,
                     double radius, double dt, std::array<double, 3>& velocity);

}  // namespace wade::fluid::steering
