// Keys of the channel and of the water that is in it at the start.

#include "configs/scene/channel.hpp"

#include "configs/scene/fields/lists.hpp"

namespace wade {

void fields(BedPoint& point, Fields& f) {
    f.number("x_m", point.x, "m", from(0).to(1e5), "Place, larger than that of the point before.", required);
    f.number("y_m", point.y, "m", from(0).to(1000), "Height of the bed.", required);
}

void fields(NoSlip& wall, Fields& f) {
    f.choice("plane", wall.plane, "Which one; obstacles: all faces of all of them.", required);
    velocity_fields(f, wall.velocity, 100, "Velocity of the plane along x; that across the plane must be 0.");
}

void fields(VelocityPoint& point, Fields& f) {
    f.number("time_s", point.time, "s", from(0).to(1e6),
             "Time, not smaller than that of the point before; two points of one time make a jump.", required);
    f.number("velocity_m_s", point.velocity, "m/s", from(0).to(1000), "v_F at this time.", required);
}

void fields(WaterBlock& block, Fields& f) {
    box_fields(f, block.x, block.z);
    f.number("depth_m", block.depth, "m", above(0).to(10000), "Height of the block.", required);
    f.number("y_min_m", block.y_min, "m", from(0).to(10000),
             "Height of its underside; 0 stands on the bed, also where bed_points raise it.");
    velocity_fields(f, block.velocity, 1000, "Its velocity along x.");
}

void fields(Channel& channel, Fields& f) {
    f.number("x_min_m", channel.x.lo, "m", from(0).to(1e5), "Downstream end.", required);
    f.number("x_max_m", channel.x.hi, "m", from(0).to(1e5), "Upstream end.", required);
    f.number("z_min_m", channel.z.lo, "m", from(0).to(1e5), "One bank.", required);
    f.number("z_max_m", channel.z.hi, "m", from(0).to(1e5), "The other bank.", required);
    f.choice(
        "flow", channel.flow,
        "emitter: an opening over the whole width at x_max_m feeds the channel at velocity_m_s, and what passes "
        "x_min_m returns to its stock. recirculating: periodic along x, the bulk speed is held at velocity_m_s. "
        "periodic: periodic along x, and nothing holds the speed: it starts at velocity_m_s, then slope and "
        "friction decide. closed: walls at both ends, for people too unless their goal lies beyond; no people fall "
        "at x = 0.",
        required);
    f.choice("sides", channel.sides, "What z_min_m and z_max_m are: banks, or one and the same place.");
    f.choice("top", channel.top,
             "open: air above the water. wall: a lid at height_m, for flows that fill the channel. periodic: height_m "
             "is the same place as y = 0, and there is no bed.");
    f.acts_only({"with /channel/top \"wall\" or \"periodic\"", [&](const Scene&) { return channel.top != Top::open; }},
                [&] { f.number("height_m", channel.height, "m", above(0).to(10000), "y of the top."); });
    f.list("bed_points", channel.bed_points,
           "Height of the bed along x, straight between these points and level beyond them; none: y = 0. Depths and "
           "heights elsewhere in a scene are counted from y = 0. The crowd walks as on level ground.");
    f.number(
        "slope", channel.slope, "", from(0).to(1),
        "Fall of the bed towards -x, metres a metre: gravity is tilted by atan(slope), the axes stay along the bed.");
    f.number("manning_n", channel.manning_n, "s/m^(1/3)", from(0).to(1),
             "Manning's coefficient of the bed's friction: each column of water is held up by g n^2 |U| U / h^(4/3), U "
             "its mean velocity and h its depth. Concrete 0.013, gravel 0.03, brushwood 0.1; 0 is a smooth bed.");
    f.list("no_slip", channel.no_slip,
           "Planes at which viscous water takes the plane's velocity; at all others it slips freely.");
    f.number("depth_m", channel.depth, "m", above(0).to(10000),
             "Height of the emitter's opening and depth of a filled river.");
    f.number("velocity_m_s", channel.velocity, "m/s", from(0).to(1000),
             "v_F: speed in the emitter's opening or bulk speed of a recirculating channel, along -x; speed at t = 0 "
             "of a periodic one.");
    f.list("velocity_history", channel.velocity_history,
           "v_F in time, for an emitter or a recirculating channel: straight between these points, constant before the "
           "first and after the last; none: velocity_m_s throughout. A flood that rises, an inflow that stops.");
    f.choice("initial_river", channel.initial_river,
             "State at t = 0: an empty bed, or the whole channel filled up to y = depth_m and moving at velocity_m_s. "
             "A recirculating channel must be filled; a periodic one is filled or starts with its water_blocks, a "
             "closed one with these.");
    f.list("water_blocks", channel.water_blocks, "Blocks of water at t = 0, in a closed or a periodic channel only.");
}

}  // namespace wade
