#pragma once
// Many crowds for one water: a scene, and what each crowd changes in it.
//
//   [
//     { "name": "s05-seed1" },
//     { "name": "weak-seed3", "set": { "/seed": 3, "/crowd/tau": 0.5, "/coupling/contact_rule": "sum" },
//       "pictures": false }
//   ]
//
// Comments are allowed. A key of "set" is a JSON pointer, its value that of the scene there, as with --set; they are
// set in their written order. "pictures": whether files for pictures alone are stored, trajectories.sqlite and
// water.bin, as far as the options ask for them; true if it is absent.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "configs/loading/scene_loader.hpp"

namespace wade::crowd {

struct ListedCrowd {
    std::string name;  // also of its run folder: letters, digits, '_', '-' and '.', not like an option ("-x") or a file
                       // ("x.csv"), and one of its own for each crowd in any mixture of capital and small letters
    LoadedScene loaded;  // the scene with what this crowd sets
    bool pictures = true;
};

// Reads the list. A crowd may change /seed, /name, /description, /events and what lies below /crowd and /coupling,
// except the agents stream. All else belongs to the water and must stay as it is in the scene.
//   water      the scene of the fluid server, which the crowds start from: `scene_file` with `overrides`
// The seed of a crowd does not reach the water: a kinematic stream keeps that of the scene.
// Throws ConfigurationError that names the list, the crowd, the key, the value and what is allowed.
[[nodiscard]] std::vector<ListedCrowd> load_crowds(const std::filesystem::path& list,
                                                   const std::filesystem::path& scene_file,
                                                   const std::vector<SceneOverride>& overrides,
                                                   const LoadedScene& water);

// The same for a text that is not in a file; `list` is named in errors.
[[nodiscard]] std::vector<ListedCrowd> load_crowds_text(std::string_view text, const std::filesystem::path& list,
                                                        const std::filesystem::path& scene_file,
                                                        const std::vector<SceneOverride>& overrides,
                                                        const LoadedScene& water);

}  // namespace wade::crowd
