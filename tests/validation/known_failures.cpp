#include "known_failures.hpp"

#include <algorithm>

#include "configs/errors/exit_code.hpp"
#include "tests/reasoned_table.hpp"

namespace wade::validation {

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
