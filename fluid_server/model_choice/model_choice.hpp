#pragma once
// The model "auto": the cheapest candidate that is estimated to keep /fluid/max_impulse_error.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "configs/scene/fluid.hpp"
#include "fluid_server/model_choice/pilot.hpp"

namespace wade::fluid::model_choice {

struct ModelChoice {
    LoadedScene scene;  // as chosen, with the hash of the scene as written; saved and loaded anew it needs no choice
    Candidate chosen;
    std::optional<Meeting> meeting;    // with a pilot, if the scout could run
    std::optional<PilotResult> pilot;  // if it fits its share
    bool went_up = false;              // the pilot contradicted the first choice
    std::vector<std::string> lines;    // what was chosen and why, for people
};

[[nodiscard]] inline bool is_open(const Scene& scene) {
    return scene.fluid->model == wade::ModelKind::automatic;
}

// Chooses the model of a scene with the model "auto". `source` names it in errors: the file. Throws ConfigurationError
// if no candidate meets the demand, with the smallest available error and its cost. The choice depends on the scene and
// the table alone: work is counted in steps, not in time.
[[nodiscard]] ModelChoice choose_model(const LoadedScene& written, const std::string& source, bool with_pilot = true,
                                       const std::vector<TableRow>& table = measured_table());

// Writes a scene as chosen into `folder`/scene_as_chosen.json, whole or not at all; the file, which repeats the run without a
// choice. Throws ConfigurationError if it cannot be written.
std::filesystem::path write_chosen(const LoadedScene& chosen, const std::filesystem::path& folder);

}  // namespace wade::fluid::model_choice
