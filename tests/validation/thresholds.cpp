#include "thresholds.hpp"

#include <algorithm>
#include <fstream>

#include "csv_line.hpp"

namespace wade::validation {

namespace {

std::optional<double> threshold_field(const std::string& text, const std::string& place) {
    if (text == "-") {
        return std::nullopt;
    }
    return number_field(text, place, "a threshold, a number >= 0, \"-\" or, for medium and fine, nothing");
}

}  // namespace

std::vector<Threshold> read_thresholds(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) {
        throw ConfigurationError("cannot read the thresholds " + file.string());
    }
    std::vector<Threshold> all;
    std::string line;
    std::getline(in, line);  // header
    for (int number = 2; std::getline(in, line); ++number) {
        if (line.empty()) {
            continue;
        }
        const std::string place = file.string() + ", line " + std::to_string(number);
        Threshold row;
        row.case_name = next_field(line);
        row.metric = next_field(line);
        row.levels[0] = threshold_field(next_field(line), place);
        for (std::size_t level = 1; level < 3; ++level) {
            const std::string text = next_field(line);
            row.levels[level] = text.empty() ? row.levels[level - 1] : threshold_field(text, place);
        }
        row.reason = line;
        if (row.reason.empty()) {
            throw ConfigurationError(place + ": " + row.case_name + "," + row.metric +
                                     " has no reason; each threshold needs one.");
        }
        all.push_back(row);
    }
    return all;
}

std::optional<double> threshold_of(const std::vector<Threshold>& all, const std::string& case_name,
                                   const std::string& metric, std::size_t level) {
    const auto row = std::find_if(all.begin(), all.end(),
                                  [&](const Threshold& t) { return t.case_name == case_name && t.metric == metric; });
    return row == all.end() ? std::nullopt : row->levels.at(level);
}

}  // namespace wade::validation
