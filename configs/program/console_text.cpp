#include "configs/program/console_text.hpp"

#include <array>
#include <cstdio>
#include <sstream>

namespace wade {

namespace {

bool continues(char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0u) == 0x80u;
}

// Bytes of the UTF-8 character at the begin of `text`; 0 if there is none, or one for the terminal itself (C1).
std::size_t character_at(const std::string& text, std::size_t at) {
    const auto first = static_cast<unsigned char>(text[at]);
    const std::size_t length = first < 0x80u ? 1 : first >= 0xF0u ? 4 : first >= 0xE0u ? 3 : 2;
    if ((first >= 0x80u && first < 0xC2u) || first > 0xF4u || at + length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if (!continues(text[at + i])) return 0;
    }
    const bool c1 = first == 0xC2u && static_cast<unsigned char>(text[at + 1]) < 0xA0u;
    return c1 ? 0 : length;
}

// Index of the byte behind the first `columns` characters.
std::size_t end_of(const std::string& text, std::size_t columns) {
    std::size_t at = 0;
    for (; at < text.size(); ++at) {
        if (continues(text[at])) continue;
        if (columns == 0) break;
        --columns;
    }
    return at;
}

std::string wrapped_line(std::string line, std::size_t indent, std::size_t columns) {
    std::string text;
    while (columns_of(line) > columns) {
        const std::size_t end = end_of(line, columns);
        std::size_t space = line.rfind(' ', end);
        // A line does not break at a space within the indent or one that leaves the line nearly empty.
        const bool early = space == std::string::npos || space < line.find_first_not_of(' ') + columns / 4;
        if (early) space = end;
        text += line.substr(0, space) + "\n";
        const std::size_t next = line.find_first_not_of(' ', space);
        line = next == std::string::npos ? "" : std::string(indent, ' ') + line.substr(next);
    }
    return text + line;
}

}  // namespace

std::size_t columns_of(const std::string& text) {
    std::size_t columns = 0;
    for (const char byte : text) columns += continues(byte) ? 0U : 1U;
    return columns;
}

std::string harmless(const std::string& text) {
    std::string safe;
    for (std::size_t at = 0; at < text.size();) {
        const auto byte = static_cast<unsigned char>(text[at]);
        const std::size_t length = character_at(text, at);
        if (length > 0 && (length > 1 || text[at] == '\n' || (byte >= 0x20u && byte != 0x7Fu))) {
            safe.append(text, at, length);
            at += length;
        } else {
            std::array<char, 8> code{};
            std::snprintf(code.data(), code.size(), "\\x%02x", static_cast<unsigned>(byte));
            safe += code.data();
            ++at;
        }
    }
    return safe;
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns) {
    std::istringstream lines(text);
    std::string all;
    bool first = true;
    for (std::string line; std::getline(lines, line);) {
        if (!first) all += '\n';
        first = false;
        all += wrapped_line(line, indent, columns);
    }
    if (!text.empty() && text.back() == '\n') all += '\n';
    return all;
}

std::string shortened(const std::string& line, std::size_t columns) {
    if (columns_of(line) <= columns) return line;
    return line.substr(0, end_of(line, columns - 3)) + "...";
}

}  // namespace wade
