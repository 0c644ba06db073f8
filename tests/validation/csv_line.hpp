#pragma once
// One line of a table that people write by hand.

#include <string>

#include "configs/exit_code.hpp"

namespace wade::validation {

// Cuts the text before the next comma off the line.
inline std::string next_field(std::string& line) {
    const std::size_t comma = line.find(',');
    std::string field = line.substr(0, comma);
    line = comma == std::string::npos ? "" : line.substr(comma + 1);
    return field;
}

// A number >= 0. Throws ConfigurationError; place: file and line.
inline double number_field(const std::string& text, const std::string& place, const std::string& allowed) {
    std::size_t end = 0;
    double value = -1;
    try {
        value = std::stod(text, &end);
    } catch (const std::exception&) {
    }
    if (value >= 0 && end == text.size()) {
        return value;
    }
    throw ConfigurationError(place + ": \"" + text + "\"; allowed: " + allowed + ".");
}

}  // namespace wade::validation
