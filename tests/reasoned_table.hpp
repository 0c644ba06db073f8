#pragma once
// The tables that people write by hand beside the validation and the stability suite: a line of names, then rows of a few
// words or numbers and a reason, which is the rest of the line and may hold commas.

#include <filesystem>
#include <string>
#include <vector>

namespace wade::tables {

struct Row {
    std::vector<std::string> fields;  // in the order of the columns, without the reason
    std::string reason;               // never empty
    std::string place;                // file and line, for messages
};

// columns: the names that the first line must hold, the last of them for the reason. Throws ConfigurationError with file,
// line and value.
[[nodiscard]] std::vector<Row> read(const std::filesystem::path& file, const std::string& columns);

// A number >= 0 and nothing else. Throws ConfigurationError; allowed: what the message says may stand there.
[[nodiscard]] double number(const std::string& text, const std::string& place, const std::string& allowed);

}  // namespace wade::tables
