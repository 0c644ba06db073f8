#include "known_failures.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "configs/exit_code.hpp"

namespace wade::stability {

std::vector<KnownFailure> read_known_failures(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw ConfigurationError("cannot read the known failures " + file.string());
    std::vector<KnownFailure> all;
    std::string line;
    std::getline(in, line);  // names of the columns
    for (int number = 2; std::getline(in, line); ++number) {
        if (line.empty()) continue;
        std::istringstream fields(line);
        KnownFailure row;
        std::string guard;
        std::getline(fields, row.name, ',');
        std::getline(fields, row.setting, ',');
        std::getline(fields, row.rule, ',');
        std::getline(fields, guard, ',');
        std::getline(fields, row.reason);
        std::istringstream value(guard);
        if (!(value >> row.guard) || row.reason.empty()) {
            throw ConfigurationError(file.string() + " line " + std::to_string(number) + ": '" + line +
                                     "' is not case,setting,rule,guard,reason with a number as guard");
        }
        all.push_back(row);
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
