#pragma once
// How dangerous water is to people on foot, by its depth times its speed.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace wade::crowd {

// Table 2 of Schaffer et al. (2020), after Viseu (2006); lower bounds of depth times speed, inclusive, m2/s:
//   low 0   moderate 0.5   high 0.75   very_high 1
// none stands for a place without water, which the table does not have.
enum class DangerLevel : std::uint8_t { none, low, moderate, high, very_high };
constexpr std::size_t danger_levels = 5;
constexpr std::array<double, danger_levels> danger_bounds{0, 0, 0.5, 0.75, 1};

// depth: m, not negative; depth_speed: depth times speed, m2/s.
[[nodiscard]] DangerLevel danger_level(double depth, double depth_speed);

// The name as it is written to files.
[[nodiscard]] std::string_view danger_name(DangerLevel level);

}  // namespace wade::crowd
