// Each key of the schema reaches the typed scene, and nothing but its one declaration takes it there.

#include "configs/json/json.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/scene/fields/lists.hpp"
#include "configs/scene/scene_documents.hpp"
#include "configs/scene/scene_json.hpp"
#include "scene_texts.hpp"

using wade::Json;
using wade::Problems;
using wade::Scene;

namespace {

std::string text_of_file(const std::string& name) {
    return wade::read_text_file(std::string(WADE_SCENES) + "/../" + name, name);
}

// Every list has an element and every key that may be left out is set in one of them.
const Json everything = Json::parse(R"({
    "name": "everything", "description": "a", "seed": 3,
    "channel": {"x_min_m": 1, "x_max_m": 40, "z_min_m": 2, "z_max_m": 30, "flow": "emitter",
                "bed_points": [{"x_m": 3, "y_m": 0.1}], "no_slip": [{"plane": "bed"}],
                "velocity_history": [{"time_s": 1, "velocity_m_s": 1}],
                "water_blocks": [{"x_min_m": 1, "x_max_m": 2, "z_min_m": 1, "z_max_m": 2, "depth_m": 1}]},
    "obstacles": [{"x_min_m": 1, "x_max_m": 2, "z_min_m": 1, "z_max_m": 2, "height_m": 1}],
    "fluid": {"max_impulse_error": 0.1, "mixed": {"x_min_m": 2, "x_max_m": 3, "margin_m": 1},
              "steering": {"classes": [{"share": 0.1}],
                           "bodies": [{"x_m": 1, "y_m": 1, "z_m": 1, "radius_m": 0.5}]}},
    "crowd": {"tau": 0.1, "mass_kg": 70, "desired_speed_m_s": 1, "step_rate_hz": 30,
              "height_m": 1.8, "sex": "male", "age": 40, "skill": "good", "ground_friction": 0.6, "can_swim": true,
              "bracing_arm": 0.1, "water_temperature_c": 8,
              "navigation": {"enters_up_to_m": 0.5, "safe_above_m": 3},
              "people": [{"height_m": 1.8, "mass_kg": 80, "sex": "male", "age": 40, "skill": "good", "ground_friction": 0.6,
                          "bracing_arm": 0.1, "can_swim": true, "tau_history": [{"time_s": 1, "tau": 0.1}]}],
              "ropes": [{"from": {"x_m": 1, "z_m": 1}, "to": {"x_m": 2, "z_m": 2}, "free_length_m": 3}],
              "groups": [{"name": "takes", "start": {"x_m": 1, "z_m": 1}, "goal": {"x_m": 1, "z_m": 1}},
                         {"name": "sets", "start": {"x_m": 1, "z_m": 1}, "goal": {"x_m": 1, "z_m": 1},
                          "columns": 3, "rows": 3, "count": 5, "tau": 0.2, "mass_kg": 60, "desired_speed_m_s": 2,
                          "height_m": 1.6, "sex": "female", "age": 20, "skill": "poor", "ground_friction": 0.5, "bracing_arm": 0.2,
                          "can_swim": false, "tau_history": [{"time_s": 2, "tau": 0.3}],
                          "leaves": {"table": [{"time_s": 1, "share": 0.5}]},
                          "people": [{"height_m": 1.8, "mass_kg": 80, "sex": "male", "age": 40, "skill": "good",
                                      "ground_friction": 0.6, "bracing_arm": 0.1, "can_swim": true,
                                      "tau_history": [{"time_s": 3, "tau": 0.4}]}]}]},
    "coupling": {"agents_stream": "serial"},
    "events": [{"frame": 3, "agent": 1, "tau": 0.5}, {"time_s": 3, "group": "sets", "tau": 0.6}]
})");

// The same with a site.
const Json everything_on_a_site = [] {
    Json document = everything;
    document["site"] = Json::parse(R"({
        "residents_csv": "people.csv", "epsg": 32756, "origin_easting_m": 300000, "origin_northing_m": 6000000,
        "ground": {"file": "ground.asc", "points": [[0, 1, 0], [9, 1, 0], [0, 1, 9]]},
        "houses": [{"name": "mill", "file": "houses.geojson", "polygon": [[1, 1], [2, 1], [2, 2]], "doors": [[1, 1.5]],
                    "upper_floor_m": 3}],
        "manning": {"file": "n.tif", "zones": [{"file": "roads.geojson", "polygon": [[1, 1], [2, 1], [2, 2]]}]},
        "sources": [{"name": "creek", "file": "a.geojson", "polygon": [[1, 1], [2, 1], [2, 2]], "line": [[1, 1], [2, 2]],
                     "discharge_m3_s": 2, "hydrograph_csv": "q.csv"}],
        "rain": {"rate_mm_h": 3, "rate_csv": "rain.csv"},
        "outlets": [{"name": "sea", "file": "a.geojson", "polygon": [[1, 1], [2, 1], [2, 2]], "line": [[1, 1], [2, 2]],
                     "level_m": 2, "stage_csv": "tide.csv"}],
        "gates": [{"name": "dam", "file": "a.geojson", "line": [[1, 1], [2, 2]]}],
        "walls": [{"name": "levee", "file": "a.geojson", "line": [[1, 1], [2, 2]], "crest_m": 1}],
        "water": [{"file": "a.geojson", "polygon": [[1, 1], [2, 1], [2, 2]]}],
        "water_depth_file": "depth.tif",
        "gauges": [{"name": "bridge", "file": "a.geojson", "x_m": 1, "z_m": 2}],
        "shelters": [{"name": "school", "file": "a.geojson", "polygon": [[1, 1], [2, 1], [2, 2]]}]
    })");
    return document;
}();

