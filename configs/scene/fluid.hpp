#pragma once
// Settings of the water: the model and how it is solved.

#include <optional>

#include "configs/scene/steering.hpp"

namespace wade {

enum class ModelKind {
    dfsph,
    kinematic,
    shallow_water,
    steering,
    mixed,
    automatic  // one of the others, by max_impulse_error
};

enum class VelocityProfile { uniform, logarithmic };
enum class Arrangement { random, lattice };

// The kinematic model: nothing is solved, depth and velocity are given.
struct Kinematic {
    VelocityProfile profile = VelocityProfile::uniform;
    double roughness_length = 0.005;  // z_0 of the logarithmic profile
    double transport_factor = 1;      // particles and front move at this factor times their velocity
    Arrangement arrangement = Arrangement::random;
    double jitter = 0;  // of a lattice: width of the deviation from its points, in cells, [0, 1]
};

// The shallow-water model: depth and depth-averaged velocity on a grid.
struct ShallowWaterGrid {
    double cell_size = 0.5;  // m
};

// The hybrid model (`mixed`): particles in a region of the channel, shallow water elsewhere.
struct MixedWindow {
    std::optional<double> x_min, x_max;  // m, where there are particles all the time
    std::optional<double> margin;        // m, round agents and obstacles; 3 depths of the water if not given
    double chunk = 4;                    // m, length of one move of the region
    bool obstacles = false;              // whether there are particles round them all the time
};

enum class KernelKind {
    cubic_spline,
    quartic_spline,
    wendland_c2,
    automatic  // one of the others, see kernel_choice.hpp; no loaded scene has it
};

struct PressureSolve {
    double tolerance = 0;  // mean error that ends the iteration; the key says relative to what
    int min_iterations = 0;
    int max_iterations = 0;
};

enum class Publish { all, near_agents };  // which columns of shallow water a frame holds

struct Fluid {
    ModelKind model = ModelKind::dfsph;
    double max_impulse_error = 0;  // of `automatic`, relative; else 0
    Kinematic kinematic;
    ShallowWaterGrid shallow_water;
    MixedWindow mixed;
    Steering steering;
    double particle_spacing = 0.4642;  // d; particle mass = rest_density * d^3
    KernelKind kernel = KernelKind::cubic_spline;
    double support_in_spacings = 2;  // of the cubic spline: h / d
    double rest_density = 1000;
    double kinematic_viscosity = 0.01;
    int max_particles = 100000;
    Publish publish = Publish::all;
    double cfl = 0.5;  // time step <= cfl * d / (largest speed + sqrt(g * depth))
    PressureSolve density_solve{5e-4, 2, 100};
    PressureSolve divergence_solve{1e-3, 1, 100};  // max_iterations = 0 switches it off
};

}  // namespace wade
