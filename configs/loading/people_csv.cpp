// Tables of people.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "configs/json/json.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/scene/keys.hpp"
#include "configs/scene/person_size.hpp"

namespace wade {

namespace {

constexpr const char* key_of_files = "people_csv";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> cells_of(std::string_view line) {
    std::vector<std::string> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        cells.emplace_back(trimmed(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    return cells;
}

// A number, true or false, or else a text, so that the rules of keys say what is wrong with it.
Json value_of(const std::string& cell) {
    if (cell == "true" || cell == "false") return cell == "true";
    double number = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    if (error != std::errc() || end != cell.data() + cell.size()) return cell;
    const bool is_whole = std::trunc(number) == number && std::abs(number) < 1e15;
    return is_whole ? Json(static_cast<std::int64_t>(number)) : Json(number);
}

// "0:0.2 30:0.8" as a list of points; what is none stays a text.
Json history_of(const std::string& cell) {
    Json points = Json::array();
    std::istringstream words(cell);
    for (std::string word; words >> word;) {
        const std::size_t colon = word.find(':');
        if (colon == std::string::npos) return cell;
        points.push_back({{"time_s", value_of(word.substr(0, colon))}, {"tau", value_of(word.substr(colon + 1))}});
    }
    return points;
}

class Table {
 public:
    Table(const std::filesystem::path& file, const std::string& context, Problems& problems)
        : name_(file.string()), text_(read_text_file(file, context)), problems_(problems) {}

    // An array of objects; an empty cell sets nothing.
    Json people() {
        Json people = Json::array();
        std::vector<std::string> columns;
        std::size_t number = 0;
        for (std::string_view rest = text_; !rest.empty();) {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            const std::string_view line = trimmed(rest.substr(0, end));
            rest.remove_prefix(std::min(end + 1, rest.size()));
            ++number;
            if (line.empty() || line.front() == '#') continue;
            if (columns.empty()) {
                columns = cells_of(line);
            } else {
                people.push_back(person(columns, cells_of(line), number));
            }
        }
        if (people.empty())
            problems_.note(name_ + ": there are no people; allowed: a line of names, then a line each.");
        return people;
    }

 private:
    Json person(const std::vector<std::string>& columns, const std::vector<std::string>& cells, std::size_t line) {
        static const KeyNode& keys = *scene_keys().find("crowd")->find("people");
        const std::string source = name_ + ", line " + std::to_string(line);
        Json person = Json::object();
        if (cells.size() != columns.size()) {
            problems_.note(source + ": there are " + std::to_string(cells.size()) +
                           " values; allowed: " + std::to_string(columns.size()) + ", one for each column.");
            return person;
        }
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (cells[i].empty()) continue;
            const bool in_time = columns[i] == "tau_history";
            person[columns[i]] = in_time ? history_of(cells[i]) : value_of(cells[i]);
        }
        KeyNode of_one = keys;
        of_one.key.kind = KeyKind::object;
        check_keys(person, of_one, "", {source, problems_, of_one});
        check_size(person, source);
        return person;
    }

    // Of a person with a size in its own line.
    void check_size(const Json& person, const std::string& source) {
        const auto given = [&](const char* key) -> std::optional<Spread> {
            if (!person.contains(key) || !person[key].is_number()) return std::nullopt;
            return Spread(person[key].get<double>());
        };
        const std::optional<Spread> age = given("age"), height = given("height_m"), mass = given("mass_kg");
        std::optional<Interval> years;
        if (age) years = Interval{age->lo, age->hi};
        if (const auto fault = fault_of_size(years, height, mass))
            problems_.note(source + ": /" + (fault->is_mass ? "mass_kg" : "height_m") + ": " + fault->sentence);
    }

    std::string name_, text_;
    Problems& problems_;
};

void take_people_of(Json& object, const std::string& pointer, const std::filesystem::path& scene_file,
                    Problems& problems) {
    if (!std::as_const(object)[key_of_files].is_string()) return;
    const std::filesystem::path file =
        (scene_file.parent_path() / object[key_of_files].get<std::string>()).lexically_normal();
    object.erase(key_of_files);
    const std::string context =
        scene_file.string() + ": " + pointer + "/" + key_of_files + ": the file " + file.string();
    problems.attempt([&] { object["people"] = Table(file, context, problems).people(); });
}

}  // namespace

void take_people(Json& document, const std::filesystem::path& scene_file, Problems& problems) {
    Json* const found = document.find("crowd");
    if (found == nullptr || !found->is_object()) return;
    Json& crowd = *found;
    take_people_of(crowd, "/crowd", scene_file, problems);
    if (!std::as_const(crowd)["groups"].is_array()) return;
    for (std::size_t g = 0; g < crowd["groups"].size(); ++g) {
        take_people_of(crowd["groups"][g], "/crowd/groups/" + std::to_string(g), scene_file, problems);
    }
}

}  // namespace wade
