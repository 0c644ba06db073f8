// Keys of the water and of how it is solved.

#include "configs/scene/fluid.hpp"

#include <algorithm>
#include <initializer_list>

#include "configs/scene/fields/lists.hpp"

namespace wade {

namespace {

// Keys of the water act with some models. The model auto may become any model but mixed.
Acting with_models(std::string_view words, std::initializer_list<ModelKind> models) {
    return {words, [models = std::vector<ModelKind>(models)](const Scene& scene) {
                return std::find(models.begin(), models.end(), scene.fluid->model) != models.end();
            }};
}

}  // namespace

void fields(Kinematic& kinematic, Fields& f) {
    f.choice("profile", kinematic.profile,
             "Velocity over the height. uniform: velocity_m_s everywhere. logarithmic: as over a rough bed, with "
             "velocity_m_s as its mean over the depth.");
    f.acts_only({"with /fluid/kinematic/profile \"logarithmic\"",
                 [&](const Scene&) { return kinematic.profile == VelocityProfile::logarithmic; }},
                [&] {
                    f.number("roughness_length_m", kinematic.roughness_length, "m", above(0).to(1),
                             "z_0 of the logarithmic profile u(y) ~ ln(1 + y / z_0): a thirtieth of the height of the "
                             "bed's grains.");
                });
    f.number("transport_factor", kinematic.transport_factor, "", above(0).to(100),
             "Particles and front move at this factor times their velocity. 2.6 stands for what the paper's authors "
             "logged: a front that runs ahead of the velocity with which it pushes.");
    f.choice("arrangement", kinematic.arrangement,
             "Where the particles of a layer are. random: each anywhere in its cell, like molecules of a gas. lattice: "
             "rows that keep their distances, as the pressure of a solver makes them, every other layer half a cell "
             "further along and across.");
    f.acts_only({"with /fluid/kinematic/arrangement \"lattice\"",
                 [&](const Scene&) { return kinematic.arrangement == Arrangement::lattice; }},
                [&] {
                    f.number("jitter", kinematic.jitter, "cells", from(0).to(1),
                             "Width within which each particle of a lattice deviates from its point along and across, "
                             "uniformly, without leaving its cell. The mass in contact with an agent scatters over its "
                             "mean as in the solved water of S5 of configs/paper with about 0.6, as in that of "
                             "configs/river with at most 0.3. 1 is as disordered as random.");
                });
}

void fields(ShallowWaterGrid& grid, Fields& f) {
    f.number("cell_size_m", grid.cell_size, "m", from(0.001).to(1000),
             "Cells of the grid are as near to squares of this size as channel length and width allow. A cell with "
             "its centre in an obstacle belongs to it, so whole cells in obstacles are best. Half of it means four "
             "times the cells and twice the steps.");
}

void fields(MixedWindow& mixed, Fields& f) {
    f.number("x_min_m", mixed.x_min, "m", from(-1000000).to(1e6),
             "With x_max_m: where there are particles all the time, rounded outwards to whole cells.",
             otherwise("none"));
    f.number("x_max_m", mixed.x_max, "m", from(-1000000).to(1e6), "See x_min_m.", otherwise("none"));
    f.number("margin_m", mixed.margin, "m", from(0).to(1000),
             "How far the window reaches beyond people and obstacles, along the channel; people no further than that "
             "from a bank count as well.",
             otherwise("3 depths of the deepest water"));
    f.number("chunk_m", mixed.chunk, "m", above(0).to(1000),
             "The ends of a window that follows people move by whole multiples of this, rounded to whole cells; an end "
             "is drawn in once it is two of them too far out.");
    f.flag("obstacles", mixed.obstacles, "Whether the window spans all obstacles, with the margin.");
}

void fields(Fluid& fluid, Fields& f) {
    const Acting as_particles{
        "on a channel, or with another /fluid/model than \"shallow_water\"",
        [&](const Scene& scene) { return !scene.site || fluid.model != ModelKind::shallow_water; }};
    f.choice(
        "model", fluid.model,
        "dfsph: divergence-free smoothed particle hydrodynamics in 3-D (Bender and Koschier 2015). kinematic: a stream "
        "of given depth and velocity, nothing is solved; the cheapest water. shallow_water: depth and depth-averaged "
        "velocity on a grid, by the shallow-water equations (hydrostatic pressure); for streams wider and longer than "
        "deep. steering: particles that steer by their neighbours like a flock (Reynolds 1999, Vicentini 2009); cheap "
        "steps, not exact. mixed: dfsph in a window that follows people and obstacles, shallow_water elsewhere. auto: "
        "fluid_server takes the cheapest of those in its measured table (not mixed), with its resolution and "
        "tolerances, that is estimated to keep max_impulse_error; particle_spacing_m, cfl, kernel, tolerances and cell "
        "size of the scene are then only one proposal, and max_particles counts particles of the written spacing.");
    f.number(
        "max_impulse_error", fluid.max_impulse_error, "", from(0).to(1),
        "For the model auto: the demand on the impulse of the water on standing people, as the "
        "median over them of its relative error against a fine run of dfsph. 0: none, which all other models need. "
        "The default of auto is about what the default settings of dfsph miss in the lee of an obstacle, where they "
        "are "
        "worst.",
        preset_but("0.3 with the model auto",
                   [&] { return fluid.model == ModelKind::automatic ? KeyValue(0.3) : KeyValue(); }));
    f.acts_only(with_models("with the models kinematic and auto", {ModelKind::kinematic, ModelKind::automatic}), [&] {
        f.object("kinematic", fluid.kinematic, "The kinematic model: depth_m of water that has velocity_m_s.");
    });
    f.acts_only(
        with_models("with the models shallow_water, mixed and auto",
                    {ModelKind::shallow_water, ModelKind::mixed, ModelKind::automatic}),
        [&] {
            f.object(
                "shallow_water", fluid.shallow_water,
                "The shallow-water model. It needs open water (no lid, no planes without slip) that stands on the bed, "
                "and takes no notice of kernel, viscosity_m2_s and the two solves; its particles have about the mass "
                "of "
                "the other models'.");
        });
    f.choice(
        "publish", fluid.publish,
        "On a site, which columns of shallow_water a frame holds. all: each wet cell. near_agents: those within 10 m "
        "and more "
        "of a person outdoors, as /coupling/agents_stream says where they are; ways then know no other water, and maps "
        "of the crowd have no other.");
    f.acts_only(with_models("with the model mixed", {ModelKind::mixed}), [&] {
        f.object(
            "mixed", fluid.mixed,
            "The mixed model: particles (dfsph) in a window over the whole width of the channel, "
            "and shallow water elsewhere, on the grid of /fluid/shallow_water. The window spans people in the channel "
            "or near it, which needs /coupling/agents_stream, what x_min_m and x_max_m say, and obstacles if wanted. "
            "Where nothing needs it there are no particles.");
    });
    f.acts_only(with_models("with the models steering and auto", {ModelKind::steering, ModelKind::automatic}), [&] {
        f.object(
            "steering", fluid.steering,
            "The steering model. Lengths are in spacings d; forces in the unit U^2 / d per mass and rates in U / d, "
            "where U^2 = gravity * greatest depth + (largest velocity of the scene)^2: weights mean the same at any "
            "size.");
    });
    f.acts_only(as_particles, [&] {
        f.number("particle_spacing_m", fluid.particle_spacing, "m", from(0.0001).to(1000),
                 "d, spacing of the particles at rest; a particle's mass is rest_density_kg_m3 * d^3. Half of it means "
                 "about eight times the particles and twice the steps.");
    });
    f.acts_only(
        with_models("with the models dfsph, mixed and auto",
                    {ModelKind::dfsph, ModelKind::mixed, ModelKind::automatic}),
        [&] {
            f.choice(
                "kernel", fluid.kernel,
                "cubic_spline: support radius 2 d (support_in_spacings), 33 particles in it; the fastest, but a "
                "lattice of its "
                "particles resists shear as a soft solid, so that waves run 2 to 5 % too fast. quartic_spline: support "
                "radius "
                "2.4 d, 57 particles; hardly sees how particles are packed, so that waves have their speed, deep water "
                "shakes "
                "less and two layers of particles stand 2 % too low instead of 4; opposite walls must be 1.4 d apart. "
                "wendland_c2: "
                "support radius 3 d, 113 particles, for water that fills its channel; opposite walls must be 2 d "
                "apart. auto: "
                "what "
                "the scene needs, wendland_c2 for water that fills its channel, cubic_spline for a front, "
                "quartic_spline for "
                "rivers from the start, waves and water at rest.");
            f.number(
                "support_in_spacings", fluid.support_in_spacings, "", from(2).to(2.2),
                "Support radius of the kernel cubic_spline over d. A lattice of particles resists shear as a soft "
                "solid, so "
                "that waves run 2 to 5 % too fast at 2; from 2.05 on it does not. Water of two layers stands 4 % too "
                "low at 2, "
                "2.7 % at 2.1. It costs more: 2 to 33 % in single runs. Banks and walls must be this less 1 d apart.");
        });
    f.number("rest_density_kg_m3", fluid.rest_density, "kg/m3", above(0).to(1e5), "Density of the water at rest.");
    f.acts_only(
        with_models("with the models dfsph, mixed and auto",
                    {ModelKind::dfsph, ModelKind::mixed, ModelKind::automatic}),
        [&] {
            f.number(
                "viscosity_m2_s", fluid.kinematic_viscosity, "m2/s", from(0).to(1000),
                "Kinematic viscosity of the model; far above that of water (1e-6), as the particles do not resolve its "
                "small eddies.");
        });
    f.acts_only(as_particles, [&] {
        f.whole("max_particles", fluid.max_particles, "", from(0).to(1e8),
                "Capacity: particles for which memory is set aside, and the stock of the emitter.");
    });
    f.acts_only(with_models("with models that solve for the water, not with kinematic",
                            {ModelKind::dfsph, ModelKind::shallow_water, ModelKind::steering, ModelKind::mixed,
                             ModelKind::automatic}),
                [&] {
                    f.number("cfl", fluid.cfl, "", above(0).to(2),
                             "Time step limit: dt <= cfl * d / (largest particle speed + sqrt(g * depth)). Larger is "
                             "faster and less "
                             "exact; from 0.9 on it changes nothing: whatever it is, dt <= 0.5 d / sqrt(g * depth) and "
                             "dt <= 0.4 d / "
                             "largest speed, without which water becomes unstable.");
                });
    f.acts_only(
        with_models("with the models dfsph, mixed and auto",
                    {ModelKind::dfsph, ModelKind::mixed, ModelKind::automatic}),
        [&] {
            f.object(
                "density_solve",
                [&] {
                    f.number(
                        "tolerance", fluid.density_solve.tolerance, "fraction", above(0).to(0.1),
                        "Mean density error, relative to the rest density, that ends the iteration; in no block of 256 "
                        "particles, which lie close together, may it be more than five times as large.");
                    f.whole("min_iterations", fluid.density_solve.min_iterations, "", from(1).to(10000),
                            "Iterations done in any case.");
                    f.whole("max_iterations", fluid.density_solve.max_iterations, "", from(1).to(10000),
                            "Iterations after which the step goes on with the error that is left.");
                },
                "The constant-density solve: moves the particles until their density is that of rest, and leaves their "
                "velocities alone unless the divergence solve is off.");
            f.object(
                "divergence_solve",
                [&] {
                    f.number(
                        "tolerance", fluid.divergence_solve.tolerance, "fraction", above(0).to(0.1),
                        "Mean change of density, relative to the rest density, in a time step of CFL 0.5 that ends the "
                        "iteration; shorter steps and water deeper than ten layers of particles take a share of it. In "
                        "no "
                        "block of 256 particles, which lie close together, may it be more than five times as large. "
                        "Beyond 32 layers it counts as 0.002 at most.");
                    f.whole("min_iterations", fluid.divergence_solve.min_iterations, "", from(1).to(10000),
                            "Iterations done in any case, unless max_iterations = 0 switches the solve off.");
                    f.whole("max_iterations", fluid.divergence_solve.max_iterations, "", from(0).to(10000),
                            "Iterations after which the step goes on with the error that is left; 0 switches the solve "
                            "off, "
                            "and the density solve then changes velocities as well.");
                },
                "The divergence-free solve: its pressure carries the weight of the water and all other forces.");
        });
}

}  // namespace wade
