#pragma once
// Fatigue and cold of people in water. Pure functions. [A]: assumed.
//
// Muscles have three compartments (Xia and Frey Law 2008): the fraction M_A works, M_F is tired, the rest is rested.
//
//   dM_F / dt = F M_A - R M_F,   M_A = min(load, 1 - M_F)       load: the force asked over that of the fresh muscle, [0, 1]
//
// Their controller brings M_A to the load within 0.1 s, here M_A is at the load at once, so that a step has a closed
// form. The load that can be held for ever is R / (F + R), 9 % for the knee. Under a smaller load the muscle rests, and
// R is 15 times as large (Looft et al. 2018). F and R, 1/s: Frey Law, Looft and Heitsman 2012.

namespace wade::crowd {

struct MuscleRates {
    double fatigue = 0;   // F, 1/s
    double recovery = 0;  // R, 1/s
};
inline constexpr MuscleRates knee_rates{0.01500,
                                        0.00149};  // of legs that brace themselves [A]: their first joint to tire
inline constexpr MuscleRates hand_rates{0.00980, 0.00064};  // of a grip
inline constexpr double rest_multiplier = 15;

// Returns the tired fraction of a muscle after a load for a time dt, s; exact for any dt.
[[nodiscard]] double tired_after(double tired, double load, const MuscleRates& rates, double dt);

// Returns how long a fresh muscle holds a load, s; infinity below the load held for ever:
// -ln(1 - R (1 - load) / (F load)) / R.
[[nodiscard]] double endurance_time(double load, const MuscleRates& rates);

// Returns a bracing constant (mu, lambda) for legs with the fraction `strength` of fresh, warm ones: no less than that
// of a dummy, which does not brace [A].
[[nodiscard]] double braced_with(double fresh, double of_dummy, double strength);

// Cold. Temperatures in C.
inline constexpr double warm_muscle = 36.6;  // of a thigh at rest, 3 cm deep (Sargeant 1987)

// Returns a thigh's temperature after a time dt, s. It approaches that of the water, or 36.6 C out of it [A], by
// 1.2e-4 of the difference a second, as legs in baths of 12 and 18 C went to 29.0 and 31.9 C in 45 min (Sargeant 1987).
[[nodiscard]] double thigh_after(double thigh, double water, bool in_water, double dt);

// Return the strength over that of a warm muscle: holding, -2 % a degree (Bergh and Ekblom 1979); moving, -2.7 %
// (Sargeant 1987).
[[nodiscard]] double holding_strength(double thigh);
[[nodiscard]] double moving_strength(double thigh);

// Returns the chill of the hands, their loss of grip over the final loss, [0, 1], after a time dt, s, in the water
// (most of it in two minutes, Vincent and Tipton 1988) or out of it (back within 40 min, Coppin et al. 1978).
[[nodiscard]] double chill_after(double chill, bool in_water, double dt);

// Returns the grip of chilled hands over that of warm ones: 16 % less in water of 5 C (Vincent and Tipton 1988), linear
// to 0 at 35 C [A], which is 13 % at 10 C; Barnes and Larson 1985 measured 14 %.
[[nodiscard]] double chilled_grip(double chill, double water);

// Returns how long a person holds the breath after sudden immersion, s: 15.01 + 0.92 T, measured from 0 to 35 C
// (Hayward et al. 1984).
[[nodiscard]] double breath_in(double water);

// Returns how long a swimmer swims, s: 90 min in water of 10 C, when five of ten had failed or nearly so (Tipton et al.
// 1999); 7.6 min at 4.7 C, when two of four had (Keatinge et al. 1969); exponential between and above [A], constant
// below [A].
[[nodiscard]] double swimming_time(double water);

// Fatigue and cold of one person.
struct Wear {
    double legs = 0, hands = 0;  // M_F
    double load = 0;             // of the legs, in the last step
    double thigh = warm_muscle;  // C
    double chill = 0;            // of the hands
    double swum = 0;             // s
};

}  // namespace wade::crowd
