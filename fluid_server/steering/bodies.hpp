#pragma once
// Spheres in the water: vehicles of their own that particles are pushed away from, with the opposite force on the sphere.

#include <array>
#include <vector>

#include "configs/scene/steering_behaviours.hpp"
#include "fluid_server/particles/solids.hpp"
#include "fluid_server/steering/settings.hpp"

namespace wade::fluid::steering {

struct Body {
    behaviours::Vehicle vehicle;
    double radius = 0;  // m
    double time = 0;    // when it appears, s
    bool present = false;
};

[[nodiscard]] std::vector<Body> make_bodies(const Scene& scene, const Settings& settings);

using Momentum = std::array<double, 3>;  // kg m/s

// Changes the velocity v, m/s, of a particle at x within dt, s, by the push of a body, and so that it does not enter the body;
// mass in kg, mass_factor over the usual. Adds what the body gets to `reaction`.
void push_away(const Body& body, const Settings& settings, const Vec3& x, float dt, double mass, float mass_factor,
               Vec3& v, Momentum& reaction);

}  // namespace wade::fluid::steering
