#pragma once
// Rescuers (`rescuer` of a group): whom they go to, whom they hold on a line, whom they have brought in.
//
//   waits     at its goal, 0.5 m from it or less; else it walks there
//   goes      to the nearest who is carried or holds on to something, within 20 m and in sight, as long as it would stand with
//             D < 0.8 (states.hpp) on every metre of the straight way
//   goes      else to who is out of sight behind obstacles, within 20 m as well [A: it hears him]: by the way that takes least time
//   round     (travel_time.hpp), at most 30 m to each side of the rescuer, again with D < 0.8 on every metre until the line can be
//             thrown. It looks for one once a second; with the navigation `straight` it does not
//   throws    a line of 15 m [A] to him; it meets [A]. Both hold it with both hands; what pulls more for 0.3 s tears it away,
//             and the next throw is 20 s later [A]
//   brings in walks to the nearest place with h < 0.3 m, else to its goal, stands there and hauls the line in, 0.5 m/s [A], while
//             it pulls less than one hand holds; whoever has feet again walks to it. Where a corner is in the line's way there, it hauls
//             first, until 2 m are left [A]
//   lets go   of who stands with D < 0.8 where h < 0.3 m, or beside it: that one is saved, if he does not die later
//
// The stream swings a carried body on a line to the bank on which the rescuer stands. Who loses its feet loses the line, and is
// somebody to rescue.

#include "crowd_client/crowd_state.hpp"

namespace wade::crowd {

[[nodiscard]] Rescues rescues_of_scene(const Scene& scene, const Agents& agents);

// Decides what each rescuer does in the step, throws lines and drops them.
void send_rescuers(CrowdWorld& crowd, const WaterBins& water);

// Turns crowd.goal_offsets of rescuers, and of those on their feet who are on a line, to where they go.
void lead_rescued(CrowdWorld& crowd);

// Whether it stays where it is, whatever its speed.
[[nodiscard]] bool waits(const CrowdWorld& crowd, std::uint32_t id);

// Whether it has to stay though it is at its goal, for those who are on their way.
[[nodiscard]] bool is_on_duty(const CrowdWorld& crowd, std::uint32_t id);

struct RescueCount {
    std::size_t rescuers = 0;
    std::size_t saved = 0;      // brought in, and not dead
    std::size_t lost_feet = 0;  // rescuers whom the water carried at some time
};
[[nodiscard]] RescueCount count_rescues(const CrowdWorld& crowd);

}  // namespace wade::crowd
