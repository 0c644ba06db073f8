#pragma once
// How dangerous water is by its depth h, m, and speed v, m/s: three scales that engineers use.

#include <array>
#include <cstddef>
#include <cstdint>

namespace wade {

// To people on foot, by h v: Table 2 of Schaffer et al. (2020), after Viseu (2006); lower bounds, inclusive, m2/s:
//   low 0   moderate 0.5   high 0.75   very_high 1
// none stands for a site without water, which the table does not have.
enum class DangerLevel : std::uint8_t { none, low, moderate, high, very_high };
inline constexpr std::size_t danger_levels = 5;
inline constexpr std::array<double, danger_levels> danger_bounds{0, 0, 0.5, 0.75, 1};

// depth: m, not negative; depth_speed: h v, m2/s.
[[nodiscard]] constexpr DangerLevel danger_level(double depth, double depth_speed) {
    if (!(depth > 0)) return DangerLevel::none;
    auto level = static_cast<std::size_t>(DangerLevel::low);
    while (level + 1 < danger_levels && depth_speed >= danger_bounds[level + 1]) ++level;
    return static_cast<DangerLevel>(level);
}

// Combined hazard class H1 to H6 of Australian Rainfall and Runoff (Ball et al. 2019, book 6, table 6.7.4; Smith, Davey
// and Cox 2014): the first class with h v, h and v all within its upper bounds. 0: no water. A guideline; for small
// children, height times mass up to 25 m kg, no h v is safe (Cox, Shand and Blacka 2010).
struct HazardClass {
    double depth_speed, depth, speed;  // m2/s, m, m/s
};
inline constexpr std::array<HazardClass, 5> hazard_classes{
    {{0.3, 0.3, 2}, {0.6, 0.5, 2}, {0.6, 1.2, 2}, {1, 2, 2}, {4, 4, 4}}};

[[nodiscard]] constexpr int hazard_class(double depth, double speed) {
    if (!(depth > 0)) return 0;
    int number = 1;
    for (const HazardClass& bounds : hazard_classes) {
        if (depth * speed <= bounds.depth_speed && depth <= bounds.depth && speed <= bounds.speed) return number;
        ++number;
    }
    return number;
}

// Hazard rating of Defra and the Environment Agency (FD2321/TR1, 2006, eq. 3.1 and table 3.1): h (v + 0.5) + DF with the debris
// factor of towns, 0 up to 0.25 m of water that is no faster than 2 m/s, else 1. Danger for some from 0.75, for most from 1.25,
// for all from 2.
[[nodiscard]] constexpr double hazard_rating(double depth, double speed) {
    if (!(depth > 0)) return 0;
    const double debris = depth > 0.25 || speed > 2 ? 1 : 0;
    return depth * (speed + 0.5) + debris;
}

}  // namespace wade
