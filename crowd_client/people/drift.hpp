#pragma once
// Drowning of people adrift: a hazard a second instead of a fixed time to drowning. Pure functions. [A]: assumed.
//
//   adrift: afloat or carried; counted where h >= 0.25 H, after the first t0 = 20 s [A] of a drift
//   x += M dt                         exposure, s, kept from drift to drift
//   drowned when lambda x >= E        E = -ln(1 - r), r of [0, 1) drawn once a person
//
//   M = M_swim M_child M_Fr M_cold    all [A]
//   M_swim    0.25 of swimmers
//   M_child   1.5 for H < 1.4 m
//   M_Fr      0.5 for Fr <= 0.3, 1 at 0.6, 3 for Fr >= 1, straight between; Fr = |U| / sqrt(g h)
//   M_cold    max(1, 38 / (15.01 + 0.92 T)) in the first 120 s adrift, T the temperature of the water, C
//
// t0 comes back three times as fast as it goes, so that a short touch of the ground starts no new drift. No source gives deaths against
// time adrift: lambda = 0.006 1/s for adult non-swimmers is assumed, with the range 0.002 to 0.02
// (docs/people_in_water.md#drowning). With one draw a person a larger lambda saves no one.

#include <cstdint>
#include <optional>

namespace wade::crowd {

inline constexpr double struggle_time = 20;  // t0, s [A]

// How a drift ended, or that it goes on.
enum class DriftEnd : std::uint8_t { none, adrift, feet_down, got_up, held, pinned };

// What a person has been through adrift.
struct Drift {
    double struggle = 0;  // of t0, s
    double time = 0;      // adrift, of all drifts, s
    double exposure = 0;  // x, s
    DriftEnd end = DriftEnd::none;
};

// A drifting person and its water.
struct Drifter {
    double height = 1.7;          // H, m
    bool swims = false;           // at present
    double speed = 0, depth = 1;  // |U|, m/s; h, m
    double gravity = 9.81;        // g, m/s2
};

// Returns M without M_cold.
[[nodiscard]] double drift_weight(const Drifter& drifter);

// Returns M_cold after a time adrift, s.
[[nodiscard]] double cold_weight(const std::optional<double>& water_temperature, double adrift);

// Advances the drift by a step of dt, s, adrift with a weight M. `counts`: h >= 0.25 H.
void drift_on(Drift& drift, double weight, bool counts, double dt);

// Advances the drift by a step of dt, s, with ground or a hold.
void breathe(Drift& drift, double dt);

}  // namespace wade::crowd
