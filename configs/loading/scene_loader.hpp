#pragma once
// The one loader of scene files, used by both programs.
//
//   file -> parse (comments allowed) -> check against the keys -> merge with what it extends -> overrides
//        -> typed Scene with its defaults -> checks that need several values at once
//
// Every error is a ConfigurationError with a line for each mistake that names the file (or the option), the JSON pointer,
// the value and what would be allowed. Mistakes of one of these steps are reported together.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "configs/loading/scene_override.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade {

struct LoadedScene {
    Scene scene;
    // The resolved scene: every default explicit, keys sorted, nothing extended. Loading it again gives the same hash.
    std::string canonical_json;
    // Sentences for the user on keys that other values of the scene leave without effect.
    std::vector<std::string> warnings;
};

// Reads a scene file and those that it extends.
[[nodiscard]] LoadedScene load_scene(const std::filesystem::path& file,
                                     const std::vector<SceneOverride>& overrides = {});

// The same for a text that is not in a file; `file` is named in errors and `extends` is relative to its folder.
[[nodiscard]] LoadedScene load_scene_text(std::string_view text, const std::filesystem::path& file,
                                          const std::vector<SceneOverride>& overrides = {});

// 16 lower-case hexadecimal digits, as file names and logs show a scene hash.
[[nodiscard]] std::string hash_text(std::uint64_t hash);

}  // namespace wade
