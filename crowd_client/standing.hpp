#pragma once
// Finds agents that stand although they want to move, and the reason.
//
// An agent stands if for 30 s it has stayed near one position, within a twentieth of its free walking distance in that
// time, 2 m at 1.3 m/s: less than in a queue that moves. The check runs once a second. An agent with a desired speed of
// 0, or one that has arrived or died, does not stand.

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

inline constexpr double standing_time = 30;     // s
inline constexpr double standing_share = 0.05;  // of the free walking distance

// Why an agent stands; if several reasons apply, the first.
enum class StandingReason : std::uint8_t {
    footing,   // the water keeps it off its feet, or they slip (response measured)
    markers,   // too few for walking
    obstacle,  // a box right before it
    water,     // in water most of the time, or waiting at its edge or without a route
    people,    // within a metre
    unknown
};
inline constexpr std::size_t holds = 6;

// Records the agents that stand after a step, and adds a warning to crowd.warnings the first time that each reason is
// found. Call it before judge_outcomes(), while index k still belongs to active[k].
void note_standing(CrowdWorld& crowd, std::uint64_t step);

// Returns the number of active agents that stand.
[[nodiscard]] std::size_t count_standing(const CrowdWorld& crowd);

// Returns the state of an agent, one of state_names(): "arrived", "dead" or "drowned", "standing", "walking", or, with
// the response measured, as people/states.hpp says.
[[nodiscard]] std::string_view state_name(const CrowdWorld& crowd, std::size_t id);
[[nodiscard]] std::vector<std::string_view> state_names(const Scene& scene);

}  // namespace wade::crowd
