// What is wrong with a file taken by itself: unreadable, not JSON, unknown keys, wrong types, values out of range.

#include <nlohmann/json.hpp>

#include "configs/scene/scene_schema.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using Catch::Matchers::StartsWith;
using namespace wade::test;

TEST_CASE("a missing file is refused with its name and the system's reason") {
    CHECK_THAT(refusal_of_file("no/such/scene.json"),
               Equals("no/such/scene.json cannot be read: No such file or directory."));
}

TEST_CASE("a folder in place of a file is refused") {
    const TemporaryFolder folder;
    CHECK_THAT(refusal_of_file(folder.path()), Equals(folder.path().string() + " cannot be read: it is a folder."));
}

TEST_CASE("broken JSON is refused with line and column") {
    CHECK_THAT(refusal_of_text("{\n  \"seed\": 1,\n  \"seed\" 2\n}"),
               StartsWith("scene.json: not valid JSON at line 3, column 10: ") && Contains("expected ':'"));
    CHECK_THAT(refusal_of_text("{\"seed\": 1,}"), StartsWith("scene.json: not valid JSON at line 1, column 12: "));
    CHECK_THAT(refusal_of_text(""), StartsWith("scene.json: not valid JSON at line 1, column 1: "));
    CHECK_THAT(refusal_of_text("{ /* open"), StartsWith("scene.json: not valid JSON at line 1, "));
}

TEST_CASE("a number that no double holds is refused") {
    CHECK_THAT(refusal_of_text("{\"duration_s\": 1e999}"), StartsWith("scene.json: not valid JSON: number overflow"));
}

TEST_CASE("a key that stands twice in one object is refused") {
    CHECK_THAT(refusal_of_text(R"({"world": {"width_m": 1, "width_m": 2}})"),
               Equals("scene.json: the key \"width_m\" stands twice in one object."));
}

TEST_CASE("endless nesting is refused") {
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    CHECK_THAT(refusal_of_text("{\"events\": " + deep + "}"),
               Equals("scene.json: objects and arrays are nested more than 50 deep."));
}

TEST_CASE("an unknown key is refused with its place and the nearest known key") {
    CHECK_THAT(refusal(R"({"fluid": {"particle_spacing": 0.5}})"),
               Equals("scene.json: /fluid/particle_spacing: unknown key \"particle_spacing\"; the nearest known key is "
                      "\"particle_spacing_m\"."));
    CHECK_THAT(refusal(R"({"sead": 1})"), Contains("/sead: unknown key \"sead\"; the nearest known key is \"seed\"."));
    CHECK_THAT(refusal(R"({"events": [{"frame": 1, "tau": 0}, {"fram": 1, "tau": 0}]})"),
               Contains("/events/1/fram: unknown key \"fram\"; the nearest known key is \"frame\"."));
    CHECK_THAT(refusal(R"({"a/b~c": 1})"), Contains("scene.json: /a~1b~0c: unknown key \"a/b~c\""));
}

TEST_CASE("a value of the wrong type is refused with what was expected and found") {
    CHECK_THAT(refusal(R"({"fluid": {"cfl": "fast"}})"),
               Equals("scene.json: /fluid/cfl: expected a number, found \"fast\" (string)."));
    CHECK_THAT(refusal(R"({"seed": 1.5})"), Contains("/seed: expected a whole number, found 1.5 (number)."));
    CHECK_THAT(refusal(R"({"world": []})"), Contains("/world: expected an object, found [] (array)."));
    CHECK_THAT(refusal(R"({"obstacles": {}})"), Contains("/obstacles: expected an array, found {} (object)."));
    CHECK_THAT(refusal(R"({"description": null})"), Contains("/description: expected a string, found null (null)."));
    CHECK_THAT(refusal(R"({"stop_when_no_agent_is_active": 1})"),
               Contains("expected true or false, found 1 (number)."));
    CHECK_THAT(refusal_of_text("[1]"), Contains("scene.json: the scene: expected an object, found [1] (array)."));
}

