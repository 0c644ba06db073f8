#include "configs/files/csv_table.hpp"

#include <algorithm>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

std::string_view without_blanks(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

CsvTable::CsvTable(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {
    if (text_.find('\0') != std::string_view::npos || !is_utf8(text_))
        fail("it is no text in UTF-8. Remedy: save it as csv in UTF-8.");
    if (!read_row()) return;
    for (const auto& [separator, word] : {std::pair{';', "semicolons"}, std::pair{'\t', "tabs"}}) {
        if (cells_.size() == 1 && cells_[0].find(separator) != std::string::npos)
            fail_here(std::string("its columns stand between ") + word +
                      "; allowed: commas between columns, and points in numbers. Remedy: save it as csv with commas.");
    }
    columns_ = cells_;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        if (column(columns_[i]) < i) fail_here("the column \"" + columns_[i] + "\" stands twice; allowed: once.");
    }
}

std::size_t CsvTable::column(std::string_view name) const {
    return static_cast<std::size_t>(std::find(columns_.begin(), columns_.end(), name) - columns_.begin());
}

void CsvTable::check_columns(const std::vector<CsvColumn>& known) const {
    std::string allowed;
    for (const CsvColumn& one : known)
        allowed +=
            (allowed.empty() ? "" : ", ") + one.name + (one.unit.empty() ? "" : " [" + std::string(one.unit) + "]");
    const auto is_number = [](const std::string& name) {
        return name.find_first_not_of("0123456789+-.eE") == std::string::npos;
    };
    if (std::ranges::all_of(columns_, is_number))
        fail_here("it has no names of columns; allowed: a first line of names, which tell the units: " + allowed + ".");
    for (const std::string& name : columns_) {
        if (std::ranges::any_of(known, [&](const CsvColumn& one) { return one.name == name; })) continue;
        fail_here("there is no column \"" + name.substr(0, 40) + "\"; allowed: " + allowed +
                  ". Remedy: bring the values into these units, name the columns so, and take out others.");
    }
    for (const CsvColumn& one : known) {
        if (one.needed && column(one.name) == columns_.size())
            fail_here("the column " + one.name + " is missing; allowed: " + allowed + ".");
    }
}

bool CsvTable::next() {
    if (!read_row()) return false;
    if (++rows_ > max_rows) fail("it has more rows than " + std::to_string(max_rows) + "; allowed: up to as many.");
    if (cells_.size() != columns_.size())
        fail_here(std::to_string(cells_.size()) + " values; allowed: " + std::to_string(columns_.size()) +
                  ", one a column. A comma within a cell needs quotes, a number a decimal point.");
    return true;
}

Json CsvTable::value(std::size_t column, const Key& key) const {
    if (cells_[column].empty()) return {};
    Json value = value_of_cell(cells_[column], key);
    if (const std::string fault = fault_in_file(value, key); !fault.empty()) fail_here(columns_[column] + ": " + fault);
    return value;
}

void CsvTable::fail(const std::string& sentence) const {
    throw ConfigurationError(name_ + ": " + sentence);
}

void CsvTable::fail_here(const std::string& sentence) const {
    throw ConfigurationError(here() + ": " + sentence);
}

bool CsvTable::at_line_end() const {
    return at_ == text_.size() || text_[at_] == '\n' || text_[at_] == '\r';
}

void CsvTable::skip_line_end() {
    if (at_ == text_.size()) return;
    const bool pair = text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n';
    at_ += pair ? 2 : 1;
    ++line_;
}

bool CsvTable::read_row() {
    while (at_ < text_.size()) {
        const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
        const std::string_view line = without_blanks(text_.substr(at_, end - at_));
        if (!line.empty() && line.front() != '#') break;
        at_ = end;
        skip_line_end();
    }
    row_line_ = line_;
    if (at_ == text_.size()) return false;
    cells_.clear();
    while (true) {
        if (cells_.size() == max_columns)
            fail_here("it has more columns than " + std::to_string(max_columns) + "; allowed: up to as many.");
        cells_.push_back(read_cell());
        if (at_line_end()) break;
        ++at_;  // the comma
    }
    skip_line_end();
    return true;
}

// Up to the comma or the end of the line.
std::string CsvTable::read_cell() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    if (at_ < text_.size() && text_[at_] == '"') return quoted_cell();
    const std::size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
    const std::string_view cell = without_blanks(text_.substr(at_, end - at_));
    if (cell.find('"') != std::string_view::npos)
        fail_here("a quote stands within the cell " + std::string(cell.substr(0, 40)) +
                  "; allowed: quotes round the whole cell, and doubled ones in it.");
    at_ = end;
    return std::string(cell);
}

std::string CsvTable::quoted_cell() {
    std::string cell;
    while (true) {
        const std::size_t quote = text_.find('"', at_ + 1);
        if (quote == std::string_view::npos) fail_here("a quote is not closed: the file is cut short.");
        const std::string_view part = text_.substr(at_ + 1, quote - at_ - 1);
        line_ += static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n'));
        cell += part;
        at_ = quote + 1;
        if (at_ == text_.size() || text_[at_] != '"') break;
        cell += '"';
    }
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    if (!at_line_end() && text_[at_] != ',')
        fail_here("there is text after a quote that closes; allowed: a comma. Quotes within a cell are doubled.");
    return cell;
}

}  // namespace wade
