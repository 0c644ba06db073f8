#pragma once
// The block "Wade" of a scene file of SPlisHSPlasH.

#include <cstdint>
#include <string>
#include <string_view>

#include "tools/splishsplash/model_units.hpp"

namespace wade::splishsplash {

struct SceneSettings {
    std::string session = "splishsplash";
    ModelUnits units;         // frame_rate is none of this block
    std::uint32_t depth = 1;  // frames the simulation may be ahead, 1 .. 63
    double attach_timeout_s = 60;
    double step_timeout_s = 60;  // 0 = never
};

// Reads the block as JSON text; empty or "null" gives the defaults.
// Errors: std::invalid_argument that names the key, its value and what is allowed.
[[nodiscard]] SceneSettings read_settings(std::string_view block);

}  // namespace wade::splishsplash
