#pragma once
// Exact laminar flows between planes and in a periodic square.

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

// Share of its first speed that the Taylor-Green vortex of a square of side `length` still has at time t:
// exp(-2 nu k^2 t) with k = 2 pi / L, for u = -U cos kx sin ky, v = U sin kx cos ky (Taylor and Green 1937, in the plane).
double taylor_green_decay(double t, double viscosity, double length);

}  // namespace wade::validation
