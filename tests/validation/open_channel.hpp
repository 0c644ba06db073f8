#pragma once
// Steady flow of water without friction in a rectangular channel, in the hydrostatic (shallow-water) approximation.
//
// Throughout: q = u h, discharge per width, m^2/s, above 0; g: m/s^2; depths h and heights of the bed z: m; s: distance
// downstream, m. Source of all equations: V. T. Chow, Open-Channel Hydraulics (1959), chapters 3 and 15; the flows over
// a bump are those of N. Goutal and F. Maurel, Proc. 2nd Workshop on Dam-Break Wave Simulation (1997), as collected by
// O. Delestre et al., SWASHES, Int. J. Numer. Methods Fluids 72 (2013), 269-300.

#include <vector>

namespace wade::validation {

// Returns the critical depth, with the least energy and Froude number 1: h_c = (q^2 / g)^(1/3).
double critical_depth(double q, double g);

// Specific energy, the head above the bed: E = h + q^2 / (2 g h^2), m.
double specific_energy(double q, double h, double g);

// Momentum function: M = h^2 / 2 + q^2 / (g h), m^2; equal on both sides of a hydraulic jump on a level bed.
double momentum_function(double q, double h, double g);

// The two depths that have the specific energy E: above and below the critical depth. E below 3/2 h_c has none: the
// critical depth is returned.
double subcritical_depth(double q, double energy, double g);
double supercritical_depth(double q, double energy, double g);

// Belanger (1828): the ratio of the depths behind and before a jump on a level bed, h_2 / h_1 = (sqrt(1 + 8 Fr^2) - 1) / 2
// with Fr = u_1 / sqrt(g h_1). A jump that moves obeys it with u_1 relative to the jump.
double belanger_ratio(double froude);

// The bump of the SWASHES cases: z = 0.2 m - 0.05/m (s - 10 m)^2 where that is positive, 8 m < s < 12 m.
double bump_height(double s);
inline constexpr double bump_crest = 10;       // m
inline constexpr double bump_top = 0.2;        // m
inline constexpr double bump_half_length = 2;  // m

// A steady flow over the bump; depth(s) gives the depth at s.
struct BumpFlow {
    enum class Kind { subcritical, transcritical, with_jump };
    Kind kind = Kind::subcritical;
    double q = 0;
    double g = 0;
    double energy_upstream = 0;    // total head above z = 0 before the jump, m
    double energy_downstream = 0;  // the same behind it
    double jump = 0;               // s of the jump; kind with_jump only

    [[nodiscard]] double depth(double s) const;
};

// Subcritical everywhere; depth_downstream: far from the bump. Throws std::invalid_argument if the bump would choke it.
BumpFlow subcritical_bump_flow(double q, double depth_downstream, double g);

// Subcritical before the crest, critical on it, supercritical behind it: q alone decides.
BumpFlow transcritical_bump_flow(double q, double g);

// As before, and a jump back to subcritical flow on the lee side, or on the level bed behind it (then at `jump` =
// crest + half length), so that the depth far downstream is depth_downstream. Throws std::invalid_argument if there is
// no such position: the jump would be swept away or would drown the crest.
BumpFlow bump_flow_with_jump(double q, double depth_downstream, double g);

// The transcritical flow with the curvature of its streamlines, which the hydrostatic solution leaves out: to second order
//
//   H = z + h + q^2 / (2 g h^2) (1 + (2 h h'' - h'^2) / 3 + h z'' + z'^2),   ' = d/ds
//
// (F. Serre, La Houille Blanche 8 (1953); W. H. Hager and K. Hutter, Acta Mechanica 51 (1984), 31-48). Uniform flow
// upstream, no waves; only this head H leads to uniform supercritical flow downstream. At the ends
// of the bump its slope changes by 0.2, and with it h' by -3/2 of that.
struct CurvedBumpFlow {
    double q = 0;
    double g = 0;
    double energy = 0;           // H, m
    std::vector<double> depths;  // h from the start of the bump on, `step` apart; uniform behind them, m

    static constexpr double step = 0.002;  // m
    [[nodiscard]] double depth(double s) const;
};
CurvedBumpFlow curved_transcritical_bump_flow(double q, double g);

// The mean over [from, to] of the height of the surface, h + z, m.
double mean_surface(const BumpFlow& flow, double from, double to);

}  // namespace wade::validation
