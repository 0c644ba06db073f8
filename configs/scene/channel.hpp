#pragma once
// The channel of a scene: where the water flows, what drives it, what it starts with.

#include <array>
#include <vector>

#include "configs/scene/interval.hpp"

namespace wade {

enum class Flow {
    emitter,        // an emitter at x.hi feeds the channel, particles that pass x.lo return to its stock
    recirculating,  // periodic along x, the bulk speed held at `velocity`
    periodic,       // periodic along x, driven by slope and held up by friction
    closed          // walls at both ends
};
enum class Sides { walls, periodic };
enum class Top { open, wall, periodic };
enum class InitialRiver { dry, filled };

// A block of water at t = 0.
struct WaterBlock {
    Interval x, z;
    double depth = 0;
    double y_min = 0;  // 0: stands on the bed
    std::array<double, 3> velocity{};
};

// A point of the bed's height along x.
struct BedPoint {
    double x = 0;
    double y = 0;
};

enum class Plane { bed, top, x_min, x_max, z_min, z_max, obstacles };

// A no-slip boundary: viscous water has the plane's velocity there.
struct NoSlip {
    Plane plane = Plane::bed;
    std::array<double, 3> velocity{};
};

// A point of v_F in time.
struct VelocityPoint {
    double time = 0;
    double velocity = 0;
};

// The channel that confines the water: bed y = 0 unless bed_points raise it, banks at z.lo and z.hi.
struct Channel {
    Interval x, z;
    Flow flow = Flow::emitter;
    Sides sides = Sides::walls;
    Top top = Top::open;
    double height = 1;                 // y of the top, unless it is open
    std::vector<BedPoint> bed_points;  // ascending x
    double slope = 0;                  // fall of the bed towards -x
    double manning_n = 0;              // of the bed, s/m^(1/3)
    std::vector<NoSlip> no_slip;
    double depth = 1;                             // depth of the emitter's opening and of a filled river
    double velocity = 0;                          // v_F of the paper: emitter velocity or bulk speed, along -x
    std::vector<VelocityPoint> velocity_history;  // v_F in time; empty: `velocity` throughout
    InitialRiver initial_river = InitialRiver::dry;
    std::vector<WaterBlock> water_blocks;
};

}  // namespace wade
