#pragma once
// Who stands though it wants to move, and what keeps it.
//
// Somebody stands if for 30 s it has not got farther from one place than a twentieth of what it walks freely in that
// time, 2 m at 1.3 m/s: less than in a queue that moves. Looked for once a second. Who wants nothing (desired speed 0), has arrived or is dead does not stand.

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

inline constexpr double standing_time = 30;     // s
inline constexpr double standing_share = 0.05;  // of the free way

// Why an agent stands still; of several reasons the first.
enum class StandingReason : std::uint8_t {
    footing,   // the water keeps it off its feet, or they slip (response measured)
    markers,   // too few to walk by
    obstacle,  // a box right before it
    water,     // in which it was most of the time
    people,    // within a metre
    unknown
};
inline constexpr std::size_t holds = 6;

// Notes who stands after a step, and warns once of each hold that it finds, in crowd.warnings. Before judge_outcomes(): place k still belongs to active[k].
void note_standing(CrowdWorld& crowd, std::uint64_t step);

// Of the active agents.
[[nodiscard]] std::size_t count_standing(const CrowdWorld& crowd);

// How it goes with an agent, one of state_names(): "arrived", "dead" or "drowned", "standing", "walking", or, with the response
// measured, as people/states.hpp says.
[[nodiscard]] std::string_view state_name(const CrowdWorld& crowd, std::size_t id);
[[nodiscard]] std::vector<std::string_view> state_names(const Scene& scene);

}  // namespace wade::crowd
