#pragma once
// Dam breaks in shallow water without friction. s: distance downstream of the dam, m; t: time since the break, s, above 0.

#include <functional>
#include <vector>

namespace wade::validation {

struct FlowState {
    double depth = 0;     // m
    double velocity = 0;  // m/s, downstream
};

// Dry bed, Ritter (1892), Zeitschrift des VDI 36: with c = sqrt(g H) and -c t < s < 2 c t,
//   h = (2 c - s/t)^2 / (9 g),  u = 2/3 (c + s/t).
FlowState ritter(double s, double t, double reservoir_depth, double g);

// Wet bed, Stoker (1957), Water Waves, section 10.8: rarefaction wave, a stretch of uniform flow, shock.
struct WetDamBreak {
    double h_left = 0, h_right = 0, g = 0;
    double h_middle = 0;     // m
    double u_middle = 0;     // m/s
    double shock_speed = 0;  // m/s
};

// Solves 2 (sqrt(g h_l) - sqrt(g h)) = (h - h_r) sqrt(g/2 (1/h + 1/h_r)) for the depth h between wave and shock by
// Newton's method. h_left > h_right > 0.
WetDamBreak solve_wet_dam_break(double h_left, double h_right, double g);

FlowState stoker(const WetDamBreak& dam, double s, double t);

// Waves over a level bed by Serre's equations (F. Serre, La Houille Blanche 8 (1953)): shallow water with the vertical
// acceleration of the water in it, so that waves disperse. They hold for waves that do not break. A bore that rises by less
// than 0.28 of the depth before it is a train of such waves, an undular bore; up to 0.75 its first crests break (Favre
// 1935, after D. H. Peregrine, J. Fluid Mech. 25 (1966), 321-330).
//
//   h_t + (h u)_x = 0
//   m_t + (u m + g h^2 / 2 - 2/3 h^3 u_x^2)_x = 0,   m = h u - (h^3 u_x / 3)_x

// Water between two walls, one entry a cell of length dx.
struct SerreWaves {
    double dx = 0;                 // m
    double g = 0;                  // m/s^2
    std::vector<double> depth;     // h, m
    std::vector<double> momentum;  // m, m^2/s
};

// Water of depth(x) and velocity(x) between walls at 0 and `length`; both must be smooth over a few cells.
SerreWaves serre_waves(double length, double dx, double g, const std::function<double(double x)>& depth,
                       const std::function<double(double x)>& velocity);

// Velocity of each cell, m/s.
std::vector<double> velocities(const SerreWaves& waves);

// Advances by `duration` seconds: differences of fourth order and Runge and Kutta's method, second order in the velocity.
void advance(SerreWaves& waves, double duration);

}  // namespace wade::validation
