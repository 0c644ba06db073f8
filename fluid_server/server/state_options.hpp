#pragma once
// What the options --from-state and --save-state do, and the state that a failed run leaves behind.

#include <filesystem>
#include <string>

#include "configs/loading/scene_loader.hpp"
#include "fluid_server/fluid_model.hpp"

namespace wade::fluid {

// Makes the model go on from the state in `file`. Returns a sentence for the log. Throws ConfigurationError.
std::string start_from_state(FluidModel& model, const std::filesystem::path& file);

// Throws ConfigurationError unless the model has a state and the folder of `file` is there, so that a long run does not
// end in vain.
void check_can_save_state(FluidModel& model, const std::filesystem::path& file);

// Writes the state after the last frame. Returns a sentence for the log. Throws RunError if it cannot be written.
std::string save_state(FluidModel& model, const LoadedScene& loaded, const std::filesystem::path& file);

// After a numerical failure, writes into the folder: numerical_failure.state, the state at the begin of the frame that
// failed; last_sound.state, if the water was unsound then already; and the scene as numerical_failure.json. Returns a
// sentence that says so and how to go on, or why nothing could be written; empty if the model keeps no state.
std::string dump_failure(const FluidModel& model, const LoadedScene& loaded, const std::filesystem::path& folder);

}  // namespace wade::fluid