const Json& everything_for(const std::string& pattern) {
    return pattern.starts_with("/site") ? everything_on_a_site : everything;
}

// Splits "/a/0/b" into its keys; keys have no escapes.
std::vector<std::string> split_pointer(const std::string& pointer) {
    std::vector<std::string> keys;
    std::istringstream text(pointer.substr(1));
    for (std::string key; std::getline(text, key, '/');) keys.push_back(key);
    return keys;
}

// Null pointer if there is no such value.
const Json* value_at(const Json& document, const std::string& pointer) {
    const Json* value = &document;
    for (const std::string& key : split_pointer(pointer)) {
        if (value->is_array()) {
            if (key.find_first_not_of("0123456789") != std::string::npos || std::stoul(key) >= value->size())
                return nullptr;
            value = &(*value)[std::stoul(key)];
        } else {
            value = value->find(key);
        }
        if (value == nullptr) return nullptr;
    }
    return value;
}

// Adds the keys of objects that are not there.
Json& made_at(Json& document, const std::string& pointer) {
    Json* value = &document;
    for (const std::string& key : split_pointer(pointer))
        value = value->is_array() ? &(*value)[std::stoul(key)] : &(*value)[key];
    return *value;
}

struct Leaf {
    std::string pattern;  // "/crowd/groups/*/tau"
    std::string pointer;  // "/crowd/groups/1/tau"
    Json schema;
};

// The last element that sets the key, or the last that there is.
std::size_t index_for(const Json& list, const std::string& key) {
    for (std::size_t i = list.size(); i > 0; --i) {
        if (list[i - 1].contains(key)) return i - 1;
    }
    return list.size() - 1;
}

void collect(const Json& schema, const Json& value, const std::string& pattern, const std::string& pointer,
             std::vector<Leaf>& leaves) {
    for (const auto& [key, its] : schema["properties"].items()) {
        const std::string below = pattern + "/" + key;
        const Json& member = value[key];
        if (its["type"] == "object") {
            collect(its, member.is_null() ? Json::object() : member, below, pointer + "/" + key, leaves);
        } else if (its["type"] == "array" && its["items"]["type"] == "object") {
            INFO(below);
            REQUIRE(!member.empty());
            for (const auto& [name, inner] : its["items"]["properties"].items()) {
                const std::size_t i = index_for(member, name);
                const Json one = {{"properties", {{name, inner}}}};
                collect(one, member[i], below + "/*", pointer + "/" + key + "/" + std::to_string(i), leaves);
            }
        } else {
            leaves.push_back({below, pointer + "/" + key, its});
        }
    }
}

// Of the schema that editors use; $schema, extends and people_csv tell how a file is read and reach no scene.
std::vector<Leaf> leaves_of_schema() {
    Json schema = Json::parse(text_of_file("configs/scene.schema.json"));
    schema["properties"].erase("$schema");
    schema["properties"].erase("extends");
    Json& crowd = schema["properties"]["crowd"]["properties"];
    crowd.erase("people_csv");
    crowd["groups"]["items"]["properties"].erase("people_csv");
    std::vector<Leaf> leaves;
    collect(schema, everything_on_a_site, "", "", leaves);
    return leaves;
}

// A choice of a single word so far.
bool has_one_value(const Json& schema) {
    return schema.contains("enum") && schema["enum"].size() == 1;
}

// Another value that the schema allows, the only one where there is no other.
Json other_value(const Json& schema, const Json& present) {
    const Json& type = schema["type"];
    if (type == "boolean") return !present.get<bool>();
    if (has_one_value(schema)) return schema["enum"][0];
    if (schema.contains("enum")) return schema["enum"][0] == present ? schema["enum"][1] : schema["enum"][0];
    if (type == "string") return "another";
    if (type == "array") {  // of points
        const auto size = schema["items"]["minItems"].get<std::size_t>();
        return Json::array({std::vector<int>(size, 3), std::vector<int>(size, 4), std::vector<int>(size, 5)});
    }
    const auto lo = schema[schema.contains("minimum") ? "minimum" : "exclusiveMinimum"].get<double>();
    const auto hi = schema[schema.contains("maximum") ? "maximum" : "exclusiveMaximum"].get<double>();
    for (const double share : {0.5, 0.25}) {
        const double value = lo + share * (hi - lo);
        const Json other = type == "integer" ? Json(static_cast<std::int64_t>(value)) : Json(value);
        if (other != present) return other;
    }
    FAIL("no other value");
    return {};
}

