#pragma once
// The contents of a file.

#include <cstddef>
#include <filesystem>
#include <string>

namespace wade {

// The contents of a plain file of at most `longest` bytes; throws ConfigurationError with the reason, beginning with
// `context`, and never waits.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, const std::string& context,
                                         std::size_t longest = std::size_t{64} << 20);

}  // namespace wade
