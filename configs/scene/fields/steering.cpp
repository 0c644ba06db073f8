// Keys of the steering model of the water.

#include "configs/scene/steering.hpp"

#include "configs/scene/fields/lists.hpp"

namespace wade {

namespace {

void angle_field(Fields& f, FlockBehaviour& behaviour) {
    f.number("angle_deg", behaviour.angle, "deg", from(0).to(180),
             "Only neighbours in a direction within this angle of the velocity; 180 is all round. Less is not "
             "reciprocal and gives water a momentum of its own.");
}

}  // namespace

void fields(SteeringClass& kind, Fields& f) {
    f.number("share", kind.share, "fraction", from(0).to(1), "Of all particles.", required);
    f.number("radius", kind.radius, "", from(0.5).to(2),
             "Radius of separation over that of the others; a pair takes the mean.");
    f.number("mass", kind.mass, "", from(0.1).to(10), "Mass over that of the others.");
}

void fields(SteeringBody& body, Fields& f) {
    f.number("x_m", body.place[0], "m", from(0).to(1e5), "Its centre when it appears.", required);
    f.number("y_m", body.place[1], "m", from(0).to(10000), "Its height.", required);
    f.number("z_m", body.place[2], "m", from(0).to(1e5), "Across.", required);
    velocity_fields(f, body.velocity, 1000, "Its velocity along x.");
    f.number("time_s", body.time, "s", from(0).to(1e6), "When it appears.");
    f.number("radius_m", body.radius, "m", above(0).to(1000), "Of the sphere.", required);
    f.number("density_kg_m3", body.density, "kg/m3", above(0).to(1e5), "Its mass over its volume.");
}

void fields(Steering& s, Fields& f) {
    f.object(
        "separation",
        [&] {
            f.number("radius", s.separation.radius, "d", above(0).to(3),
                     "Within it particles push; sets the spacing at rest and so the density.");
            angle_field(f, s.separation);
            f.number("weight", s.separation.weight, "U2/d", from(0).to(1000),
                     "Stiffness: larger is less compressible and takes shorter steps, dt <= cfl * d / (largest speed + "
                     "2.25 sqrt(weight) U).");
        },
        "Neighbours push each other apart: weight * ((radius / r)^2 - 1) within the radius.");
    f.object(
        "alignment",
        [&] {
            f.number("radius", s.alignment.radius, "d", above(0).to(3), "Of the neighbourhood.");
            angle_field(f, s.alignment);
            f.number("weight", s.alignment.weight, "U/d", from(0).to(1000),
                     "Rate with which the velocity becomes the mean of the neighbours'.");
        },
        "Particles take on the mean velocity of their neighbours. Off by default, as it stops what is no common "
        "motion.");
    f.object(
        "cohesion",
        [&] {
            f.number("radius", s.cohesion.radius, "d", above(0).to(3), "Of the neighbourhood, the outer radius.");
            angle_field(f, s.cohesion);
            f.number("weight", s.cohesion.weight, "U2/d", from(0).to(1000),
                     "Pull of a neighbour. Off by default: up to about 0.01 it changes little, and with it "
                     "neighbourhoods reach further and steps take twice the time.");
            f.choice("form", s.cohesion_form,
                     "equal: each neighbour pulls with the weight. growing: with weight * (r / radius)^2.");
        },
        "Neighbours attract each other.");
    f.flag("only_where_needed", s.only_where_needed,
           "Neighbours that push each other apart do not pull at the same time.");
    f.object(
        "loss",
        [&] {
            f.number("radius", s.loss_radius, "d", above(0).to(3), "Within it neighbours take speed.");
            f.number("weight", s.loss, "U/d", from(0).to(10),
                     "Rate of the loss; acts as viscosity and brings the water to rest.");
            f.choice("form", s.loss_form,
                     "relative: of the velocity relative to the neighbour, so that a stream goes on. absolute: of the "
                     "velocity itself.");
        },
        "Loss of speed near other particles: weight * (1 - r / radius) of each within the radius.");
    f.object(
        "walls",
        [&] {
            f.choice(
                "rule", s.walls,
                "force: walls push like a neighbour, weight * ((radius / distance)^2 - 1). constraint: no particle "
                "gets nearer than 0.4 d. both: the two together. With force alone a particle that got behind a "
                "wall is set back.");
            f.number("radius", s.wall_radius, "d", above(0).to(3), "Distance within which walls push and take speed.");
            f.number("weight", s.wall_weight, "U2/d", from(0).to(1000), "Of the push.");
            f.number("loss", s.wall_loss, "U/d", from(0).to(10),
                     "Rate with which velocity is lost at a wall, at distance 0; falls to 0 at the radius. Friction of "
                     "walls.");
        },
        "Bed, banks, ends, lid and obstacles.");
    f.number("max_force", s.max_force, "U2/d", above(0).to(1e5),
             "Largest steering force of a particle of mass 1, weight apart.");
    f.number("max_speed", s.max_speed, "U", above(0).to(1000), "Largest speed of a particle.");
    f.list("classes", s.classes,
           "Particles that differ from the others, mixed evenly among them: liquids of other densities.");
    f.list("bodies", s.bodies, "Spheres that fall into the water, push it aside and are carried by it.");
}

}  // namespace wade
