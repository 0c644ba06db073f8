#include "configs/files/text_file.hpp"

#include <array>
#include <string_view>

#include "configs/errors/exit_code.hpp"
#include "configs/files/plain_file.hpp"

namespace wade {

std::string read_text_file(const std::filesystem::path& file, const std::string& context, std::size_t longest) {
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
        text.append(piece.data(), got);
        if (text.size() > longest) fail(too_long);
    }
    // Spreadsheets and Windows begin a text in UTF-8 with a mark.
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (text.starts_with(mark)) text.erase(0, mark.size());
    return text;
}

}  // namespace wade
