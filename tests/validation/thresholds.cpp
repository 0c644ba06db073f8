#include "thresholds.hpp"

#include <algorithm>

#include "configs/errors/exit_code.hpp"
#include "tests/reasoned_table.hpp"

namespace wade::validation {

namespace {

std::optional<double> threshold_field(const std::string& text, const std::string& place) {
    if (text == "-") {
        return std::nullopt;
    }
    return tables::number(text, place, "a threshold, a number >= 0, \"-\" or, for medium and fine, nothing");
}

}  // namespace

std::vector<Threshold> read_thresholds(const std::filesystem::path& file) {
    std::vector<Threshold> all;
    for (const tables::Row& row : tables::read(file, "case,metric,coarse,medium,fine,reason")) {
        Threshold threshold{row.fields[0], row.fields[1], {}, row.reason};
        for (std::size_t level = 0; level < 3; ++level) {
            const std::string& text = row.fields[2 + level];
            const bool as_coarser = level > 0 && text.empty();
            threshold.levels[level] = as_coarser ? threshold.levels[level - 1] : threshold_field(text, row.place);
        }
        all.push_back(threshold);
    }
    return all;
}

std::optional<double> threshold_of(const std::vector<Threshold>& all, const std::string& case_name,
                                   const std::string& metric, std::size_t level) {
    const auto row = std::find_if(all.begin(), all.end(),
                                  [&](const Threshold& t) { return t.case_name == case_name && t.metric == metric; });
    return row == all.end() ? std::nullopt : row->levels.at(level);
}

std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file) {
    std::vector<KnownFailure> all;
    for (const tables::Row& row : tables::read(file, "case,metric,level,guard,reason")) {
        const std::string& level = row.fields[2];
        if (std::find(level_names.begin(), level_names.end(), level) == level_names.end()) {
            throw ConfigurationError(row.place + ": level \"" + level + "\"; allowed: coarse, medium, fine.");
        }
        const double guard = tables::number(row.fields[3], row.place, "a guard, a number >= 0");
        all.push_back({row.fields[0], row.fields[1], level, guard, row.reason});
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
