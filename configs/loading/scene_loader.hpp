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

#include "configs/scene/scene.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade {

struct LoadedScene {
    Scene scene;
    // The resolved scene: every default explicit, keys sorted, nothing extended. Loading it again gives the same hash.
    std::string canonical_json;
};

// One value set from outside the scene file, applied after the merge.
struct SceneOverride {
    std::string pointer;  // JSON pointer of a key that the schema knows, for example "/crowd/groups/0/tau"
    std::string value;    // JSON, or else a plain string
    std::string source;   // named in errors, for example "--set /seed=7"
};

// Splits "/json/pointer=value"; throws ConfigurationError if that is not its form.
[[nodiscard]] SceneOverride parse_override(const std::string& assignment);

// Reads a scene file and those that it extends.
[[nodiscard]] LoadedScene load_scene(const std::filesystem::path& file,
                                     const std::vector<SceneOverride>& overrides = {});

// The same for a text that is not in a file; `file` is named in errors and `extends` is relative to its folder.
[[nodiscard]] LoadedScene load_scene_text(std::string_view text, const std::filesystem::path& file,
                                          const std::vector<SceneOverride>& overrides = {});

// 16 lower-case hexadecimal digits, as file names and logs show a scene hash.
[[nodiscard]] std::string hash_text(std::uint64_t hash);

}  // namespace wade
