#include "fluid_server/model_choice/table.hpp"

#include <array>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace wade::fluid::model_choice {

namespace {

constexpr std::array<std::string_view, water_kinds> names{"river", "dry_front", "wet_front", "inflow", "lee"};
constexpr std::string_view header =
    "kind,model,spacing_m,tolerance,divergence_tolerance,cfl,kernel,impulse_median,impulse_p95,steps_per_s,"
    "us_per_particle_step,wave_speed_m_s";
constexpr std::size_t columns = 12;

[[noreturn]] void refuse_line(std::size_t number, const std::string& why) {
    throw std::runtime_error("table of the choice of the model, line " + std::to_string(number) + ": " + why);
}

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields{""};
    for (const char c : line) {
        if (c == ',') {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

double number_of(const std::string& field, std::size_t line) {
    std::size_t used = 0;
    double value = -1;
    try {
        value = std::stod(field, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (used != field.size() || field.empty() || !(value >= 0)) {
        refuse_line(line, "'" + field + "' is not a number from 0 on");
    }
    return value;
}

WaterKind kind_named(const std::string& name, std::size_t line) {
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (names[k] == name) return static_cast<WaterKind>(k);
    }
    refuse_line(line, "'" + name + "' is no kind of water");
}

}  // namespace

std::string_view name_of(WaterKind kind) {
    return names.at(static_cast<std::size_t>(kind));
}

std::vector<TableRow> parse_table(std::string_view text) {
    std::vector<TableRow> rows;
    std::istringstream in{std::string(text)};
    bool header_read = false;
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        if (!std::exchange(header_read, true)) {
            if (line != header) refuse_line(number, "the columns are not " + std::string(header));
            continue;
        }
        const std::vector<std::string> f = fields_of(line);
        if (f.size() != columns) refuse_line(number, std::to_string(f.size()) + " values, expected 12");
        const auto value = [&](std::size_t k) { return number_of(f[k], number); };
        rows.push_back({kind_named(f[0], number),
                        {f[1], value(2), f[3], f[4], f[5], f[6]},
                        value(7),
                        value(8),
                        value(9),
                        1e-6 * value(10),
                        value(11)});
    }
    return rows;
}

const std::vector<TableRow>& measured_table() {
    static const std::vector<TableRow> rows = parse_table(measured_table_text());
    return rows;
}

}  // namespace wade::fluid::model_choice
