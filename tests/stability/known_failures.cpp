#include "known_failures.hpp"

#include <algorithm>

#include "tests/reasoned_table.hpp"

namespace wade::stability {

std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file) {
    std::vector<KnownFailure> all;
    for (const tables::Row& row : tables::read(file, "case,setting,rule,guard,reason")) {
        const double guard = tables::number(row.fields[3], row.place, "a guard, a number >= 0");
        all.push_back({row.fields[0], row.fields[1], row.fields[2], guard, row.reason});
    }
    return all;
}

bool is_known(const std::vector<KnownFailure>& all, const std::string& name, const std::string& setting,
              const Check& check) {
    return std::any_of(all.begin(), all.end(), [&](const KnownFailure& f) {
        return f.name == name && (f.setting == "*" || f.setting == setting) && f.rule == check.name &&
               check.holds(f.guard);
    });
}

}  // namespace wade::stability
