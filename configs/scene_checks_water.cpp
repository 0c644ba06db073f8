// Whether the water can be simulated: flow, spacing, capacity, solver limits.

#include "configs/scene_capacity.hpp"
#include "configs/scene_checks.hpp"

namespace wade {

namespace {

// Slack for sums like 6 * 0.05 that miss their decimal value by rounding.
constexpr double rounding = 1e-9;

bool carries_water(const Channel& channel) {
    return channel.flow != Flow::closed || !channel.water_blocks.empty();
}

void check_flow(const Channel& channel, const std::string& source) {
    if (channel.flow != Flow::closed && !channel.water_blocks.empty()) {
        refuse(source, "/channel/water_blocks",
               "blocks of water need flow \"closed\"; the other flows start dry or filled, see initial_river.");
    }
    if (channel.flow == Flow::closed && channel.initial_river == InitialRiver::filled) {
        refuse(source, "/channel/initial_river",
               "\"filled\" needs flow \"emitter\" or \"recirculating\"; a closed channel is filled by water_blocks.");
    }
    if (channel.flow == Flow::closed && channel.velocity != 0) {
        refuse(source, "/channel/velocity_m_s",
               short_number(channel.velocity) + " m/s has no effect in a closed channel; allowed: 0 m/s.");
    }
    if (channel.flow == Flow::recirculating && channel.initial_river == InitialRiver::dry) {
        refuse(source, "/channel/initial_river",
               "a recirculating channel keeps the water that it starts with, so \"dry\" would leave it empty; allowed: "
               "\"filled\".");
    }
    if (channel.flow == Flow::emitter && !(channel.velocity > 0)) {
        refuse(source, "/channel/velocity_m_s",
               short_number(channel.velocity) + " m/s: an emitter needs a velocity; allowed: > 0 m/s.");
    }
}

void check_spacing(const Scene& scene, const std::string& source) {
    const double d = scene.fluid.particle_spacing;
    const auto check = [&](double size, const std::string& what) {
        if (d <= size * (1 + rounding)) return;
        refuse(source, "/fluid/particle_spacing_m",
               short_number(d) + " m is larger than " + what + " of " + short_number(size) +
                   " m; allowed: <= " + short_number(size) + " m.");
    };
    const Channel& channel = scene.channel;
    check(channel.x.length(), "the channel's length");
    check(channel.z.length(), "the channel's width");
    if (channel.flow != Flow::closed) check(channel.depth, "the channel's depth");
    for (std::size_t i = 0; i < channel.water_blocks.size(); ++i) {
        const WaterBlock& block = channel.water_blocks[i];
        const std::string name = " of /channel/water_blocks/" + std::to_string(i);
        check(block.x.length(), "the length" + name);
        check(block.z.length(), "the width" + name);
        check(block.depth, "the depth" + name);
    }
}

// A particle's neighbours reach over 2 d, in cells of that size; with fewer than three cells along a periodic axis a
// particle would meet a neighbour twice, or itself.
void check_periodic(const Scene& scene, const std::string& source) {
    const double shortest = 6 * scene.fluid.particle_spacing;
    const auto check = [&](const Interval& extent, const std::string& pointer, const std::string& what) {
        if (extent.length() >= shortest * (1 - rounding)) return;
        refuse(source, pointer,
               what + " " + short_number(extent.length()) +
                   " m, so that a particle would meet itself across the joint; " +
                   "allowed: >= 6 fluid.particle_spacing_m = " + short_number(shortest) + " m.");
    };
    const Channel& channel = scene.channel;
    if (channel.flow == Flow::recirculating)
        check(channel.x, "/channel/x_max_m", "the recirculating channel's length is");
    if (channel.sides == Sides::periodic) check(channel.z, "/channel/z_max_m", "the width between periodic sides is");
}

// A given stream meets nothing and has no end walls.
void check_kinematic(const Scene& scene, const std::string& source) {
    if (scene.fluid.model != FluidModel::kinematic) return;
    if (scene.channel.flow == Flow::closed) {
        refuse(source, "/fluid/model",
               "\"kinematic\" is a stream, and /channel/flow is \"closed\"; allowed: \"emitter\" and "
               "\"recirculating\".");
    }
    if (!scene.obstacles.empty()) {
        refuse(source, "/fluid/model",
               "\"kinematic\" does not flow round obstacles, and /obstacles holds " +
                   std::to_string(scene.obstacles.size()) +
                   "; allowed: a model that solves for the water, such as "
                   "\"dfsph\".");
    }
}

void check_limits(const PressureSolve& solve, const std::string& source, const std::string& pointer) {
    if (solve.max_iterations == 0 || solve.min_iterations <= solve.max_iterations) return;
    refuse(source, pointer + "/min_iterations",
           std::to_string(solve.min_iterations) + " is more than max_iterations = " +
               std::to_string(solve.max_iterations) + "; allowed: <= " + std::to_string(solve.max_iterations) + ".");
}

}  // namespace

void check_water(const Scene& scene, const std::string& source) {
    check_flow(scene.channel, source);
    check_kinematic(scene, source);
    check_limits(scene.fluid.density_solve, source, "/fluid/density_solve");
    check_limits(scene.fluid.divergence_solve, source, "/fluid/divergence_solve");
    if (!carries_water(scene.channel)) return;
    check_spacing(scene, source);
    check_periodic(scene, source);
    const std::uint64_t needed = particles_needed(scene);
    if (static_cast<std::uint64_t>(scene.fluid.max_particles) < needed) {
        refuse(source, "/fluid/max_particles",
               std::to_string(scene.fluid.max_particles) +
                   " particles are too few for the water of this scene at a spacing of " +
                   short_number(scene.fluid.particle_spacing) + " m; allowed: >= " + std::to_string(needed) + ".");
    }
}

}  // namespace wade
