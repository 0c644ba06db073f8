// extends and --set.

#include <cstdlib>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/short_names.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using Catch::Matchers::StartsWith;
using wade::LoadedScene;
using namespace wade::test;

TEST_CASE("objects merge key by key over a chain of files, the nearest file winning") {
    const TemporaryFolder folder;
    folder.write("base.json", R"({"seed": 5, "duration_s": 7, "world": {"length_m": 60, "width_m": 40},
                                  "channel": {"x_min_m": 0, "x_max_m": 9, "z_min_m": 0, "z_max_m": 9, "flow": "closed"}})");
    folder.write("sub/middle.json", R"({"extends": "../base.json", "duration_s": 8, "world": {"width_m": 30}})");
    const auto top = folder.write("top.json", R"({"extends": "sub/middle.json", "duration_s": 9})");
    const LoadedScene loaded = wade::load_scene(top);
    CHECK(loaded.scene.seed == 5);
    CHECK(loaded.scene.duration == 9);
    CHECK(loaded.scene.world->length == 60);
    CHECK(loaded.scene.world->width == 30);
}

TEST_CASE("arrays are replaced") {
    const TemporaryFolder folder;
    folder.write("base.json",
                 R"({"channel": {"x_min_m": 0, "x_max_m": 40, "z_min_m": 0, "z_max_m": 40, "flow": "closed"},
        "obstacles": [{"x_min_m": 1, "x_max_m": 2, "z_min_m": 1, "z_max_m": 2, "height_m": 1},
                      {"x_min_m": 3, "x_max_m": 4, "z_min_m": 3, "z_max_m": 4, "height_m": 1}]})");
    const auto top = folder.write(
        "top.json",
        R"({"extends": "base.json", "obstacles": [{"x_min_m": 5, "x_max_m": 6, "z_min_m": 5, "z_max_m": 6, "height_m": 2}]})");
    const LoadedScene loaded = wade::load_scene(top);
    REQUIRE(loaded.scene.obstacles.size() == 1);
    CHECK(loaded.scene.obstacles[0].x.lo == 5);
}

TEST_CASE("name and description are not taken over; the name defaults to the file's") {
    const TemporaryFolder folder;
    const auto base = folder.write("base.json", R"({"name": "mother", "description": "base", "channel":
        {"x_min_m": 0, "x_max_m": 9, "z_min_m": 0, "z_max_m": 9, "flow": "closed"}})");
    const auto top = folder.write("child.json", R"({"extends": "base.json"})");
    CHECK(wade::load_scene(base).scene.name == "mother");
    CHECK(wade::load_scene(top).scene.name == "child");
    CHECK(wade::load_scene(top).scene.description.empty());
    CHECK(wade::load_scene(top).scene.hash == wade::load_scene(base).scene.hash);
}

TEST_CASE("a name is made of the file's, whatever characters that has") {
    const TemporaryFolder folder;
    const auto name_of_file = [&](const std::string& file) {
        return wade::load_scene(folder.write(file, dry_scene)).scene.name;
    };
    CHECK(name_of_file("my scene.json") == "my_scene");
    CHECK(name_of_file("\u00dcberflutung.json") == "_berflutung");
    CHECK(name_of_file("[1] (2) {3}.json") == "_1___2___3_");
    CHECK(name_of_file("v1.2-final.json") == "v1.2-final");
    CHECK(name_of_file("...json") == "__");
    CHECK(name_of_file("..json") == "_");
    CHECK(name_of_file(".json") == "_json");
    CHECK(name_of_file("-x.json") == "_x");
    std::string longer;
    while (longer.size() < 100) longer += "ten_letter";
    CHECK(name_of_file(longer + ".json") == longer.substr(0, 64));
}

TEST_CASE("files that extend one another are refused with the way round") {
    const TemporaryFolder folder;
    const std::string a = folder.write("a.json", R"({"extends": "b.json"})").string();
    const std::string b = folder.write("b.json", R"({"extends": "./a.json"})").string();
    CHECK_THAT(refusal_of_file(a),
               Equals(b + ": /extends: the files extend one another: " + a + " -> " + b + " -> " + a + "."));
    const std::string self = folder.write("self.json", R"({"extends": "self.json"})").string();
    CHECK_THAT(refusal_of_file(self), Contains("the files extend one another: " + self + " -> " + self + "."));
}

TEST_CASE("a missing parent is refused with both names") {
    const TemporaryFolder folder;
    const std::string child = folder.write("child.json", R"({"extends": "gone.json"})").string();
    CHECK_THAT(refusal_of_file(child),
               Equals(child + ": /extends: there is no file " + (folder.path() / "gone.json").string() +
                      " and no scene of this short name; `wade scenes` lists those."));
}

TEST_CASE("a short name stands for one scene of the folder of scenes") {
    const TemporaryFolder folder;
    for (const char* name :
         {"paper/a.json", "river/a.json", "river/b.json", "lake/c.json", "river/c.json", "sites/town/d.json"}) {
        folder.write(name, "{}");
    }
    const auto found = [&](const std::string& name) {
        const auto file = wade::scene_of_short_name(name, folder.path());
        return file ? file->lexically_relative(folder.path()).string() : "";
    };
    CHECK(found("river/a") == "river/a.json");
    CHECK(found("river/a.json") == "river/a.json");
    CHECK(found("a") == "paper/a.json");  // of several that of the paper
    CHECK(found("b") == "river/b.json");
    CHECK(found("town/d") == "sites/town/d.json");
    for (const char* unknown : {"c", "e", "r/b", "", "..", "../b", "/river/b", "river/../river/b"})
        CHECK(found(unknown).empty());
}

