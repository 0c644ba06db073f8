#include "tests/reasoned_table.hpp"

#include <algorithm>
#include <fstream>

#include "configs/errors/exit_code.hpp"

namespace wade::tables {

std::vector<Row> read(const std::filesystem::path& file, const std::string& columns) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line)) {
        throw ConfigurationError("cannot read the table " + file.string() + ".");
    }
    if (line != columns) {
        throw ConfigurationError(file.string() + ", line 1: \"" + line + "\"; allowed: " + columns + ".");
    }
    const auto words = static_cast<std::size_t>(std::count(columns.begin(), columns.end(), ','));
    std::vector<Row> rows;
    for (int number = 2; std::getline(in, line); ++number) {
        if (line.empty()) {
            continue;
        }
        Row row;
        row.place = file.string() + ", line " + std::to_string(number);
        std::size_t begin = 0;
        for (std::size_t comma = line.find(','); row.fields.size() < words && comma != std::string::npos;
             comma = line.find(',', begin)) {
            row.fields.push_back(line.substr(begin, comma - begin));
            begin = comma + 1;
        }
        row.reason = line.substr(begin);
        if (row.fields.size() < words || row.reason.empty()) {
            throw ConfigurationError(row.place + ": \"" + line + "\" is not " + columns + "; each row needs a reason.");
        }
        rows.push_back(row);
    }
    return rows;
}

double number(const std::string& text, const std::string& place, const std::string& allowed) {
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

}  // namespace wade::tables
