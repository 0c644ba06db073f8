#pragma once
// From the keys of a site and the files that they name to a Site.

#include <string>

#include "configs/errors/problems.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// What a scene sets itself, and is not to be taken from its site.
struct SetByScene {
    bool length = false, width = false, model = false, ways_cell = false;
};

// Reads the files that /site of `scene` names. Fills scene.site and a closed channel of the world's extent. Sets the
// extent of the world and the cell size of the travel-time fields where the scene sets none. Notes faults with key,
// file, feature, value and remedy; `source` names the scene.
void read_site(Scene& scene, const SetByScene& set, const std::string& source, Problems& problems);

}  // namespace wade
