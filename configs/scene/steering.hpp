#pragma once
// Settings of the steering model of the water.

#include <array>
#include <vector>

namespace wade {

// One behaviour of a flock: its neighbourhood and its strength.
struct FlockBehaviour {
    double radius = 0;   // of the neighbourhood, in spacings d
    double angle = 180;  // between the velocity and the direction to a neighbour, degrees; 180: all round
    double weight = 0;   // see the key for the unit
};

enum class CohesionForm { equal, growing };  // each neighbour pulls alike, or with the square of its distance
enum class LossForm { relative, absolute };
enum class SteeringWalls { force, constraint, both };

// Particles that differ from the others: a liquid of a density of its own.
struct SteeringClass {
    double share = 0;   // fraction of all particles
    double radius = 1;  // of separation, over that of the others
    double mass = 1;    // over that of the others
};

// A sphere that falls into the water.
struct SteeringBody {
    std::array<double, 3> place{};  // of its centre at `time`, m
    std::array<double, 3> velocity{};
    double time = 0;  // when it appears, s
    double radius = 0.1;
    double density = 1000;
};

// The steering model: each particle is a vehicle of Reynolds that steers by its neighbours.
struct Steering {
    FlockBehaviour separation{1.12, 180, 4}, alignment{2, 180, 0}, cohesion{2, 180, 0};
    CohesionForm cohesion_form = CohesionForm::equal;
    bool only_where_needed = true;
    double loss = 0.1;         // near neighbours
    double loss_radius = 1.5;  // in spacings
    LossForm loss_form = LossForm::relative;
    SteeringWalls walls = SteeringWalls::both;
    double wall_radius = 0.6;  // in spacings
    double wall_weight = 4;
    double wall_loss = 0.02;
    double max_force = 20;
    double max_speed = 4;
    std::vector<SteeringClass> classes;
    std::vector<SteeringBody> bodies;
};

}  // namespace wade
