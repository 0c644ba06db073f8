#include "configs/files/series_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/files/text_file.hpp"

namespace wade {

namespace {

std::string_view stripped(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\"");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\"") - first + 1);
}

std::vector<std::string_view> columns_of(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        cells.push_back(stripped(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    return cells;
}

std::string short_text(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

// Returns true for the numbers by which tables of gauges and rasters mark missing data.
bool is_no_data(double value) {
    constexpr std::array marks{-99.0,   -99.9,   -99.99,   -999.0,   -999.9,   -999.99,
                               -9999.0, -9999.9, -9999.99, -99999.0, -32767.0, -32768.0};
    return std::find(marks.begin(), marks.end(), value) != marks.end();
}

class SeriesTable {
 public:
    SeriesTable(const std::string& name, const std::string& column, double least, double most)
        : name_(name), column_(column), least_(least), most_(most) {}

    Series read(std::string_view text) {
        while (!text.empty()) {
            const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
            const std::string_view line = stripped(text.substr(0, end));
            const bool pair = end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n';
            text.remove_prefix(std::min(end + (pair ? 2 : 1), text.size()));
            ++line_;
            if (!line.empty() && line.front() != '#') take(columns_of(line));
        }
        if (series_.empty())
            fail("there are no rows; allowed: a line of names, time_s and " + column_ + ", then one a time.");
        return series_;
    }

 private:
    [[noreturn]] void fail(const std::string& sentence) const { throw ConfigurationError(name_ + ": " + sentence); }
    [[noreturn]] void fail_here(const std::string& sentence) const {
        fail("line " + std::to_string(line_) + ": " + sentence);
    }

    void take(const std::vector<std::string_view>& cells) {
        if (width_ == 0) {
            find_columns(cells);
            return;
        }
        if (cells.size() != width_)
            fail_here(std::to_string(cells.size()) + " values; allowed: " + std::to_string(width_) + ", one a column.");
        const double time = number(cells[time_], "time_s"), value = number(cells[value_], column_);
        if (!series_.empty() && time < series_.back().time)
            fail_here("time_s goes back from " + short_text(series_.back().time) + " to " + short_text(time) +
                      " s. Remedy: sort the rows by time.");
        if (is_no_data(value))
            fail_here(column_ + " is " + short_text(value) +
                      ", a mark of missing data (no data); allowed: measured values. Remedy: delete the row; values "
                      "are straight between rows.");
        if (value < least_ || value > most_)
            fail_here(
                column_ + " is " + short_text(value) + "; allowed: " +
                (std::isfinite(most_) ? short_text(least_) + " to " + short_text(most_) : ">= " + short_text(least_)) +
                ".");
        series_.push_back({time, value});
    }

    void find_columns(const std::vector<std::string_view>& names) {
        width_ = names.size();
        const auto at = [&](std::string_view name) {
            return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        };
        time_ = at("time_s");
        value_ = at(column_);
        // Any other name of the second of two, such as q, unless it ends in a unit of its own.
        if (time_ < width_ && width_ == 2 && names[1 - time_].find('_') == names[0].npos) value_ = 1 - time_;
        if (time_ < width_ && value_ < width_) return;
        std::string found;
        for (const std::string_view name : names)
            found += (found.empty() ? "" : ", ") + std::string(name.substr(0, 40));
        fail_here("its columns are " + found + "; allowed: a first line that names time_s and " + column_ +
                  ", with commas between columns.");
    }

    [[nodiscard]] double number(std::string_view cell, const std::string& what) const {
        double value = 0;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value)) return value;
        fail_here(what + " is \"" + std::string(cell.substr(0, 40)) + "\"; allowed: a number with a decimal point.");
    }

    const std::string& name_;
    const std::string& column_;
    double least_, most_;
    Series series_;
    std::size_t line_ = 0, width_ = 0, time_ = 0, value_ = 0;
};

}  // namespace

Series parse_series(std::string_view text, const std::string& name, const std::string& column, double least,
                    double most) {
    return SeriesTable(name, column, least, most).read(text);
}

Series read_series(const std::filesystem::path& file, const std::string& column, double least, double most) {
    return parse_series(read_text_file(file, "the file " + file.string()), file.string(), column, least, most);
}

}  // namespace wade
