#include "fluid_server/server/state_options.hpp"

#include <exception>
#include <system_error>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "fluid_server/dfsph/stabler_settings.hpp"
#include "fluid_server/states/fluid_state.hpp"
#include "fluid_server/states/state_file.hpp"

namespace wade::fluid {

namespace {

std::string when(const FluidState& state) {
    return "frame " + std::to_string(state.frame) + " of the water, t = " + short_number(state.time) + " s, " +
           std::to_string(state.particles.count) + " particles";
}

// For a shell; plain names stay as they are.
std::string quoted(const std::filesystem::path& file) {
    const std::string text = file.string();
    const bool plain = text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-+") ==
                       std::string::npos;
    if (plain) return text;
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

}  // namespace

std::string start_from_state(FluidModel& model, const std::filesystem::path& file) {
    const FluidState state = read_state(file);
    model.restore(state, "--from-state " + file.string());
    return "goes on from " + file.string() + ": " + when(state);
}

void check_can_save_state(FluidModel& model, const std::filesystem::path& file) {
    if (model.state() == nullptr) {
        throw ConfigurationError("--save-state " + file.string() + ": /fluid/model is " + std::string(model.name()) +
                                 "; allowed: dfsph, the only model that has a state");
    }
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!std::filesystem::is_directory(folder) || std::filesystem::is_directory(file)) {
        throw ConfigurationError("--save-state " + file.string() + ": allowed: a file in a folder that exists");
    }
    if (is_state_or_new(file)) return;
    throw ConfigurationError("--save-state " + file.string() +
                             ": the file is there and no state of the water; allowed: a new file or a state");
}

std::string save_state(FluidModel& model, const LoadedScene& loaded, const std::filesystem::path& file) {
    const FluidState& state = *model.state();
    write_state(file, state, loaded.canonical_json);
    return "state written to " + file.string() + ": " + when(state);
}

std::string dump_failure(const FluidModel& model, const LoadedScene& loaded, const std::filesystem::path& folder) {
    const FailureStates states = model.states_before_failure();
    if (states.frame_begin == nullptr) return {};
    const std::filesystem::path scene = folder / "numerical_failure.json";
    const std::filesystem::path begin = folder / "numerical_failure.state";
    const std::filesystem::path sound = folder / "last_sound.state";
    const bool earlier = states.last_sound != nullptr && states.last_sound != states.frame_begin;
    try {
        replace_file(scene, loaded.canonical_json);
        write_state(begin, *states.frame_begin, loaded.canonical_json);
        std::error_code none;
        if (!earlier) std::filesystem::remove(sound, none);  // of a run before
        if (earlier) write_state(sound, *states.last_sound, loaded.canonical_json);
    } catch (const std::exception& error) {
        return "the state before the failure is lost: " + std::string(error.what());
    }
    std::string text = "the state before it (" + when(*states.frame_begin) + ") is in " + begin.string();
    if (earlier) text += ", the last sound one (" + when(*states.last_sound) + ") in " + sound.string();
    return text + "; go on with: fluid_server " + quoted(scene) + " --from-state " + quoted(earlier ? sound : begin) +
           " --consumers 0" + options_of_advice(loaded.scene.fluid);
}

}  // namespace wade::fluid
