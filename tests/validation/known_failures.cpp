#include "known_failures.hpp"

#include <algorithm>
#include <fstream>

#include "csv_line.hpp"

namespace wade::validation {

std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) {
        throw ConfigurationError("cannot read the known failures " + file.string() + ".");
    }
    std::vector<KnownFailure> all;
    std::string line;
    std::getline(in, line);  // header
    for (int number = 2; std::getline(in, line); ++number) {
        if (line.empty()) {
            continue;
        }
        const std::string place = file.string() + ", line " + std::to_string(number);
        KnownFailure row;
        row.case_name = next_field(line);
        row.metric = next_field(line);
        row.level = next_field(line);
        if (std::find(level_names.begin(), level_names.end(), row.level) == level_names.end()) {
            throw ConfigurationError(place + ": level \"" + row.level + "\"; allowed: coarse, medium, fine.");
        }
        row.guard = number_field(next_field(line), place, "a guard, a number >= 0");
        row.reason = line;
        if (row.reason.empty()) {
            throw ConfigurationError(place + ": " + row.case_name + "," + row.metric +
                                     " has no reason; each needs one.");
        }
        all.push_back(row);
    }
    return all;
}

std::optional<double> guard_of(const std::vector<KnownFailure>& all, const std::string& case_name,
                               const std::string& metric, std::size_t level) {
    const auto row = std::find_if(all.begin(), all.end(), [&](const KnownFailure& f) {
        return f.case_name == case_name && f.metric == metric && f.level == level_names.at(level);
    });
    return row == all.end() ? std::nullopt : std::optional<double>(row->guard);
}

}  // namespace wade::validation
