#pragma once
// Where and when the people of a scene meet water, by a cheap run of the whole scene with the shallow-water model.

#include <cstdint>
#include <optional>
#include <vector>

#include "configs/loading/scene_loader.hpp"
#include "fluid_server/model_choice/scene_water.hpp"

namespace wade::fluid::model_choice {

// A place on the ground, m.
struct Probe {
    double x = 0, z = 0;
};

// Where people stand, walk and head for: the start of each agent, its goal, and three places on the straight way between,
// those in the channel and clear of obstacles; evenly thinned to at most 200.
[[nodiscard]] std::vector<Probe> probes_of(const Scene& scene);

// What the probes met, each at the time of its largest depth times speed; medians over those that met water.
struct Meeting {
    std::size_t probes = 0, wet = 0;
    double first_time = 0;         // s, when the first probe met water
    double depth = 0, speed = 0;   // m, m/s
    double until = 0;              // simulated time, s; less than the duration if the budget was spent
    std::uint64_t cell_steps = 0;  // work
};

// CPU time of a cell-step on the machine of the table, s: see docs/models_of_water.md.
inline constexpr double cell_step_cost = 4e-8;

// At most `budget` s of CPU time on the machine of the table, counted in cell-steps. Nothing if the shallow-water model cannot
// take the scene or no probe is in the channel.
[[nodiscard]] std::optional<Meeting> scout(const LoadedScene& written, const SceneWater& water, double budget);

}  // namespace wade::fluid::model_choice
