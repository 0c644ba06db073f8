#pragma once
// Dam breaks in shallow water without friction. s: distance downstream of the dam, m; t: time since the break, s, above 0.

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

}  // namespace wade::validation
