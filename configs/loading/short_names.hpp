#pragma once
// Scenes by short names, as `wade scenes` lists them: "river/s05" is river/s05.json of the folder of scenes.

#include <filesystem>
#include <optional>
#include <string>

namespace wade {

// Returns the folder of the scenes that come with the programs, or nothing: the folder that WADE_CONFIGS names, else the one of
// the installation or of the sources that the running program lies in.
[[nodiscard]] std::optional<std::filesystem::path> scenes_folder();

// Returns the file of a short name in a folder of scenes: the path below it without .json; or a name without its folder, which
// stands for the scene of the paper where several have it. Returns nothing for an unknown or ambiguous name.
[[nodiscard]] std::optional<std::filesystem::path> scene_of_short_name(const std::string& name,
                                                                       const std::filesystem::path& folder);

}  // namespace wade
