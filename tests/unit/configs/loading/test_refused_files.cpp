// What is wrong with a file taken by itself: unreadable, not JSON, unknown keys, wrong types, values out of range.

#include <sys/stat.h>

#include <algorithm>

#include "configs/errors/problems.hpp"
#include "configs/scene/channel.hpp"
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

TEST_CASE("a key that belongs elsewhere is answered with its full place") {
    const auto unknown = [](const std::string& patch) { return refusal(patch); };
    CHECK_THAT(unknown(R"({"tau": 0.5})"), Contains("/tau: unknown key \"tau\"; the nearest known key is /crowd/tau; "
                                                    "also /events/0/tau, /crowd/groups/0/tau."));
    CHECK_THAT(unknown(R"({"cfl": 0.5})"), Contains("the nearest known key is /fluid/cfl."));
    CHECK_THAT(unknown(R"({"crowd": {"model": "dfsph"}})"), Contains("the nearest known key is /fluid/model."));
    CHECK_THAT(unknown(R"({"fluid": {"depth_m": 1}})"), Contains("the nearest known key is /channel/depth_m"));
    CHECK_THAT(unknown(R"({"contact_rul": "sum"})"), Contains("the nearest known key is /coupling/contact_rule."));
    CHECK_THAT(unknown(R"({"fluid": {"cfll": 1}})"), Contains("the nearest known key is \"cfl\"."));
    CHECK_THAT(unknown(R"({"world": {"length": 1}})"), Contains("the nearest known key is \"length_m\"."));
    CHECK_THAT(refusal("{}", {"/goal_radius_m=2"}), Contains("the nearest known key is /crowd/goal_radius_m."));
}

TEST_CASE("of keys that are equally near, one that is not set yet is named") {
    const std::string goal = R"({"crowd": {"groups": [{"name": "a", "start": {"x_m": 1, "z_m": 1}, "goal": )";
    CHECK_THAT(refusal(goal + R"({"x_m": 1, "y_m": 2}}]}})"),
               Contains("/crowd/groups/0/goal/y_m: unknown key \"y_m\"; the nearest known key is \"z_m\"."));
    CHECK_THAT(refusal(goal + R"({"z_m": 1, "y_m": 2}}]}})"), Contains("the nearest known key is \"x_m\"."));
}

TEST_CASE("a list where a number or limits belong is answered with the form of limits") {
    for (const std::string place : {R"({"crowd": {"tau": [0.1, 0.2]}})", R"({"crowd": {"mass_kg": [50, 90]}})"}) {
        CHECK_THAT(refusal(place), Contains(R"(expected a number or an object {"min": ..., "max": ...}, found [)"));
    }
}

TEST_CASE("all mistakes of keys and values are told at once, a line each") {
    CHECK_THAT(refusal(R"({"sead": 3, "fluid": {"cfl": 9}, "crowd": {"tau": "much"}, "obstacles": [{"x_m": 1}]})"),
               Equals("scene.json: /crowd/tau: expected a number or an object {\"min\": ..., \"max\": ...}, found "
                      "\"much\" (string).\n"
                      "scene.json: /fluid/cfl: 9 is out of range; allowed: > 0 and <= 2.\n"
                      "scene.json: /obstacles/0/x_m: unknown key \"x_m\"; the nearest known key is \"x_min_m\".\n"
                      "scene.json: /sead: unknown key \"sead\"; the nearest known key is \"seed\"."));
    const std::string two = refusal_of_text(R"({"channel": {"x_min_m": 0, "x_max_m": 9}})");
    for (const std::string missing : {"/channel/z_min_m", "/channel/z_max_m", "/channel/flow"}) {
        CHECK_THAT(two, Contains("scene.json: " + missing + ": required key"));
    }
    const std::string options = refusal("{}", {"/seed=-1", "/sead=2", "/fluid/cfl=9"});
    for (const std::string option :
         {"--set /seed=-1: /seed", "--set /sead=2: /sead", "--set /fluid/cfl=9: /fluid/cfl"}) {
        CHECK_THAT(options, Contains(option));
    }
}

TEST_CASE("all mistakes of values that do not go together are told at once") {
    const std::string all = refusal(R"({"channel": {"slope": 0.1, "velocity_m_s": 1, "no_slip": [{"plane": "top"}]},
        "crowd": {"markers": "redrawn", "markers_per_cell": 63, "ragdoll": {"condition": "paper"},
                  "groups": [)" + group("a", 1, 1) +
                                    "," + group("a", 2000, 1) + R"(]},
        "events": [{"frame": 1, "agent": 7, "tau": 1}, {"frame": 1, "group": "b", "tau": 1}]})");
    for (const std::string place :
         {"/channel/no_slip/0/plane", "/channel/velocity_m_s", "/crowd/groups/1/name", "/crowd/groups/1/start",
          "/crowd/markers_per_cell", "/crowd/ragdoll/condition", "/events/0/agent", "/events/1/group"}) {
        CHECK_THAT(all, Contains("scene.json: " + place + ": "));
    }
}

TEST_CASE("more mistakes than anybody reads are counted") {
    std::string keys;
    for (int i = 0; i < 40; ++i)
        keys += (i == 0 ? "\"" : ", \"") + std::string("unknown_") + std::to_string(i) + "\": 1";
    const std::string all = refusal("{" + keys + "}");
    CHECK(std::count(all.begin(), all.end(), '\n') == wade::Problems::most_shown);
    CHECK_THAT(all, Catch::Matchers::EndsWith("\nand 28 more mistakes."));
}

TEST_CASE("only plain files are read, and none is waited for") {
    const TemporaryFolder folder;
    const std::string fifo = (folder.path() / "fifo.json").string();
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    CHECK_THAT(refusal_of_file(fifo), Equals(fifo + " cannot be read: it is a pipe (FIFO); allowed: a plain file."));
    const std::string child = folder.write("child.json", R"({"extends": "fifo.json"})").string();
    CHECK_THAT(refusal_of_file(child),
               StartsWith(child + ": /extends: the file " + fifo + " that it extends cannot be "));
    CHECK_THAT(refusal_of_file(folder.path()), Contains("cannot be read: it is a folder."));
    for (const std::string device : {"/dev/null", "/dev/zero", "/dev/full"}) {
        CHECK_THAT(refusal_of_file(device), Equals(device + " cannot be read: it is a device; allowed: a plain file."));
    }
    CHECK_THAT(refusal_of_file(folder.path() / "gone.json"), Contains("No such file or directory"));
}

TEST_CASE("a chain of files that extend one another has an end") {
    const TemporaryFolder folder;
    const auto name = [](int i) { return "f" + std::to_string(i) + ".json"; };
    folder.write(name(0), dry_scene);
    for (int i = 1; i <= 40; ++i) folder.write(name(i), R"({"extends": ")" + name(i - 1) + R"("})");
    CHECK(wade::load_scene(folder.path() / name(31)).scene.channel->x.hi == 40);
    CHECK_THAT(refusal_of_file(folder.path() / name(32)), Contains("/extends: more than 32 files extend one another"));
    CHECK_THAT(refusal_of_file(folder.path() / name(40)), Contains("/extends: more than 32 files extend one another"));
}
