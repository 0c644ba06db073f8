#include "shm_protocol/inside/bytes/text.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace wade::shm {
namespace {

constexpr bool continues(char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

// What the bytes at the start of a text stand for.
struct Character {
    std::size_t bytes = 0;  // 0 = not the UTF-8 of a character (RFC 3629)
    std::uint32_t code = 0;
};

Character first_character(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text[0]);
    if (lead < 0x80) return {1, lead};
    const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
    std::uint32_t code = lead & (0x7FU >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if (!continues(text[i])) return {};
        code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3FU);
    }
    const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
    const bool surrogate = code >= 0xD800 && code < 0xE000;
    return overlong || surrogate || code > 0x10FFFF ? Character{} : Character{bytes, code};
}

constexpr bool is_harmless(std::uint32_t code) {
    const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
    const bool invisible = (code >= 0x200B && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
                           (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF;
    return !control && !invisible;
}

}  // namespace

std::string printable(const char* text, std::size_t bytes) {
    std::string_view rest(text, std::find(text, text + bytes, '\0'));
    std::string clean;
    while (!rest.empty()) {
        const Character c = first_character(rest);
        const std::size_t taken = std::max<std::size_t>(c.bytes, 1);
        if (c.bytes > 0 && is_harmless(c.code))
            clean += rest.substr(0, taken);
        else
            clean += '?';
        rest.remove_prefix(taken);
    }
    return clean;
}

void store_text(char* field, std::size_t bytes, std::string_view text) {
    std::size_t length = std::min(text.size(), bytes - 1);
    for (int i = 0; i < 3 && length > 0 && length < text.size() && continues(text[length]); ++i) --length;
    std::memset(field, 0, bytes);
    std::memcpy(field, text.data(), length);
}

}  // namespace wade::shm
