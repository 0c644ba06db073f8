#pragma once
// States of a person in water, and the transitions between them.
//
//   D = max(S, T, R)                   enters                          leaves
//   walking     on its feet            D < 0.45
//   effort      slowed, firm           0.5 <= D
//   sliding     feet slip              D >= 1 for 0.1 s                S < 0.9 and R < 0.64 for 0.3 s: effort
//   toppled     fallen                 T >= 1 for 0.3 s                after 0.3 s: carried
//   afloat      upright, no ground     h >= 0.87 H, the chin           h < 0.8 H: sliding; after 0.3 s
//                                                                      non-swimmers: carried
//   carried     a lying body           see toppled, afloat             h < 0.8 H and D(stands) < 0.8, feet down [A]: sliding;
//                                                                      h < 0.6 H and D(sits) < 1 or D(kneels) < 1: recovering;
//                                                                      a swimmer at h >= 0.87 H: afloat
//   holding     the same, held         carried, and held by a rope, a  as carried; let go: carried
//                                      line or a person with ground
//   pinned      the same, pressed on   carried or afloat, D(stands)    as carried; after a metre: carried
//               a solid or on bodies   >= 1, at rest for 10 s [A]
//                                      (people.hpp)
//   recovering  sits, kneels, squats,  see carried                     no posture so far with D < 1: carried;
//               stands up, 1 s each                                    after 4 s: on its feet
//               [A], as long as D < 1; else
//               it waits in one below
//   drowned                            adrift, by the hazard of drift.hpp; or with no air left                    never
//
// D of a posture: of a body at rest in this posture (resting.hpp). In h < 0.25 H, where the water does not carry a
// body, getting up through sitting or kneeling has priority over feet down. Getting up begins with kneeling where
// sitting does not hold, and skips squatting where standing holds. So in deeper water, a drifting person comes to rest
// only in slower streams.
//
// Air lasts for 60 s [A], less in water of a given temperature (wear.hpp), while the mouth is held under: sitting at
// h >= 0.44 H [A], pinned at h >= 0.25 H. Else it recovers three times as fast. With /crowd/drift_hazard_per_s "under"
// the mouth of a carried person at h >= 0.25 H counts as held under, in place of the hazard. Times are rounded to the
// nearest step.

#include <array>
#include <cstdint>
#include <string_view>

#include "crowd_client/people/drift.hpp"
#include "crowd_client/people/resting.hpp"

namespace wade::crowd {

enum class PersonState : std::uint8_t {
#define WADE_PERSON_STATE(word, kind, end) word,
#include "configs/scene/states.def"
};
inline constexpr std::array person_states = std::to_array<std::string_view>({
#define WADE_PERSON_STATE(word, kind, end) #word,
#include "configs/scene/states.def"
});

inline constexpr double air_budget = 60;   // s [A], where the scene sets no other
inline constexpr double chin = 0.87;       // of H: people float in deeper water
inline constexpr double posture_time = 1;  // of each posture of getting up, s [A]

// Condition of one person, kept from step to step.
struct Condition {
    PersonState state = PersonState::walking;
    double in_state = 0;  // time in this state, s; in recovering it gives the posture (posture_of)
    double slipping = 0;  // how long D >= 1, s
    double toppling = 0;  // how long T >= 1, s
    double firm = 0;      // how long S < 0.9 and R < 0.64, s
    double air = air_budget;
    Drift drift;
};

// Loads on a person in a step; depth and stream low-passed.
struct Strain {
    double slip = 0;                      // S
    double rush = 0;                      // R
    double moment = 0;                    // |F| min(h, H) / 2, N m, of the water past the person
    std::array<double, rests> at_rest{};  // D at rest in each posture
    double weight = 0;                    // N, on the feet
    double height = 1.7;                  // H, m
    double arm = 0;                       // lambda H, m
    double depth = 0;                     // h, m
    double hold = 0;                      // M_hold of the links to standing people or ropes, N m
    bool can_swim = false;
    bool is_pressed = false;    // at rest for 10 s, and pressed by the water on a solid or on others
    double air = air_budget;    // that lasts for the person in this water, s
    bool drifts_under = false;  // the mouth of a carried person counts as held under
    double hazard = 0;          // lambda of drowning adrift, 1/s
    double drift_weight = 1;    // M
    double drowns_at = 1;       // E
};

// Returns the posture in the state recovering.
[[nodiscard]] Rest posture_of(const Condition& recovering);

// Returns T of an upright person.
[[nodiscard]] double topple_demand(const Strain& strain);

// Returns the condition after a step of dt, s.
[[nodiscard]] Condition next_condition(const Condition& before, const Strain& strain, double dt);

// Returns true for a person on its feet that moves as it wants.
[[nodiscard]] inline bool is_firm(PersonState state) {
    return state == PersonState::walking || state == PersonState::effort;
}

[[nodiscard]] inline bool is_adrift(PersonState state) {
    return state == PersonState::afloat || state == PersonState::carried;
}

[[nodiscard]] inline bool has_ground(PersonState state) {
    return state <= PersonState::sliding || state == PersonState::recovering;
}

// Returns true for a person that stands, walks or slides.
[[nodiscard]] inline bool is_on_feet(PersonState state) {
    return state <= PersonState::sliding;
}

}  // namespace wade::crowd
