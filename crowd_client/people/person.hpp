#pragma once
// A person in moving water: buoyancy, drag, slipping, toppling, one step, walking speed. Pure functions.
//
//   H  height, m             h  depth of the water, m            U  its velocity, m/s
//   m  mass, kg              x  = h / H                          v  the person's velocity, m/s
//   mu friction of the feet  lambda  arm of the weight over H    u  = U - v
//
// mu and lambda are fitted to people in flumes. docs/people_in_water.md has the experiments, the errors and the ranges.
// [A]: assumed.

#include <limits>

#include "crowd_client/equations.hpp"

namespace wade::crowd {

inline constexpr double body_density = 1050;      // kg/m3; with 1010 the fits change by less than 0.6 points
inline constexpr double body_width_share = 0.16;  // B / H, B the width against the stream
inline constexpr double body_drag = 1.1;          // C_D, of a cylinder of such a Reynolds number
inline constexpr double usual_height = 1.7;       // H of a person without a height of its own, m [A]
inline constexpr double stepping_time = 0.4;      // t_w, relaxation time of legs to the wanted velocity, s [A]

// Properties of the water round a person.
struct WaterProperties {
    double density = 1000;  // rho, kg/m3
    double gravity = 9.81;  // g, m/s2
};

struct Body {
    double height = 1.7;  // H, m
    double mass = 65;     // m, kg
};

// Returns f, the fraction of the body's volume under water, 0.633 x^2 + 0.367 x, x = h / H up to 1 (Xia et al. 2014).
[[nodiscard]] double submerged_share(double height, double depth);

// Returns the weight on the feet N = m g (1 - f rho / body_density), N; 0 for a floating person.
[[nodiscard]] double weight_on_feet(const Body& body, double depth, const WaterProperties& water);

// Returns k = rho C B min(h, H) / 2, kg/m, of an upright person: the drag is k |u| u. C: body_drag, or a larger one
// where the person itself slows the sampled flow.
[[nodiscard]] double drag_upright(double height, double depth, const WaterProperties& water, double drag = body_drag);

// Return the frontal area of a body that lies in the water, 0.5 m2, less in water shallower than 0.25 m [A]; and its k.
[[nodiscard]] double area_lying(double depth);
[[nodiscard]] double drag_lying(double depth, const WaterProperties& water, double drag = body_drag);

// Returns M = m + rho m f / body_density, kg: the body and its added mass, the displaced water.
[[nodiscard]] double mass_with_water(double mass, double share, const WaterProperties& water);

// Returns S = k |U - v_w|^2 / (mu N): the drag at the wanted velocity over the friction of the feet. At 1 they slip.
[[nodiscard]] double slip_demand(double k, const Vector2d& stream, const Vector2d& wanted, double friction,
                                 double weight);

// Returns T = k |u|^2 min(h, H) / 2 / (N l + M_hold): the moment of the drag over that of the weight. At 1 the person
// topples. arm: l = lambda H, m; hold: M_hold, N m, of a hand that holds on to something.
[[nodiscard]] double topple_demand(double k, const Vector2d& relative, double wet_height, double weight, double arm,
                                   double hold = 0);

// Returns v_most, m/s: the water speed over the ground above which people of any weight lose their footing. 2 m/s up to
// 0.16 m, rising to 3 m/s at 0.2 m, 3 m/s beyond; below 0.05 m times 0.05 m / h [A]. From flumes and streets:
// docs/people_in_water.md#fast-shallow-water.
[[nodiscard]] double fastest_footing(double depth);

// Returns R = (|U| / v_most)^2: at 1 the feet slip at any weight.
[[nodiscard]] double rush_demand(double depth, const Vector2d& stream);

// Returns the largest friction of the feet in a stream, N: `grip`, from R = 0.8 on less, at R = 1 at most k v_most^2,
// the drag there.
[[nodiscard]] double grip_in_stream(double grip, double k, double depth, const Vector2d& stream);

// Returns the susceptibility tau of the output files: max(0, 1 - 1 / S), the fraction of the drag that the feet do not
// hold.
[[nodiscard]] double tau_of(double slip_demand);

// Computes a step of a person with ground under the feet. Legs push the ground with at most mu N in any direction:
//
//   v_a = v_w + (v - v_w) exp(-dt / t_w)                       the velocity aim of the legs
//   G   = M (v_a - v) / dt - k |U - v_a| (U - v_a) - E         the force of the ground that reaches the aim
//   |G| <= mu N:  v' = v_a
//   else:         G *= mu N / |G|,  M (v' - v) / dt = G + E + k |U - v'| (U - v')    solved for v': stable for any dt
//
// E: pull of the links to others, N.
// Drag and legs are solved together, so that the velocity of a sliding person does not depend on the time step.
struct Footing {
    double k = 0;     // of the drag, kg/m
    double mass = 0;  // M, kg
    double grip = 0;  // mu N, N
};
struct PersonStep {
    Vector2d velocity = Vector2d::Zero();  // v', m/s; with ground the displacement is dt v'
    Vector2d ground = Vector2d::Zero();    // impulse of the ground, dt G, N s
    Vector2d drag = Vector2d::Zero();      // impulse of the water, N s; the water gets the opposite
    bool slides = false;
};
[[nodiscard]] PersonStep step_on_feet(const Footing& footing, const Vector2d& velocity, const Vector2d& wanted,
                                      const Vector2d& stream, double dt, const Vector2d& pulls = Vector2d::Zero());

// Computes a step without ground: M dv/dt = k |u| u + force, implicit in the drag. force: swimming and links, N.
[[nodiscard]] PersonStep step_carried(double k, double mass, const Vector2d& velocity, const Vector2d& force,
                                      const Vector2d& stream, double dt);

// Terms of a person's step in water.
struct PersonInWater {
    Footing footing;
    bool has_ground = true;
    Vector2d wanted = Vector2d::Zero();                             // velocity, m/s; used with ground
    Vector2d swimming = Vector2d::Zero();                           // force, N; used without ground
    Vector2d stream = Vector2d::Zero();                             // U sampled, m/s
    double most_impulse = std::numeric_limits<double>::infinity();  // that the water can give in the step, N s
};
[[nodiscard]] PersonStep step_in_water(const PersonInWater& person, const Vector2d& velocity, const Vector2d& pulls,
                                       double dt);

enum class Sex : std::uint8_t { female, male };

// Returns r in (0, 1], the walking speed in water over that on dry ground,
//
//   r = min(1, (d_e / d_0)^-0.38),  d_e = sqrt(h^2 + 2 |U|^2 h / g),  d_0 = 0.0970 m for men, 0.0733 m for women
//
// with the exponent of Postacchini et al. 2018 on the specific force. d_0 reproduces r of Li et al. 2026 at 0.35 m
// (0.614, 0.552).
[[nodiscard]] double walking_speed_ratio(Sex sex, double depth, double speed, double gravity);

}  // namespace wade::crowd
