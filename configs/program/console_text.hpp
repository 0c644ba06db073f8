#pragma once
// Text as people read it on a terminal: lines of at most 100 columns, and no byte that would do something to the terminal.

#include <cstddef>
#include <string>

namespace wade {

inline constexpr std::size_t console_columns = 100;

// Columns that a UTF-8 text takes, one a character.
[[nodiscard]] std::size_t columns_of(const std::string& text);

// Control characters and what is no UTF-8 as \x1b, so that text of strangers changes nothing but its line. '\n' stays.
[[nodiscard]] std::string harmless(const std::string& text);

// Each line of `text` broken at spaces where it would be longer than `columns`; what follows a break is indented by
// `indent` columns. A word that fits no line is broken where the line ends.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t indent = 2,
                                  std::size_t columns = console_columns);

// One line, cut with "..." at its end if it is longer.
[[nodiscard]] std::string shortened(const std::string& line, std::size_t columns = console_columns);

}  // namespace wade
