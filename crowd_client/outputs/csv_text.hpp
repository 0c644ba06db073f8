#pragma once
// Numbers as text for tables: as many digits as it takes to read back the same bits, whatever the locale.

#include <charconv>
#include <iterator>
#include <string>

namespace wade::crowd {

[[nodiscard]] inline std::string csv_number(double v) {
    char buffer[32];
    const auto end = std::to_chars(std::begin(buffer), std::end(buffer), v).ptr;
    return {buffer, end};
}

}  // namespace wade::crowd
