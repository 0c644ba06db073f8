#include "configs/files/residents_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <unordered_set>

#include "configs/errors/exit_code.hpp"
#include "configs/files/text_file.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

constexpr std::array<std::string_view, 10> known{"id",     "x",    "y",     "age",   "sex",
                                                 "height", "mass", "skill", "group", "leaves_at"};

std::string_view trimmed_cell(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\"");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\"") - first + 1);
}

class ResidentTable {
 public:
    explicit ResidentTable(const std::string& name) : name_(name) {}

    std::vector<Resident> read(std::string_view text) {
        while (!text.empty()) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            std::string_view line = text.substr(0, end);
            text.remove_prefix(std::min(end + 1, text.size()));
            if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
            ++line_;
            if (!trimmed_cell(line).empty() && line.front() != '#') take(line);
        }
        if (people_.empty())
            fail("there are no people; allowed: a line of names, x and y among them, then a line each.");
        return std::move(people_);
    }

 private:
    [[noreturn]] void fail(const std::string& sentence) const { throw ConfigurationError(name_ + ": " + sentence); }
    [[noreturn]] void fail_here(const std::string& sentence) const {
        fail("line " + std::to_string(line_) + ": " + sentence);
    }

    void take(std::string_view line) {
        cells_.clear();
        for (std::size_t begin = 0; begin <= line.size();) {
            const std::size_t end = std::min(line.find(',', begin), line.size());
            cells_.push_back(trimmed_cell(line.substr(begin, end - begin)));
            begin = end + 1;
        }
        if (columns_.empty()) return name_columns();
        if (cells_.size() != columns_.size())
            fail_here(std::to_string(cells_.size()) + " values; allowed: " + std::to_string(columns_.size()) +
                      ", one a column.");
        Resident& one = people_.emplace_back();
        one.line = line_;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            if (!cells_[i].empty()) set(one, columns_[i], cells_[i]);
        }
        if (!one.id.empty() && !ids_.insert(one.id).second)
            fail_here("id \"" + one.id + "\" stands twice; allowed: one of its own for each.");
    }

    void name_columns() {
        for (const std::string_view cell : cells_) {
            if (std::find(known.begin(), known.end(), cell) == known.end())
                fail_here("there is no column \"" + std::string(cell) +
                          "\"; allowed: id, x, y, age, sex, height, mass, skill, group, leaves_at.");
            if (std::find(columns_.begin(), columns_.end(), cell) != columns_.end())
                fail_here("the column \"" + std::string(cell) + "\" stands twice.");
            columns_.emplace_back(cell);
        }
        for (const char* const needed : {"x", "y"}) {
            if (std::find(columns_.begin(), columns_.end(), needed) == columns_.end())
                fail_here(std::string("there is no column ") + needed + "; allowed: x and y, m in the place's system.");
        }
    }

    void set(Resident& one, const std::string& column, std::string_view cell) {
        constexpr double most = 1e9;
        if (column == "id") one.id = cell;
        if (column == "group") one.group = cell;
        if (column == "x") one.x = number(column, cell, -most, most);
        if (column == "y") one.z = number(column, cell, -most, most);
        if (column == "age") one.person.age = number_as(column, "age", cell);
        if (column == "height") one.person.height = number_as(column, "height_m", cell);
        if (column == "mass") one.person.mass = number_as(column, "mass_kg", cell);
        if (column == "leaves_at") one.leaves_at = number(column, cell, 0, 1e6);
        if (column == "sex") one.person.sex = word<SexRule>(column, cell);
        if (column == "skill") one.person.skill = word<Skill>(column, cell);
    }

    // A number of the range that the key of people has in a scene.
    [[nodiscard]] double number_as(const std::string& column, std::string_view key, std::string_view cell) const {
        static const KeyNode& keys = *scene_keys().find("crowd")->find("people");
        const Key& of_people = keys.find(key)->key;
        double value = 0;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        const bool is_one = error == std::errc() && end == cell.data() + cell.size();
        if (is_one && of_people.range.contains(value)) return value;
        fail_here(column + " is \"" + std::string(cell.substr(0, 40)) + "\"; allowed: a number " +
                  allowed_values(of_people) + ".");
    }

    [[nodiscard]] double number(const std::string& column, std::string_view cell, double least, double most) const {
        double value = 0;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        const bool is_one = error == std::errc() && end == cell.data() + cell.size();
        if (is_one && value >= least && value <= most) return value;
        std::ostringstream sentence;
        sentence << column << " is \"" << cell.substr(0, 40) << "\"; allowed: a number from " << least << " to " << most
                 << '.';
        fail_here(sentence.str());
    }

    template <typename Choice>
    [[nodiscard]] Choice word(const std::string& column, std::string_view cell) const {
        if (const auto choice = choice_named<Choice>(cell)) return *choice;
        std::string allowed;
        for (const std::string& name : names_of<Choice>()) allowed += (allowed.empty() ? "" : ", ") + name;
        fail_here(column + " is \"" + std::string(cell.substr(0, 40)) + "\"; allowed: " + allowed + ".");
    }

    const std::string& name_;
    std::vector<std::string> columns_;
    std::vector<std::string_view> cells_;
    std::vector<Resident> people_;
    std::unordered_set<std::string> ids_;
    std::size_t line_ = 0;
};

}  // namespace

std::vector<Resident> parse_residents(std::string_view text, const std::string& name) {
    return ResidentTable(name).read(text);
}

std::vector<Resident> read_residents(const std::filesystem::path& file) {
    constexpr std::size_t longest = std::size_t{256} << 20;
    return parse_residents(read_text_file(file, "the file " + file.string(), longest), file.string());
}

}  // namespace wade
