// Tables of people.

#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "configs/files/csv_table.hpp"
#include "configs/json/json.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/scene/keys.hpp"
#include "configs/scene/person_size.hpp"

namespace wade {

namespace {

constexpr const char* key_of_files = "people_csv";

// "0:0.2 30:0.8" as a list of points; what is none stays a text.
Json history_of(const std::string& cell) {
    Json points = Json::array();
    std::istringstream words(cell);
    for (std::string word; words >> word;) {
        const std::size_t colon = word.find(':');
        if (colon == std::string::npos) return cell;
        points.push_back({{"time_s", value_of_cell(word.substr(0, colon), Key())},
                          {"tau", value_of_cell(word.substr(colon + 1), Key())}});
    }
    return points;
}

class PeopleTable {
 public:
    PeopleTable(const std::filesystem::path& file, const std::string& context, Problems& problems)
        : text_(read_text_file(file, context)), table_(text_, file.string()), problems_(problems) {
        std::vector<CsvColumn> known;
        for (const KeyNode& node : keys().inside) known.push_back({std::string(node.key.name), node.key.unit});
        if (!table_.columns().empty()) table_.check_columns(known);
    }

    // An array of objects; an empty cell sets nothing.
    Json people() {
        Json people = Json::array();
        while (table_.next()) people.push_back(person());
        if (people.empty()) table_.fail("there are no people; allowed: a line of names, then a line each.");
        return people;
    }

 private:
    static const KeyNode& keys() { return *scene_keys().find("crowd")->find("people"); }

    Json person() {
        const std::string source = table_.here();
        Json person = Json::object();
        for (std::size_t i = 0; i < table_.columns().size(); ++i) {
            const std::string &name = table_.columns()[i], &cell = table_.cell(i);
            const Key& key = keys().find(name)->key;
            if (!cell.empty()) person[name] = name == "tau_history" ? history_of(cell) : value_of_cell(cell, key);
        }
        KeyNode of_one = keys();
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

    std::string text_;
    CsvTable table_;
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
    problems.attempt([&] { object["people"] = PeopleTable(file, context, problems).people(); });
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
