// Few particles, or many steps.

#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "stability_case.hpp"
#include "water_run.hpp"

namespace wade::stability {

namespace {

Result zero_particles(const Request& request) {
    return run_water(scene_for(request, "zero_particles"));
}

// It falls onto the bed and stays there.
Result one_particle(const Request& request) {
    return run_water(scene_for(request, "one_particle"));
}

// Two particles at the same position have no direction of separation: nothing may divide by their distance.
Result two_in_one_place(const Request& request) {
    Scene scene = scene_for(request, "two_in_one_place");
    scene.channel->water_blocks.push_back(scene.channel->water_blocks.at(0));
    return run_water(scene);
}

// The same in the middle of a pool: the compression of its neighbourhood must be gone after half a second.
Result twin_in_a_pool(const Request& request) {
    Scene scene = scene_for(request, "twin_in_a_pool", {"/duration_s=1"});
    const double d = scene.fluid->particle_spacing;
    const double depth = scene.channel->water_blocks.at(0).depth;
    WaterBlock twin = scene.channel->water_blocks.at(0);
    twin.x = {twin.x.lo + 4 * d, twin.x.lo + 5 * d};
    twin.z = {twin.z.lo + 4 * d, twin.z.lo + 5 * d};
    twin.depth = d;
    scene.channel->water_blocks.push_back(twin);
    Hooks hooks;
    hooks.settling = 0.5;
    // It is lifted onto the surface.
    hooks.extra_energy = scene.fluid->rest_density * d * d * d * scene.world->gravity * depth;
    return run_water(scene, hooks);
}

// A stream round a block; every step is a chance to slip through a wall or to lose a count.
Result leak(const Request& request) {
    Hooks hooks;
    hooks.steps = request.long_form ? 1'000'000 : request.quick ? 500 : 5'000;
    return run_water(scene_for(request, "leak"), hooks);
}

}  // namespace

std::vector<Case> particle_cases() {
    return {
        {"zero_particles", "a scene without water", zero_particles},
        {"one_particle", "a particle without neighbours", one_particle},
        {"two_in_one_place", "two particles in one place: a division by their distance", two_in_one_place},
        {"twin_in_a_pool", "two particles in one place within a pool", twin_in_a_pool},
        {"leak", "particles leak in a long run; a million steps by option", leak},
    };
}

}  // namespace wade::stability
