#pragma once
// The contents of a file.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace wade {

// Returns the contents of a plain file of at most `longest` bytes. Throws ConfigurationError with the reason, beginning with
// `context`, and never waits.
[[nodiscard]] std::string read_file(const std::filesystem::path& file, const std::string& context, std::size_t longest);

// The same of a text in UTF-8, without a byte order mark at its beginning; the first byte of value 0 ends the reading with an error.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, const std::string& context,
                                         std::size_t longest = std::size_t{64} << 20);

// Whether a text is UTF-8 (RFC 3629), without overlong forms and surrogates.
[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace wade
