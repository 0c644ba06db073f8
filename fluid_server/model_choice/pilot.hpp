#pragma once
// A short run that can contradict the choice: the chosen candidate and the next better one, side by side, in a patch of water
// like that which the people meet.
//
//   river             6 h x 3 h of a recirculating river
//   lee               the same round the scene's smallest obstacle, long and wide enough for it
//   dry_front, inflow a block of water 3 h long that moves over a dry bed of 3 h: the front as it arrives
//   wet_front         the same over water half as deep, or a dry bed if that is less than a spacing
//
// h and the velocity are those of the scout, else those of the scene. Eight probes stand in it. If the chosen one keeps the
// demand D and the better one its estimate e, their impulses I differ by at most D + e of the load; over a time T shorter than
// the ten seconds of the table particles average out less, by sqrt(10 s / T). A median over the probes of
// |I_1 - I_2| / load_2 above that contradicts the choice.

#include <optional>
#include <string>

#include "fluid_server/model_choice/candidates.hpp"
#include "fluid_server/model_choice/scout.hpp"

namespace wade::fluid::model_choice {

struct PilotResult {
    double time = 0;            // T, simulated, s
    double difference = 0;      // median over the probes
    double allowed = 0;         // (D + e) sqrt(10 s / T)
    double particle_steps = 0;  // work of both
    double cost = 0;            // of both, s of CPU time on the machine of the table
    double steps_per_s = 0;     // time steps per simulated second of the chosen one

    [[nodiscard]] bool contradicts() const { return difference > allowed; }
};

// What a pilot and the scout together may cost: this share of the run, but no less than a fifth of a second of CPU time, on
// the machine of the table and counted in steps.
inline constexpr double pilot_share = 0.05;
inline constexpr double least_pilot = 0.2;  // s

// The pilot, or nothing if it would last less than a second within the budget; `why` then says so.
[[nodiscard]] std::optional<PilotResult> run_pilot(const LoadedScene& written, const SceneWater& water,
                                                   const std::optional<Meeting>& meeting, const Candidate& chosen,
                                                   const Candidate& better, double demand, double budget,
                                                   std::string& why);

}  // namespace wade::fluid::model_choice
