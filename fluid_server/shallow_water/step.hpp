#pragma once
// The shallow-water equations: hydrostatic pressure and one velocity over the whole depth
//
//   dh/dt     + d(h u)/dx                + d(h v)/dz                = 0
//   d(h u)/dt + d(h u^2 + g h^2/2)/dx    + d(h u v)/dz              = -g h db/dx + h a - k h u
//   d(h v)/dt + d(h u v)/dx              + d(h v^2 + g h^2/2)/dz    = -g h db/dz       - k h v
//
// h: depth, m; u, v: depth-averaged velocity along x and across, m/s; b: height of the bed; a: acceleration along x by the
// slope of the channel; k = g n^2 sqrt(u^2 + v^2) / h^(4/3): Manning's friction, of a film that of 1 mm at least.
//
// Finite volumes, second order in space (face_flux.hpp) and time (row_update.hpp), with the friction of the old state taken
// implicitly, so that it stops water at most. Depths stay positive as long as
// dt (s_x / dx + s_z / dz) <= 1/2, s the fastest wave along each axis; a step after which one is negative is taken anew
// with half of dt, as waves may speed up within it. A recirculating channel gets, after each step, the velocity along x
// that all of it lacks to v_F. On a site (site_water.hpp) what came in and left meanwhile follows after each step; its
// walls cut cells (openings.hpp), and only cells at the water are worked on (wet_lines.hpp).

#include <array>
#include <optional>
#include <string_view>

#include "fluid_server/people/pushes.hpp"
#include "fluid_server/shallow_water/world.hpp"
#include "fluid_server/stage_clock.hpp"

namespace wade::fluid::shallow_water {

enum class Stage : std::size_t {
    time_step,  // the longest that is stable
    update,     // of all cells; taken anew with half the time where a depth became negative
    flow,       // what passed the watched faces
    people,     // take their impulses
    site,       // gets and loses water, and finds its wet cells
    drive       // of a recirculating channel
};
inline constexpr std::array<std::string_view, 6> stage_names{"time_step", "update", "flow", "people", "site", "drive"};
using StepStages = StageClock<Stage, stage_names.size()>;

struct StepReport {
    double dt = 0;                    // s
    double driving_acceleration = 0;  // of a recirculating channel, m/s2 towards -x, as a mean over the step
    double inflow = 0, outflow = 0;   // volume that came in at x.hi and left at x.lo, or of a site anywhere, m^3
    StepStages::Seconds stages{};     // wall time, s
};

// Advances by the longest time step that is stable, at most `remaining` and a whole part of it. Throws RunError
// (numerical_failure) if the water is not finite. people: take their share of the frame, if they are given. driven_by: the
// driving acceleration of a recirculating channel, towards -x, m/s2; none: what all of it lacks to v_F.
StepReport step(ShallowWater& world, double remaining, PeopleInWater* people = nullptr,
                std::optional<double> driven_by = {});

}  // namespace wade::fluid::shallow_water
