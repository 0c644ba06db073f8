#pragma once
// Rescuers (`rescuer` of a group) and their lines. A casualty is an agent in the state carried, holding or pinned
// (states.hpp).
//
//   waits     within 0.5 m of its goal; from farther away it walks there
//   goes      to the nearest casualty within 20 m in line of sight, if the rescuer can stand with D < 0.8 (states.hpp)
//             on every metre of the straight path to the throw
//   goes      else to a casualty within 20 m behind obstacles [A: the rescuer hears calls], on the fastest route
//   round     (travel_time.hpp), at most 30 m to each side of the rescuer, again with D < 0.8 on every metre until the
//             line can be thrown. It searches once a second, and not with the navigation `straight`
//   throws    a line of 15 m [A] to the casualty, and never misses [A]. Both hold it with both hands. A pull above
//             their grip for 0.3 s tears it away; the next throw is 20 s later [A]
//   brings in walks to the nearest position with h < 0.3 m, else to its goal, stands there and hauls the line in at
//             0.5 m/s [A], while the line pulls less than one hand holds. A casualty that regains its feet walks to the
//             rescuer. If a corner would cut off the line, the rescuer hauls before it walks, until 2 m are left [A]
//   lets go   of an agent that stands with D < 0.8 where h < 0.3 m, or beside the rescuer. The agent counts as saved
//             unless it dies later
//
// The stream swings a casualty on a line to the rescuer's bank. A rescuer that loses its feet loses the line, and
// becomes a casualty itself.

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

// Returns the rescuers of the scene, before the first step.
[[nodiscard]] Rescues rescues_of_scene(const Scene& scene, const Agents& agents);

// Decides what each rescuer does in the step, throws lines and drops them.
void send_rescuers(CrowdWorld& crowd, const WaterBins& water);

// Sets crowd.goal_offsets: of rescuers to their next displacement, of agents on a line to that to the rescuer.
void lead_rescued(CrowdWorld& crowd);

// Returns true for a rescuer that stays at its position: its desired speed is then 0.
[[nodiscard]] bool waits(const CrowdWorld& crowd, std::uint32_t id);

// Returns true for a rescuer while other agents than rescuers are active. It then stays active at its goal.
[[nodiscard]] bool is_on_duty(const CrowdWorld& crowd, std::uint32_t id);

struct RescueCount {
    std::size_t rescuers = 0;
    std::size_t saved = 0;      // brought in, and not dead
    std::size_t lost_feet = 0;  // rescuers that were off their feet at some time
};
[[nodiscard]] RescueCount count_rescues(const CrowdWorld& crowd);

}  // namespace wade::crowd
