#include "configs/files/text_file.hpp"

#include <array>
#include <cstring>
#include <string_view>

#include "configs/errors/exit_code.hpp"
#include "configs/files/plain_file.hpp"

namespace wade {

namespace {

std::string read(const std::filesystem::path& file, const std::string& context, std::size_t longest, bool is_text) {
    const auto fail = [&context](const std::string& reason) -> void {
        throw ConfigurationError(context + " cannot be read: " + reason + ".");
    };
    const PlainFile plain(file);
    if (!plain.is_open()) fail(plain.problem());
    const std::string too_long = "it is longer than " + std::to_string(longest >> 20) + " MiB";
    if (plain.bytes() > longest) fail(too_long);
    std::string text;
    std::array<char, 1 << 16> piece;
    while (const std::size_t got = plain.read(text.size(), piece.data(), piece.size())) {
        if (is_text && std::memchr(piece.data(), 0, got) != nullptr) {
            fail("it is no text in UTF-8, as it holds bytes of value 0. Remedy: save it as text in UTF-8");
        }
        text.append(piece.data(), got);
        if (text.size() > longest) fail(too_long);
    }
    return text;
}

}  // namespace

bool is_utf8(std::string_view text) {
    const auto byte = [&](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U; };
    for (std::size_t at = 0; at < text.size();) {
        const unsigned lead = byte(at);
        const std::size_t more = lead < 0x80   ? 0
                                 : lead < 0xC2 ? 4
                                 : lead < 0xE0 ? 1
                                 : lead < 0xF0 ? 2
                                 : lead < 0xF5 ? 3
                                               : 4;
        if (more > 3) return false;
        const unsigned lowest = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
        const unsigned highest = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
        for (std::size_t k = 1; k <= more; ++k) {
            const unsigned next = byte(at + k);
            if (next < (k == 1 ? lowest : 0x80) || next > (k == 1 ? highest : 0xBF)) return false;
        }
        at += 1 + more;
    }
    return true;
}

std::string read_file(const std::filesystem::path& file, const std::string& context, std::size_t longest) {
    return read(file, context, longest, false);
}

std::string read_text_file(const std::filesystem::path& file, const std::string& context, std::size_t longest) {
    std::string text = read(file, context, longest, true);
    // Spreadsheets and Windows begin a text in UTF-8 with a mark.
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (text.starts_with(mark)) text.erase(0, mark.size());
    return text;
}

}  // namespace wade