TEST_CASE("a scene outside of the project extends one by its short name, a file of its folder first") {
    const TemporaryFolder folder;
    const auto scene = [](const std::string& seed) {
        return R"({"channel": {"x_min_m": 0, "x_max_m": 9, "z_min_m": 0, "z_max_m": 9, "flow": "closed"},
                   "world": {"length_m": 60, "width_m": 40}, "seed": )" +
               seed + "}";
    };
    folder.write("scenes/paper/a.json", scene("3"));
    const auto child = folder.write("own/child.json", R"({"extends": "a"})");
    const std::string scenes = (folder.path() / "scenes").string();
    const char* before = std::getenv("WADE_CONFIGS");
    const std::string kept = before ? before : "";
    ::setenv("WADE_CONFIGS", scenes.c_str(), 1);
    CHECK(wade::load_scene(child).scene.seed == 3);
    folder.write("own/a", scene("4"));
    CHECK(wade::load_scene(child).scene.seed == 4);
    before ? ::setenv("WADE_CONFIGS", kept.c_str(), 1) : ::unsetenv("WADE_CONFIGS");
}

TEST_CASE("a mistake in a parent is reported with the parent's name, even where a child overrides it") {
    const TemporaryFolder folder;
    const std::string base = folder.write("base.json", R"({"fluid": {"cfl": 3}})").string();
    const auto child = folder.write("child.json", R"({"extends": "base.json", "fluid": {"cfl": 1}})");
    CHECK_THAT(refusal_of_file(child), StartsWith(base + ": /fluid/cfl: 3 is out of range"));
}

TEST_CASE("comments of both kinds are allowed") {
    const LoadedScene loaded = wade::load_scene_text("// one\n{ /* two */ " + dry_scene.substr(1), "scene.json");
    CHECK(loaded.scene.channel->x.hi == 40);
}

TEST_CASE("--set changes a value after the merge, and makes missing parents") {
    CHECK(load_patched(R"({"seed": 1})", {"/seed=7"}).scene.seed == 7);
    CHECK(load_patched("{}", {"/fluid/density_solve/tolerance=0.001"}).scene.fluid->density_solve.tolerance == 0.001);
    CHECK(load_patched("{}", {"/coupling/contact_rule=sum"}).scene.coupling->contact_rule == wade::ContactRule::sum);
    CHECK(load_patched("{}", {"/coupling/contact_rule=\"sum\""}).scene.coupling->contact_rule ==
          wade::ContactRule::sum);
    CHECK(load_patched("{}", {"/name=7"}).scene.name == "7");
    CHECK(load_patched("{}", {"/seed=7", "/seed=8"}).scene.seed == 8);
}

TEST_CASE("--set reaches into arrays and appends to them") {
    const std::string one = R"({"crowd": {"groups": [)" + group("a", 1, 1) + "]}}";
    CHECK(load_patched(one, {"/crowd/groups/0/tau=0.5"}).scene.crowd->groups.at(0).tau == 0.5);
    const LoadedScene loaded =
        load_patched(one, {"/crowd/groups/1=" + group("b", 5, 5), "/events/0/tau=1", "/events/0/frame=3"});
    CHECK(loaded.scene.crowd->groups.at(1).name == "b");
    CHECK(loaded.scene.events.at(0).frame == 3);
}

TEST_CASE("--set is refused with the option, the pointer and what is wrong") {
    CHECK_THAT(refusal("{}", {"/fluid/cfl=3"}),
               Equals("--set /fluid/cfl=3: /fluid/cfl: 3 is out of range; allowed: > 0 and <= 2."));
    CHECK_THAT(refusal("{}", {"/fluid/clf=1"}),
               Equals("--set /fluid/clf=1: /fluid/clf: unknown key \"clf\"; the nearest known key is \"cfl\"."));
    CHECK_THAT(refusal("{}", {"/fluid/cfl=quick"}),
               Contains("/fluid/cfl: expected a number, found \"quick\" (string)."));
    CHECK_THAT(refusal("{}", {"/fluid/cfl"}), Contains("--set /fluid/cfl: expected /json/pointer=value"));
    CHECK_THAT(refusal("{}", {"fluid.cfl=1"}), Contains("\"fluid.cfl\" is not a JSON pointer; one begins with '/'"));
    CHECK_THAT(refusal("{}", {"/seed/x=1"}),
               Contains("/seed is no object and no array, so that nothing lies below it."));
    CHECK_THAT(refusal("{}", {"/crowd/groups/1/tau=1"}),
               Contains("/crowd/groups/1: \"1\" is not an index of /crowd/groups; allowed: 0 to 0"));
    CHECK_THAT(refusal("{}", {"/extends=x.json"}), Contains("/extends can only be set in a scene file."));
    CHECK_THAT(refusal("{}", {"/description=\xff"}), Contains("the value is not valid UTF-8 text."));
}
