#pragma once
// Tables of others: comma-separated values as RFC 4180 has them.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/fields.hpp"

namespace wade {

class Json;

// A column that a table may have.
struct CsvColumn {
    std::string name;
    std::string_view unit;  // of its values; empty: none
    bool needed = false;
};

// Reads a table row by row. The first row names the columns. Cells may stand in quotes, with commas, line breaks and doubled quotes in
// them; blanks round other cells are left out. Lines may end with LF, CR or CRLF. Blank lines and lines that begin with '#' are left out.
// Functions throw ConfigurationError that names file, line, what is allowed and the remedy.
class CsvTable {
 public:
    // The text stays with the caller. Throws for other separators than commas, for UTF-16, for names that
    // stand twice and for more columns than max_columns.
    CsvTable(std::string_view text, std::string name);

    [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
    // Returns the number of the column with a name; that of the columns if there is none.
    [[nodiscard]] std::size_t column(std::string_view name) const;
    // Throws for a first line of numbers, for a column that is not among these, such as one in another unit, and for a needed
    // one that is missing. Columns may have any order.
    void check_columns(const std::vector<CsvColumn>& known) const;

    static constexpr std::size_t max_rows = 500'000, max_columns = 1000;

    // Moves to the next row, which has as many cells as there are columns; returns false at the end. Throws for more than max_rows.
    bool next();
    [[nodiscard]] const std::string& cell(std::size_t column) const { return cells_[column]; }
    // Returns the cell as a value of the key, held to its type and limits; null if it is empty.
    [[nodiscard]] Json value(std::size_t column, const Key& key) const;

    // Returns the number of the row's first line, from 1 on.
    [[nodiscard]] std::size_t line() const { return row_line_; }
    // "file: line 3", for messages.
    [[nodiscard]] std::string here() const { return name_ + ": line " + std::to_string(row_line_); }
    [[noreturn]] void fail(const std::string& sentence) const;
    [[noreturn]] void fail_here(const std::string& sentence) const;

 private:
    bool read_row();
    std::string read_cell();
    std::string quoted_cell();
    [[nodiscard]] bool at_line_end() const;
    void skip_line_end();

    std::string_view text_;
    std::string name_;
    std::vector<std::string> columns_, cells_;
    std::size_t at_ = 0, line_ = 1, row_line_ = 1, rows_ = 0;
};

}  // namespace wade
