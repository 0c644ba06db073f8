#include "crowd_client/outputs/writers/danger_level.hpp"

namespace wade::crowd {

DangerLevel danger_level(double depth, double depth_speed) {
    if (!(depth > 0)) return DangerLevel::none;
    auto level = static_cast<std::size_t>(DangerLevel::low);
    while (level + 1 < danger_levels && depth_speed >= danger_bounds[level + 1]) ++level;
    return static_cast<DangerLevel>(level);
}

std::string_view danger_name(DangerLevel level) {
    constexpr std::array<std::string_view, danger_levels> names{"none", "low", "moderate", "high", "very_high"};
    return names[static_cast<std::size_t>(level)];
}

}  // namespace wade::crowd
