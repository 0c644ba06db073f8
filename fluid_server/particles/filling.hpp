#pragma once
// Places particles at t = 0.

#include <cstdint>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/particles/solids.hpp"

namespace wade::fluid {

// Particles that fill an extent, m: it over the spacing, rounded, and at least one.
int count_along(double extent, double spacing);

// What blocks of water are filled into.
struct Surroundings {
    double spacing = 0;  // d, m
    double gravity = 0;  // across the bed, m/s2; water that stands on the bed starts with the pressure of water at rest
    bool lid = false;    // nothing may stand out above a block
    std::vector<BedFacet> bed{};  // empty: the plane y = 0
    std::vector<Obstacle> obstacles{};
};

// Whether a particle of this spacing may be put at a place: its centre is not in an obstacle, nor nearer than 0.45 spacings.
[[nodiscard]] bool is_free(const Vec3& place, const std::vector<Obstacle>& obstacles, double spacing);

// Fills a block of water with exactly round(volume / d^3) particles moving at its velocity, so that the mass is that of
// the water to within half a particle; over an uneven bed in slabs one spacing long, and to within one particle. Every
// site has the volume d^3, so that nothing starts compressed: layers from below, the uppermost with sites left out evenly;
// without a lid it may stand out by half a spacing.
// Sites inside or too near to an obstacle are left out as well and are not made up for. Throws std::length_error if there
// is no room.
void fill_block(Particles& particles, const WaterBlock& block, const Surroundings& surroundings);

// Fills what the scene wants filled at t = 0: its river, its blocks of water.
void fill_scene(Particles& particles, const Scene& scene);

// Whether water of a volume, m^3, leaves no free surface: under a lid, or between top and bottom that are one, to 5 %.
[[nodiscard]] bool fills_channel(const Scene& scene, double volume);

}  // namespace wade::fluid
