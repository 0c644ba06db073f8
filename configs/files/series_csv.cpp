#include "configs/files/series_csv.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "configs/errors/exit_code.hpp"
#include "configs/files/csv_table.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"

namespace wade {

namespace {

// Returns true for the numbers that mark missing data in tables of gauges and in rasters.
bool is_no_data(double value) {
    constexpr std::array marks{-99.0,   -99.9,   -99.99,   -999.0,   -999.9,   -999.99,
                               -9999.0, -9999.9, -9999.99, -99999.0, -32767.0, -32768.0};
    return std::find(marks.begin(), marks.end(), value) != marks.end();
}

double number_in(const CsvTable& table, std::size_t column, const Key& key) {
    const Json value = table.value(column, key);
    if (value.is_null()) table.fail_here(table.columns()[column] + " is empty; allowed: a number.");
    return value.get<double>();
}

}  // namespace

Series parse_series(std::string_view text, const std::string& name, const Key& key) {
    const std::string column(key.name);
    CsvTable table(text, name);
    const std::string rows = "there are no rows; allowed: a line of names, time_s and " + column + ", then one a time.";
    if (table.columns().empty()) table.fail(rows);
    const Key time_key{"time_s", KeyKind::number, "Time.", "s", from(-1e6).to(1e6)};
    table.check_columns({{"time_s", time_key.unit, true}, {column, key.unit, true}});
    const std::size_t time_column = table.column("time_s"), value_column = table.column(column);
    Series series;
    std::string last;
    while (table.next()) {
        if (is_no_data(std::atof(table.cell(value_column).c_str())))
            table.fail_here(table.columns()[value_column] + " is " + table.cell(value_column) +
                            ", a mark of missing data (no data); allowed: measured values. Remedy: delete the row; "
                            "values are straight between rows.");
        const double time = number_in(table, time_column, time_key), value = number_in(table, value_column, key);
        if (!series.empty() && time < series.back().time)
            table.fail_here("time_s goes back from " + last + " to " + table.cell(time_column) +
                            " s. Remedy: sort the rows by time.");
        series.push_back({time, value});
        last = table.cell(time_column);
    }
    if (series.empty()) table.fail(rows);
    return series;
}

Series read_series(const std::filesystem::path& file, const Key& key) {
    return parse_series(read_text_file(file, "the file " + file.string()), file.string(), key);
}

}  // namespace wade
