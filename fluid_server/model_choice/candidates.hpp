#pragma once
// What could compute a scene, what it would cost and how wrong it is estimated to be.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "configs/loading/scene_loader.hpp"
#include "fluid_server/model_choice/scene_water.hpp"

namespace wade::fluid::model_choice {

// An estimate is the error of the table times this, as no scene is that of the table: a change of gravity by 0.01 % alone
// makes the error of the default in the lee 1.43 times as large (0.074 to 0.105).
inline constexpr double estimate_margin = 1.5;

struct Candidate {
    Settings settings;   // of the rows of the table that it rests on
    double spacing = 0;  // of the particles, and size of the cells, in this scene, m
    double median = 0;   // estimated error of the impulse on standing people, the worst of the scene's kinds of water
    double p95 = 0;      // the same of the 95th percentile
    WaterKind worst = WaterKind::river;  // the kind of water that the median is of
    double steps_per_s = 0;              // time steps per simulated second, expected
    std::uint64_t particles = 0;         // of the full channel
    double step_cost = 0;                // of a particle and time step, s of CPU time on the machine of the table
    double cost = 0;                     // of the whole run, the same
    std::vector<SceneOverride> overrides = {};  // make the scene one that names the model
    std::string refused = {};                   // why the scene cannot be run so; empty: it can

    // time steps times particles of the whole run
    [[nodiscard]] double particle_steps(double duration) const {
        return steps_per_s * duration * static_cast<double>(particles);
    }
};

// The scene as the candidate computes it. Throws ConfigurationError if it cannot be.
[[nodiscard]] LoadedScene scene_as(const LoadedScene& written, const Candidate& candidate);

// Every setting of the table that has a row for each kind of water of the scene, at its spacing scaled to the scene; and
// each at the scene's own spacing, with the errors of the next coarser row. By cost, refused ones last.
[[nodiscard]] std::vector<Candidate> candidates_of(const std::vector<TableRow>& table, const LoadedScene& written,
                                                   const SceneWater& water);

// Returns the candidates that no other one beats in both cost and median, by cost; of equal ones the first. Leaves out
// refused ones.
[[nodiscard]] std::vector<Candidate> front_of(const std::vector<Candidate>& candidates);

// Returns the index of the cheapest candidate with a median of at most `demand`; nullopt if there is none.
[[nodiscard]] std::optional<std::size_t> choose(const std::vector<Candidate>& front, double demand);

// A few characters: "dfsph, d = 0.2321 m, cfl 1".
[[nodiscard]] std::string label(const Candidate& candidate);

}  // namespace wade::fluid::model_choice
