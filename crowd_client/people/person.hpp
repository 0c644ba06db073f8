#pragma once
// A person in moving water: buoyancy, drag, whether feet slip or the body topples, one step, how fast one walks. Pure functions.
//
//   H  height, m             h  depth of the water, m            U  its velocity, m/s
//   m  mass, kg              x  = h / H                          v  the person's velocity, m/s
//   mu friction of the feet  lambda  arm of the weight over H    u  = U - v
//
// Both constants are fitted to people in flumes; docs/people_in_water.md says to which, how well, and where they end. [A]: assumed.

#include <limits>

#include "crowd_client/equations.hpp"

namespace wade::crowd {

inline constexpr double body_density = 1050;      // kg/m3; with 1010 the fits change by less than 0.6 points
inline constexpr double body_width_share = 0.16;  // B / H, B the width against the stream
inline constexpr double body_drag = 1.1;          // C_D, of a cylinder of such a Reynolds number
inline constexpr double usual_height = 1.7;       // H of who has no height of its own, m [A]
inline constexpr double stepping_time = 0.4;      // t_w, in which legs reach the velocity wanted, s [A]

// The water round a person, as its equations need it.
struct WaterProperties {
    double density = 1000;  // rho, kg/m3
    double gravity = 9.81;  // g, m/s2
};

struct Body {
    double height = 1.7;  // H, m
    double mass = 65;     // m, kg
};

// f: share of the body's volume under water, 0.633 x^2 + 0.367 x with x = h / H up to 1 (Xia et al. 2014).
[[nodiscard]] double submerged_share(double height, double depth);

// N = m g (1 - f rho / body_density), N: the weight that the feet carry; 0 for who floats.
[[nodiscard]] double weight_on_feet(const Body& body, double depth, const WaterProperties& water);

// k = rho C B min(h, H) / 2, kg/m, of who is upright: the drag is k |u| u. C: body_drag, or another where the water that is felt
// is slowed by the person itself.
[[nodiscard]] double drag_upright(double height, double depth, const WaterProperties& water, double drag = body_drag);

// The area against the water of a body that lies in it, 0.5 m2, less where it is shallower than 0.25 m [A]; and its k.
[[nodiscard]] double area_lying(double depth);
[[nodiscard]] double drag_lying(double depth, const WaterProperties& water, double drag = body_drag);

// M = m + rho m f / body_density, kg: of the body and the water that it displaces, which moves with it.
[[nodiscard]] double mass_with_water(double mass, double share, const WaterProperties& water);

// S = k |U - v_w|^2 / (mu N): the drag at the velocity wanted over what the feet hold. At 1 they slip.
[[nodiscard]] double slip_demand(double k, const Vector2d& stream, const Vector2d& wanted, double friction,
                                 double weight);

// T = k |u|^2 min(h, H) / 2 / (N l + M_hold): the moment of the drag over that of the weight. At 1 one topples.
// arm: l = lambda H, m; hold: M_hold, N m, of who holds on to something.
[[nodiscard]] double topple_demand(double k, const Vector2d& relative, double wet_height, double weight, double arm,
                                   double hold = 0);

// Returns v_most, m/s: the fastest water over the ground in which people of any weight keep their footing. 2 m/s up to 0.16 m, rising to
// 3 m/s at 0.2 m, 3 m/s beyond; below 0.05 m times 0.05 m / h [A]. Of flumes and streets: docs/people_in_water.md#fast-shallow-water.
[[nodiscard]] double fastest_footing(double depth);

// Returns R = (|U| / v_most)^2: at 1 the feet slip, whatever they carry.
[[nodiscard]] double rush_demand(double depth, const Vector2d& stream);

// Returns what the feet hold in a stream, N: `grip`, and from R = 0.8 on less, k v_most^2 at R = 1, the drag there.
[[nodiscard]] double grip_in_stream(double grip, double k, double depth, const Vector2d& stream);

// tau as files have it: max(0, 1 - 1 / S), the share of the push of the water that the feet do not hold.
[[nodiscard]] double tau_of(double slip_demand);

// A step of who has the ground under the feet. Legs push the ground with at most mu N in any direction:
//
//   v_a = v_w + (v - v_w) exp(-dt / t_w)                       where the legs want to be
//   G   = M (v_a - v) / dt - k |U - v_a| (U - v_a) - E         the force of the ground that takes them there
//   |G| <= mu N:  v' = v_a
//   else:         G *= mu N / |G|,  M (v' - v) / dt = G + E + k |U - v'| (U - v')    solved for v': no step is too long
//
// E: of those who hold on to one, N.
// Drag and legs are one step, not one after the other, so that a person who slides has the same velocity with any step.
struct Footing {
    double k = 0;     // of the drag, kg/m
    double mass = 0;  // M, kg
    double grip = 0;  // mu N, N
};
struct PersonStep {
    Vector2d velocity = Vector2d::Zero();  // v', m/s; who has ground goes on by dt v'
    Vector2d ground = Vector2d::Zero();    // impulse of the ground, dt G, N s
    Vector2d drag = Vector2d::Zero();      // impulse of the water, N s; the water gets the opposite
    bool slides = false;
};
[[nodiscard]] PersonStep step_on_feet(const Footing& footing, const Vector2d& velocity, const Vector2d& wanted,
                                      const Vector2d& stream, double dt, const Vector2d& pulls = Vector2d::Zero());

// A step without ground: M dv/dt = k |u| u + force, implicit in the drag. force: of a swimmer and of those who hold him, N.
[[nodiscard]] PersonStep step_carried(double k, double mass, const Vector2d& velocity, const Vector2d& force,
                                      const Vector2d& stream, double dt);

// A person in a step: what it stands in and wants.
struct PersonInWater {
    Footing footing;
    bool has_ground = true;
    Vector2d wanted = Vector2d::Zero();                             // velocity, m/s; of who has ground
    Vector2d swimming = Vector2d::Zero();                           // force, N; of who has none
    Vector2d stream = Vector2d::Zero();                             // U felt, m/s
    double most_impulse = std::numeric_limits<double>::infinity();  // that the water has to give in the step, N s
};
[[nodiscard]] PersonStep step_in_water(const PersonInWater& person, const Vector2d& velocity, const Vector2d& pulls,
                                       double dt);

enum class Sex : std::uint8_t { female, male };

// r in (0, 1]: the speed of walking in water over that on dry ground,
//
//   r = min(1, (d_e / d_0)^-0.38),  d_e = sqrt(h^2 + 2 |U|^2 h / g),  d_0 = 0.0970 m for men, 0.0733 m for women
//
// the exponent of Postacchini et al. 2018 on the specific force, through what Li et al. 2026 measured at 0.35 m (0.614, 0.552).
[[nodiscard]] double walking_speed_ratio(Sex sex, double depth, double speed, double gravity);

}  // namespace wade::crowd