TEST_CASE("a value out of range is refused with the range and its unit") {
    CHECK_THAT(refusal(R"({"fluid": {"cfl": 3}})"),
               Equals("scene.json: /fluid/cfl: 3 is out of range; allowed: > 0 and <= 2."));
    CHECK_THAT(refusal(R"({"fluid": {"cfl": 0}})"), Contains("/fluid/cfl: 0 is out of range; allowed: > 0 and <= 2."));
    CHECK_THAT(refusal(R"({"duration_s": -1.5})"),
               Contains("/duration_s: -1.5 is out of range; allowed: > 0 and <= 1000000 s."));
    CHECK_THAT(refusal(R"({"lockstep_depth": 4})"),
               Contains("/lockstep_depth: 4 is out of range; allowed: >= 1 and <= 3 frames."));
    CHECK_THAT(refusal(R"({"crowd": {"perception_radius_m": 2.1}})"),
               Contains("/crowd/perception_radius_m: 2.1 is out of range; allowed: > 0 and <= 2 m."));
}

TEST_CASE("a choice that does not exist is refused with all choices and the nearest") {
    CHECK_THAT(
        refusal(R"({"coupling": {"contact_rule": "diference"}})"),
        Equals("scene.json: /coupling/contact_rule: \"diference\" is not allowed; allowed: \"difference\", \"sum\"; "
               "the nearest is \"difference\"."));
}

TEST_CASE("a name that cannot be a folder is refused") {
    CHECK_THAT(refusal(R"({"name": "../elsewhere"})"),
               Contains("scene.json: /name: \"../elsewhere\" is not allowed; allowed:"));
    CHECK_THAT(refusal(R"({"name": ""})"), Contains("/name: \"\" is not allowed; allowed: at least 1 characters"));
    CHECK_THAT(refusal(R"({"name": "two words"})"), Contains("only characters of [A-Za-z0-9_.-]."));
    CHECK(load_patched(R"({"name": "aZ-0_9."})").scene.name == "aZ-0_9.");
}

TEST_CASE("a missing required key is refused with its type, values and meaning") {
    CHECK_THAT(refusal_of_text("{}"),
               StartsWith("scene.json: /channel: required key \"channel\" is missing (an object"));
    CHECK_THAT(
        refusal_of_text(R"({"channel": {"x_min_m": 0, "x_max_m": 1, "z_min_m": 0, "z_max_m": 1}})"),
        StartsWith("scene.json: /channel/flow: required key \"flow\" is missing (a string; allowed: \"emitter\", "
                   "\"recirculating\", \"periodic\", \"closed\")."));
    CHECK_THAT(refusal(R"({"crowd": {"groups": [{"name": "a", "goal": {"x_m": 1, "z_m": 1}}]}})"),
               Contains("/crowd/groups/0/start: required key \"start\" is missing"));
}

// The loader knows some keywords of JSON Schema; any other would be passed over in silence.
void check_keywords(const nlohmann::json& schema, const std::string& place) {
    const std::vector<std::string> known{"$schema",
                                         "title",
                                         "description",
                                         "type",
                                         "properties",
                                         "required",
                                         "items",
                                         "enum",
                                         "minimum",
                                         "maximum",
                                         "exclusiveMinimum",
                                         "exclusiveMaximum",
                                         "minLength",
                                         "maxLength",
                                         "pattern",
                                         "default",
                                         "x-unit",
                                         "x-default",
                                         "additionalProperties"};
    INFO(place);
    for (const auto& [keyword, value] : schema.items()) CHECK_THAT(known, Catch::Matchers::VectorContains(keyword));
    CHECK((place.find("[]") == place.size() - 2 || schema.contains("description")));
    if (schema.contains("properties")) {
        CHECK(schema.value("additionalProperties", true) == false);
        for (const auto& [key, member] : schema["properties"].items()) check_keywords(member, place + "/" + key);
    }
    if (schema["type"] == "array") check_keywords(schema["items"], place + "[]");
}

TEST_CASE("the schema uses only keywords that the loader checks, and describes every key") {
    check_keywords(wade::scene_schema(), "/");
}