Json read_and_written(const Json& document, const std::string& skipped = "") {
    Problems problems;
    Scene scene;
    wade::read_scene(document, scene, {"scene.json", problems}, skipped);
    if (skipped.empty()) problems.throw_if_any();
    return wade::written_scene(scene);
}

Json changed(const Leaf& leaf) {
    Json document = everything_for(leaf.pattern);
    const Json before = read_and_written(document);
    const Json* present = value_at(document, leaf.pointer);
    if (present == nullptr) present = value_at(before, leaf.pointer);
    const Json other = other_value(leaf.schema, present == nullptr ? Json() : *present);
    made_at(document, leaf.pointer) = other;
    return document;
}

bool noted_as_unknown(const std::string& skipped) {
    Problems problems;
    const wade::KeyNode keys =
        wade::declared_keys([scene = Scene()](wade::Fields& f) mutable { fields(scene, f); }, skipped);
    Json document;
    for (const Leaf& leaf : leaves_of_schema()) {
        if (leaf.pattern == skipped) document = changed(leaf);
    }
    wade::check_keys(document, keys, "", {"scene.json", problems, keys});
    return !problems.none();
}

}  // namespace

TEST_CASE("the scene with everything keeps the keys' rules") {
    Problems problems;
    wade::check_keys(everything_on_a_site, wade::scene_keys(), "", {"scene.json", problems});
    CHECK_NOTHROW(problems.throw_if_any());
    CHECK(leaves_of_schema().size() > 150);
}

TEST_CASE("another value of any key is allowed, changes the typed scene and is printed") {
    for (const Leaf& leaf : leaves_of_schema()) {
        INFO(leaf.pointer);
        const Json before = read_and_written(everything_for(leaf.pattern));
        if (has_one_value(leaf.schema)) continue;
        const Json document = changed(leaf);
        Problems problems;
        wade::check_keys(document, wade::scene_keys(), "", {"scene.json", problems});
        CHECK_NOTHROW(problems.throw_if_any());
        const Json after = read_and_written(document);
        CHECK(after != before);
        // A key of the crowd that groups take over, or a time that becomes a frame, is printed where it went.
        const bool shorthand = value_at(before, leaf.pointer) == nullptr;
        if (shorthand) continue;
        const Json *const printed = value_at(after, leaf.pointer), *const written = value_at(document, leaf.pointer);
        REQUIRE((printed != nullptr && written != nullptr));
        CHECK(*printed == *written);
    }
}

TEST_CASE("limits of a spread are keys as well") {
    for (const std::string key : {"tau", "mass_kg"}) {
        for (const std::string& pointer : {"/crowd/" + key, "/crowd/groups/1/" + key}) {
            Json document = everything;
            Json& limits = made_at(document, pointer);
            limits = {{"min", 0.2}, {"max", 0.7}};
            const Json spread = read_and_written(document);
            limits["min"] = 0.3;
            const Json higher = read_and_written(document);
            limits["max"] = 0.8;
            CHECK(spread != higher);
            CHECK(higher != read_and_written(document));
        }
    }
}

TEST_CASE("without its one declaration a key does nothing and is not known: no other code reads it") {
    for (const Leaf& leaf : leaves_of_schema()) {
        INFO(leaf.pattern);
        const Json& whole_scene = everything_for(leaf.pattern);
        CHECK(read_and_written(changed(leaf), leaf.pattern) == read_and_written(whole_scene, leaf.pattern));
        CHECK(noted_as_unknown(leaf.pattern));
        const Json whole = wade::written_scene(Scene());
        const Json without = wade::written_scene(Scene(), leaf.pattern);
        // Of keys in lists, which a new scene has none of, nothing is printed.
        if (value_at(whole, leaf.pattern) != nullptr) CHECK(value_at(without, leaf.pattern) == nullptr);
    }
}

TEST_CASE("schema and documentation are those of the declared keys; `ninja scene_documents` writes them") {
    for (const wade::SceneDocument& document : wade::scene_documents()) {
        INFO(document.file);
        CHECK((text_of_file(document.file) == document.text));
    }
}

TEST_CASE("every key says what it means") {
    const std::function<void(const wade::KeyNode&)> check = [&](const wade::KeyNode& node) {
        for (const wade::KeyNode& inner : node.inside) {
            INFO(inner.key.name);
            CHECK(inner.key.meaning.size() > 5);
            check(inner);
        }
    };
    check(wade::scene_keys());
}
