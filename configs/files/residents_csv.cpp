#include "configs/files/residents_csv.hpp"

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <unordered_set>

#include "configs/errors/exit_code.hpp"
#include "configs/files/csv_table.hpp"
#include "configs/files/text_file.hpp"
#include "configs/json/json.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

// A column: the key with its type and limits, and the member that it fills.
struct ResidentColumn {
    std::string name;
    Key key;
    std::function<void(Resident&, const Json&)> set;
};

const Key& key_of_scene(std::initializer_list<std::string_view> path) {
    const KeyNode* node = &scene_keys();
    for (const std::string_view name : path) node = node->find(name);
    return node->key;
}

const std::vector<ResidentColumn>& columns_of_residents() {
    const Key easting{"x", KeyKind::number, "Easting.", "m", from(-1e9).to(1e9)};
    const Key id{"id", KeyKind::text, "Name in agents.csv.", "", {}, {.longest = 100}};
    const auto person = [](std::string_view key) { return key_of_scene({"crowd", "people", key}); };
    const auto number = [](auto member) {
        return [member](Resident& one, const Json& value) { member(one) = value.get<double>(); };
    };
    static const std::vector<ResidentColumn> columns{
        {"id", id, [](Resident& one, const Json& value) { one.id = value.get<std::string>(); }},
        {"x", easting, number([](Resident & one) -> auto& { return one.x; })},
        {"y", easting, number([](Resident & one) -> auto& { return one.z; })},
        {"age", person("age"), number([](Resident & one) -> auto& { return one.person.age; })},
        {"sex", person("sex"),
         [](Resident& one, const Json& value) { one.person.sex = choice_named<SexRule>(value.get<std::string>()); }},
        {"height", person("height_m"), number([](Resident & one) -> auto& { return one.person.height; })},
        {"mass", person("mass_kg"), number([](Resident & one) -> auto& { return one.person.mass; })},
        {"skill", person("skill"),
         [](Resident& one, const Json& value) { one.person.skill = choice_named<Skill>(value.get<std::string>()); }},
        {"group", key_of_scene({"crowd", "groups", "name"}),
         [](Resident& one, const Json& value) { one.group = value.get<std::string>(); }},
        {"leaves_at", key_of_scene({"crowd", "groups", "leaves", "after_s"}),
         number([](Resident & one) -> auto& { return one.leaves_at; })}};
    return columns;
}

std::vector<const ResidentColumn*> columns_of(const CsvTable& table) {
    const std::vector<ResidentColumn>& all = columns_of_residents();
    std::vector<CsvColumn> known;
    for (const ResidentColumn& one : all) known.push_back({one.name, one.key.unit, one.name == "x" || one.name == "y"});
    table.check_columns(known);
    std::vector<const ResidentColumn*> columns;
    for (const std::string& name : table.columns())
        columns.push_back(&*std::ranges::find(all, name, &ResidentColumn::name));
    return columns;
}

}  // namespace

std::vector<Resident> parse_residents(std::string_view text, const std::string& name) {
    CsvTable table(text, name);
    std::vector<Resident> people;
    std::unordered_set<std::string> ids;
    if (!table.columns().empty()) {
        const std::vector<const ResidentColumn*> columns = columns_of(table);
        const auto rows = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
        people.reserve(std::min(rows, CsvTable::max_rows));  // a vector that grows holds them twice
        while (table.next()) {
            Resident one;
            one.line = table.line();
            for (std::size_t i = 0; i < columns.size(); ++i) {
                const Json value = table.value(i, columns[i]->key);
                if (!value.is_null()) {
                    columns[i]->set(one, value);
                } else if (columns[i]->name == "x" || columns[i]->name == "y") {
                    table.fail_here(columns[i]->name + " is empty; allowed: a number, m in the site's system.");
                }
            }
            if (!one.id.empty() && !ids.insert(one.id).second)
                table.fail_here("id \"" + one.id + "\" stands twice; allowed: one of its own for each.");
            people.push_back(std::move(one));
        }
    }
    if (people.empty())
        table.fail("there are no people; allowed: a line of names, x and y among them, then a line each.");
    return people;
}

std::vector<Resident> read_residents(const std::filesystem::path& file) {
    constexpr std::size_t longest = std::size_t{256} << 20;
    return parse_residents(read_text_file(file, "the file " + file.string(), longest), file.string());
}

}  // namespace wade
