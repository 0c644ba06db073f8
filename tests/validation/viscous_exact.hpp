#pragma once
// Exact laminar flows between planes and in a periodic square.

#include <array>
#include <limits>

namespace wade::validation {

// Start-up of plane Poiseuille flow (Morris, Fox and Zhu 1997, eq. 21): at rest at t = 0, then driven by a constant
// acceleration between two planes at rest at y = 0 and y = height.
//   u = F / (2 nu) y (L - y) - sum_{n odd} 4 F L^2 / (nu pi^3 n^3) sin(n pi y / L) exp(-n^2 pi^2 nu t / L^2)
// F: acceleration, m/s^2; nu: viscosity, m^2/s; L: height, m; steady flow has its peak F L^2 / (8 nu) in the middle.
double poiseuille_velocity(double y, double t, double acceleration, double viscosity, double height);

// Start-up of plane Couette flow (Morris, Fox and Zhu 1997, eq. 23): at rest at t = 0, then the plane at y = height
// moves at `speed` and the one at y = 0 rests.
//   u = U y / L + sum_{n > 0} 2 U / (n pi) (-1)^n sin(n pi y / L) exp(-n^2 pi^2 nu t / L^2)
double couette_velocity(double y, double t, double speed, double viscosity, double height);

// Returns the fraction of its first speed that the Taylor-Green vortex of a square of side `length` still has at time
// t: exp(-2 nu k^2 t) with k = 2 pi / L, for u = -U cos kx sin ky, v = U sin kx cos ky (Taylor and Green 1937, in the
// plane).
double taylor_green_decay(double t, double viscosity, double length);

// Steady flow in a square cavity with a lid that moves along +x: Ghia, Ghia and Shin, Journal of Computational Physics
// 48 (1982), 387-411, tables I and II, grid 129 x 129. Lengths over the side, velocities over the speed of the lid.

struct GhiaRow {
    double place = 0;                  // y of table I, x of table II
    std::array<double, 3> velocity{};  // at Re 100, 400, 1000; NaN: a misprint that is left out
};

inline constexpr std::array ghia_reynolds_numbers{100, 400, 1000};

// u on the vertical line through the centre.
inline constexpr std::array<GhiaRow, 17> ghia_u{{
    {1.0000, {1.00000, 1.00000, 1.00000}},
    {0.9766, {0.84123, 0.75837, 0.65928}},
    {0.9688, {0.78871, 0.68439, 0.57492}},
    {0.9609, {0.73722, 0.61756, 0.51117}},
    {0.9531, {0.68717, 0.55892, 0.46604}},
    {0.8516, {0.23151, 0.29093, 0.33304}},
    {0.7344, {0.00332, 0.16256, 0.18719}},
    {0.6172, {-0.13641, 0.02135, 0.05702}},
    {0.5000, {-0.20581, -0.11477, -0.06080}},
    {0.4531, {-0.21090, -0.17119, -0.10648}},
    {0.2813, {-0.15662, -0.32726, -0.27805}},
    {0.1719, {-0.10150, -0.24299, -0.38289}},
    {0.1016, {-0.06434, -0.14612, -0.29730}},
    {0.0703, {-0.04775, -0.10338, -0.22220}},
    {0.0625, {-0.04192, -0.09266, -0.20196}},
    {0.0547, {-0.03717, -0.08186, -0.18109}},
    {0.0000, {0.00000, 0.00000, 0.00000}},
}};

// v on the horizontal line through the centre. The value printed for Re 400 at 0.9063, -0.23827, is off its neighbours
// by 0.1 and is left out.
inline constexpr std::array<GhiaRow, 17> ghia_v{{
    {1.0000, {0.00000, 0.00000, 0.00000}},
    {0.9688, {-0.05906, -0.12146, -0.21388}},
    {0.9609, {-0.07391, -0.15663, -0.27669}},
    {0.9531, {-0.08864, -0.19254, -0.33714}},
    {0.9453, {-0.10313, -0.22847, -0.39188}},
    {0.9063, {-0.16914, std::numeric_limits<double>::quiet_NaN(), -0.51550}},
    {0.8594, {-0.22445, -0.44993, -0.42665}},
    {0.8047, {-0.24533, -0.38598, -0.31966}},
    {0.5000, {0.05454, 0.05188, 0.02526}},
    {0.2344, {0.17527, 0.30174, 0.32235}},
    {0.2266, {0.17507, 0.30203, 0.33075}},
    {0.1563, {0.16077, 0.28124, 0.37095}},
    {0.0938, {0.12317, 0.22965, 0.32627}},
    {0.0781, {0.10890, 0.20920, 0.30353}},
    {0.0703, {0.10091, 0.19713, 0.29012}},
    {0.0625, {0.09233, 0.18360, 0.27485}},
    {0.0000, {0.00000, 0.00000, 0.00000}},
}};

}  // namespace wade::validation
