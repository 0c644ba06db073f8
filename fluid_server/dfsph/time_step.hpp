#pragma once
// How long a step of the solved water may be: W1 of docs/step_of_the_water.md.

#include "configs/scene/scene.hpp"

namespace wade::fluid {

// The CFL number of the step that the tolerance of the divergence solve is meant for.
inline constexpr double reference_cfl = 0.5;

// Limits of the displacement in a step at any CFL number, in spacings. Steps that let pressure move particles further
// than 0.6 d tear water of 60 layers apart (tests/stability, deep_column). A particle that moves 0.4 d at its current
// speed stays below d/2 even if it accelerates during the step.
inline constexpr double pressure_limit = 0.5;
inline constexpr double way_limit = 0.4;

// Beyond so many layers the limit of pressure shrinks with this power of their number, fitted: 200 layers stood at 0.5 d and were torn
// apart at 0.53 d, 400 stood at 0.43 d and were at 0.5 d.
inline constexpr double layers_of_pressure_limit = 100, power_of_pressure_limit = 0.3;

// Explicit viscosity is stable below dt = d^2 / (8 nu) (Morris et al. 1997).
inline constexpr double viscous_limit = 0.125;

// Water that falls H reaches 1.4 sqrt(g H), a jet between two fronts a few times that; what is faster by this factor has
// run away.
inline constexpr int runaway = 100;

struct WaterSpeeds {
    double fastest = 0;  // of what moves particles: of the fastest particle, plane or inflow, m/s
    double wave = 0;     // sqrt(g H) of the scene's depth, m/s: counts in the CFL number
    // sqrt(g H) of the current water depth (water_depth.hpp), m/s: the speed that pressure can give to particles. A
    // step that outruns it extrapolates the density too far and injects energy.
    double pressure = 0;
    double layers = 1;  // of particles in that water
};

struct TimeStep {
    double dt = 0;    // s
    float share = 1;  // of a step of reference_cfl, at most 1, see PressureSolver::solve_divergence
};

// The longest step that all limits allow, at most `remaining` s and a whole part of it.
[[nodiscard]] TimeStep longest_step(const Fluid& fluid, const WaterSpeeds& speeds, double remaining);

// Returns the largest speed of the no-slip walls, m/s.
[[nodiscard]] double fastest_plane(const Channel& channel);

}  // namespace wade::fluid
