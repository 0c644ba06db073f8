// Whether the water can be simulated: flow, spacing, capacity, solver limits.

#include <algorithm>
#include <cmath>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/world.hpp"

namespace wade {

namespace {

bool carries_water(const Channel& channel) {
    return channel.flow != Flow::closed || !channel.water_blocks.empty();
}

// Which water there is at t = 0.
void check_start(const Channel& channel, const std::string& source) {
    const bool filled = channel.initial_river == InitialRiver::filled;
    const bool takes_blocks = channel.flow == Flow::closed || channel.flow == Flow::periodic;
    if (!takes_blocks && !channel.water_blocks.empty()) {
        refuse(source, "/channel/water_blocks",
               "blocks of water need flow \"closed\" or \"periodic\"; the other flows start dry or filled, see "
               "initial_river.");
    }
    if (channel.flow == Flow::closed && filled) {
        refuse(source, "/channel/initial_river",
               "\"filled\" needs flow \"emitter\", \"recirculating\" or \"periodic\"; a closed channel is filled by "
               "water_blocks.");
    }
    if (channel.flow == Flow::recirculating && !filled) {
        refuse(source, "/channel/initial_river",
               "a recirculating channel keeps the water that it starts with, so \"dry\" would leave it empty; allowed: "
               "\"filled\".");
    }
    if (channel.flow != Flow::periodic) return;
    if (filled && !channel.water_blocks.empty()) {
        refuse(
            source, "/channel/water_blocks",
            "a periodic channel whose initial_river is \"filled\" has no room for blocks of water; allowed: none, or "
            "initial_river \"dry\".");
    }
    if (!filled && channel.water_blocks.empty()) {
        refuse(source, "/channel/initial_river",
               "a periodic channel keeps the water that it starts with, so \"dry\" without water_blocks would leave it "
               "empty; allowed: \"filled\", or \"dry\" with water_blocks.");
    }
}

void check_flow(const Channel& channel, const std::string& source) {
    if (channel.flow == Flow::closed && channel.velocity != 0) {
        refuse(source, "/channel/velocity_m_s",
               short_number(channel.velocity) + " m/s has no effect in a closed channel; allowed: 0 m/s.");
    }
    if (channel.flow == Flow::periodic && !channel.water_blocks.empty() && channel.velocity != 0) {
        refuse(source, "/channel/velocity_m_s",
               short_number(channel.velocity) +
                   " m/s has no effect in a periodic channel that starts with water_blocks, which have velocities of "
                   "their own; allowed: 0 m/s.");
    }
    if (channel.flow != Flow::emitter) return;
    if (channel.velocity_history.empty() && !(channel.velocity > 0)) {
        refuse(source, "/channel/velocity_m_s",
               short_number(channel.velocity) + " m/s: an emitter needs a velocity; allowed: > 0 m/s.");
    }
    const bool ever_flows = std::any_of(channel.velocity_history.begin(), channel.velocity_history.end(),
                                        [](const VelocityPoint& point) { return point.velocity > 0; });
    if (!channel.velocity_history.empty() && !ever_flows) {
        refuse(source, "/channel/velocity_history",
               "all velocities are 0 m/s: an emitter needs a velocity; allowed: at least one > 0 m/s.");
    }
}

void check_spacing(const Scene& scene, const std::string& source) {
    const double d = scene.fluid->particle_spacing;
    const auto check = [&](double size, const std::string& what) {
        if (d <= size * (1 + rounding_tolerance)) return;
        refuse(source, "/fluid/particle_spacing_m",
               short_number(d) + " m is larger than " + what + " of " + short_number(size) +
                   " m; allowed: <= " + short_number(size) + " m.");
    };
    const Channel& channel = scene.channel;
    check(channel.x.length(), "the channel's length");
    check(channel.z.length(), "the channel's width");
    if (has_river(channel)) check(channel.depth, "the channel's depth");
    if (channel.top != Top::open) check(channel.height, "the channel's height");
    for (std::size_t i = 0; i < channel.water_blocks.size(); ++i) {
        const WaterBlock& block = channel.water_blocks[i];
        const std::string name = " of /channel/water_blocks/" + std::to_string(i);
        check(block.x.length(), "the length" + name);
        check(block.z.length(), "the width" + name);
        check(block.depth, "the depth" + name);
    }
}

void check_kernel(const Fluid& fluid, const std::string& source) {
    if (fluid.kernel == KernelKind::cubic_spline || fluid.support_in_spacings == 2) return;
    refuse(source, "/fluid/support_in_spacings",
           short_number(fluid.support_in_spacings) + " is for the kernel \"cubic_spline\", and /fluid/kernel is \"" +
               name_of(fluid.kernel) + "\", which reaches " + short_number(support_in_spacings_of(fluid)) +
               " d; allowed: 2.");
}

// A particle's neighbours reach over the support radius, in cells of that size; with fewer than three cells along a
// periodic axis a particle would meet a neighbour twice, or itself.
void check_periodic(const Scene& scene, const std::string& source) {
    const double shortest = 3 * support_radius_of(scene.fluid);
    const auto check = [&](double length, const std::string& pointer, const std::string& what) {
        if (length >= shortest * (1 - rounding_tolerance)) return;
        refuse(source, pointer,
               what + " " + short_number(length) + " m, so that a particle would meet itself across the joint; " +
                   "allowed: >= " + short_number(shortest / scene.fluid->particle_spacing) +
                   " fluid.particle_spacing_m = " + short_number(shortest) + " m.");
    };
    const Channel& channel = scene.channel;
    if (channel.flow == Flow::recirculating)
        check(channel.x.length(), "/channel/x_max_m", "the recirculating channel's length is");
    if (channel.flow == Flow::periodic)
        check(channel.x.length(), "/channel/x_max_m", "the periodic channel's length is");
    if (channel.sides == Sides::periodic)
        check(channel.z.length(), "/channel/z_max_m", "the width between periodic sides is");
    if (channel.top == Top::periodic)
        check(channel.height, "/channel/height_m", "the height between bottom and top, which are periodic, is");
}

// A particle sees itself and others mirrored at both walls. With images of these images left out, walls nearer than the
// support radius less a spacing would leave gaps behind them: on a lattice 1 d wide and Wendland's 3 d the density is 3 %
// short. The cubic spline's 2 d is met by the rule that a channel is no narrower than d.
void check_walls_apart(const Scene& scene, const std::string& source) {
    const double d = scene.fluid->particle_spacing;
    const double nearest = support_radius_of(scene.fluid) - d;
    const std::string narrower = scene.fluid->kernel == KernelKind::cubic_spline ? "/fluid/support_in_spacings 2"
                                                                                 : "the kernel \"cubic_spline\"";
    const auto check = [&](double gap, const std::string& pointer, const std::string& what) {
        if (gap >= nearest * (1 - rounding_tolerance)) return;
        refuse(source, pointer,
               what + " " + short_number(gap) + " m apart, nearer than the kernel's support of " +
                   short_number(support_radius_of(scene.fluid)) +
                   " m allows; allowed: >= " + short_number(nearest / d) +
                   " fluid.particle_spacing_m = " + short_number(nearest) + " m, or " + narrower + ".");
    };
    const Channel& channel = scene.channel;
    if (channel.flow == Flow::closed) check(channel.x.length(), "/channel/x_max_m", "the end walls are");
    if (channel.sides == Sides::walls) check(channel.z.length(), "/channel/z_max_m", "the banks are");
    if (channel.top != Top::wall) return;
    double highest_bed = 0;
    for (const BedPoint& point : channel.bed_points) highest_bed = std::max(highest_bed, point.y);
    check(channel.height - highest_bed, "/channel/height_m", "bed and lid are");
}

// A given stream meets nothing, has no end walls, and nothing changes it.
void check_kinematic(const Scene& scene, const std::string& source) {
    if (scene.fluid->model != ModelKind::kinematic) return;
    const Channel& channel = scene.channel;
    if (channel.flow == Flow::closed || channel.flow == Flow::periodic) {
        refuse(source, "/fluid/model",
               "\"kinematic\" is a stream of given velocity, and /channel/flow is \"" + name_of(channel.flow) +
                   "\"; allowed: \"emitter\" and \"recirculating\".");
    }
    if (!scene.obstacles.empty()) {
        refuse(source, "/fluid/model",
               "\"kinematic\" does not flow round obstacles, and /obstacles holds " +
                   std::to_string(scene.obstacles.size()) +
                   "; allowed: a model that solves for the water, such as "
                   "\"dfsph\".");
    }
    const auto refuse_key = [&](bool is_set, const std::string& key) {
        if (!is_set) return;
        refuse(source, "/fluid/model",
               "\"kinematic\" solves nothing, so /channel/" + key +
                   " would have no effect; allowed: a model that solves for the water, such as \"dfsph\", or a scene "
                   "without " +
                   key + ".");
    };
    refuse_key(channel.top != Top::open, "top");
    refuse_key(!channel.bed_points.empty(), "bed_points");
    refuse_key(channel.slope != 0, "slope");
    refuse_key(channel.manning_n != 0, "manning_n");
    refuse_key(!channel.no_slip.empty(), "no_slip");
    refuse_key(!channel.velocity_history.empty(), "velocity_history");
}

// The demand belongs to the choice of the model, and the choice needs it.
void check_model_choice(const Fluid& fluid, const std::string& source) {
    const bool chosen = fluid.model == ModelKind::automatic;
    if (chosen == (fluid.max_impulse_error > 0)) return;
    refuse(source, "/fluid/max_impulse_error",
           chosen ? "0: the model \"auto\" is chosen by the error that is allowed; allowed: > 0 and <= 1."
                  : short_number(fluid.max_impulse_error) +
                        " has no effect, as /fluid/model names the model; allowed: 0, or the model \"auto\".");
}

void check_limits(const PressureSolve& solve, const std::string& source, const std::string& pointer) {
    if (solve.max_iterations == 0 || solve.min_iterations <= solve.max_iterations) return;
    refuse(source, pointer + "/min_iterations",
           std::to_string(solve.min_iterations) + " is more than max_iterations = " +
               std::to_string(solve.max_iterations) + "; allowed: <= " + std::to_string(solve.max_iterations) + ".");
}

void check_capacity(const Scene& scene, const std::string& source) {
    const std::uint64_t needed = particles_needed(scene);
    if (static_cast<std::uint64_t>(scene.fluid->max_particles) < needed) {
        refuse(source, "/fluid/max_particles",
               std::to_string(scene.fluid->max_particles) +
                   " particles are too few for the water of this scene at a spacing of " +
                   short_number(scene.fluid->particle_spacing) + " m; allowed: >= " + std::to_string(needed) + ".");
    }
}

[[noreturn]] void refuse_gaps(const std::string& file, const std::string& source) {
    refuse(source, "/site/ground/file",
           file +
               ": some of its cells have no height (no data), and particles need ground all over; allowed with "
               "/fluid/model \"dfsph\": none without. Remedy: wade site import with --crop or --fill, or the model "
               "\"shallow_water\", to which they are a wall.");
}

// On a site: what shallow water can and particles cannot.
void check_particles_on_site(const Scene& scene, const std::string& source, Problems& problems) {
    const Site& site = *scene.site;
    problems.attempt([&] {
        if (site.rain.empty()) return;
        refuse(source, "/site/rain",
               "particles are too large for drops; allowed with /fluid/model \"dfsph\": no rain. Remedy: the model "
               "\"shallow_water\".");
    });
    for (const Barrier& barrier : site.barriers) {
        problems.attempt([&] {
            if (!std::isfinite(barrier.crest)) return;
            refuse(source, barrier.label,
                   "particles are larger than a flood wall is thick; allowed with /fluid/model \"dfsph\": no walls. "
                   "Remedy: a house along the line, over which no water runs, or the model \"shallow_water\".");
        });
    }
    for (const Outlet& outlet : site.outlets) {
        problems.attempt([&] {
            if (outlet.kind == OutletKind::free) return;
            refuse(source, outlet.label + "/kind",
                   "\"" + name_of(outlet.kind) +
                       "\": particles only leave; allowed with /fluid/model \"dfsph\": \"free\". Remedy: the model "
                       "\"shallow_water\".");
        });
    }
    problems.attempt([&] {
        const Raster* const raster = site.ground.raster.get();
        for (std::size_t k = 0; raster && k < raster->values.size(); ++k) {
            const std::size_t column = k % raster->columns, row = k / raster->columns;
            const double x = raster->x + (static_cast<double>(column) + 0.5) * raster->cell;
            const double z = raster->z + (static_cast<double>(row) + 0.5) * raster->cell;
            const bool in_world = 0 <= x && x <= scene.world->length && 0 <= z && z <= scene.world->width;
            if (in_world && std::isnan(raster->values[k])) refuse_gaps(site.ground.file, source);
        }
    });
}

// Water that people push has to know what momentum is. Of the model "auto" a candidate that does not is refused in its turn.
void check_two_way(const Scene& scene, const std::string& source) {
    const ModelKind model = scene.fluid->model;
    if (!scene.coupling->two_way || model == ModelKind::dfsph || model == ModelKind::shallow_water ||
        model == ModelKind::mixed || model == ModelKind::automatic) {
        return;
    }
    refuse(source, "/coupling/two_way",
           "the water of /fluid/model \"" + name_of(model) +
               "\" cannot be pushed; allowed with true: \"dfsph\", \"shallow_water\", \"mixed\", \"auto\".");
}

}  // namespace

void check_water(const Scene& scene, const std::string& source, Problems& problems) {
    const Fluid& fluid = scene.fluid;
    problems.attempt([&] { check_start(scene.channel, source); });
    problems.attempt([&] { check_flow(scene.channel, source); });
    problems.attempt([&] { check_model_choice(fluid, source); });
    problems.attempt([&] { check_kinematic(scene, source); });
    problems.attempt([&] { check_shallow_water(scene, source); });
    problems.attempt([&] { check_mixed(scene, source); });
    problems.attempt([&] { check_steering(scene, source); });
    problems.attempt([&] { check_two_way(scene, source); });
    problems.attempt([&] { check_limits(fluid.density_solve, source, "/fluid/density_solve"); });
    problems.attempt([&] { check_limits(fluid.divergence_solve, source, "/fluid/divergence_solve"); });
    const bool particles_on_site = scene.site && fluid.model == ModelKind::dfsph;
    if (particles_on_site) check_particles_on_site(scene, source, problems);
    if (!particles_on_site && !carries_water(scene.channel)) return;
    if (fluid.model == ModelKind::shallow_water) return;
    if (fluid.model != ModelKind::automatic) {  // which chooses a spacing that fits
        if (!problems.attempt([&] { check_spacing(scene, source); })) return;
        problems.attempt([&] { check_kernel(fluid, source); });
        problems.attempt([&] { check_periodic(scene, source); });
        problems.attempt([&] { check_walls_apart(scene, source); });
    }
    problems.attempt([&] { check_capacity(scene, source); });
}

}  // namespace wade
