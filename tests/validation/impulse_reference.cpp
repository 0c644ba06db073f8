// Reads the finest runs that `tools/wade speed-vs-error --reference CASE --spacing D` has stored.

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "configs/errors/exit_code.hpp"
#include "impulse.hpp"

namespace wade::validation {

namespace {

// The rows of a CSV of numbers; lines that begin with '#' and the line of column names are skipped.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& file, std::size_t columns) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error("cannot read " + file.string());
    std::vector<std::vector<double>> rows;
    std::string line;
    bool names_read = false;
    for (int number = 1; std::getline(in, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        if (!names_read) {
            names_read = true;
            continue;
        }
        std::vector<double> row;
        std::istringstream fields(line);
        std::string field;
        while (std::getline(fields, field, ',')) {
            std::size_t used = 0;
            try {
                row.push_back(std::stod(field, &used));
            } catch (const std::exception&) {
                used = 0;
            }
            if (used != field.size() || field.empty()) {
                throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": '" + field +
                                         "' is not a number");
            }
        }
        if (row.size() != columns) {
            throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": " + std::to_string(row.size()) +
                                     " values, expected " + std::to_string(columns));
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace

ImpulseRun read_reference(const Request& request, const std::string& name) {
    ImpulseRun run;
    if (!request.compares_with_finest_run) return run;
    const std::filesystem::path folder = std::filesystem::path(WADE_VALIDATION) / "data";
    const std::filesystem::path standing = folder / (name + "_standing.csv");
    const std::filesystem::path walking = folder / (name + "_walking.csv");
    for (const std::filesystem::path& file : {standing, walking}) {
        if (std::filesystem::exists(file)) continue;
        throw ConfigurationError("the reference " + file.string() + " of the case " + name +
                                 " is missing: make it with tools/wade speed-vs-error --reference " + name +
                                 " --spacing D, or give --no-reference to run without a comparison");
    }
    for (const std::vector<double>& row : read_rows(standing, 4)) {
        run.standing.push_back({static_cast<std::uint32_t>(row[0]), {row[1], row[2]}, row[3]});
    }
    for (const std::vector<double>& row : read_rows(walking, 5)) {
        run.walking.push_back({static_cast<std::uint32_t>(row[0]),
                               static_cast<crowd::Outcome>(static_cast<int>(row[1])),
                               row[2],
                               {row[3], row[4]}});
    }
    return run;
}

}  // namespace wade::validation
