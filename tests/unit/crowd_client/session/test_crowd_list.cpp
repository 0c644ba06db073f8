// Lists of crowds for one water.

#include <catch2/catch.hpp>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/session/crowd_list.hpp"

using namespace wade;
using namespace wade::crowd;
using Catch::Matchers::Contains;

namespace {

const std::filesystem::path scene_file = std::filesystem::path(WADE_SCENES) / "observed" / "s05.json";

std::vector<ListedCrowd> crowds_of(const std::string& list, const std::vector<SceneOverride>& overrides = {}) {
    return load_crowds_text(list, "list.json", scene_file, overrides, load_scene(scene_file, overrides));
}

void check_refusal(const std::string& list, const std::vector<std::string>& words) {
    INFO(list);
    try {
        (void)crowds_of(list);
        FAIL_CHECK("was accepted");
    } catch (const ConfigurationError& error) {
        for (const std::string& word : words) CHECK_THAT(error.what(), Contains(word));
    }
}

}  // namespace

TEST_CASE("A listed crowd is the scene with what it sets, as --set would") {
    const auto crowds = crowds_of(R"([
        {"name": "base"},  // comments are allowed
        {"name": "weak.seed-3_b", "set": {"/seed": 3, "/crowd/tau": 0.5, "/coupling/contact_rule": "sum"}}])");
    REQUIRE(crowds.size() == 2);
    CHECK(crowds[0].name == "base");
    CHECK(crowds[0].loaded.scene.hash == load_scene(scene_file).scene.hash);
    const LoadedScene same = load_scene(scene_file, {parse_override("/seed=3"), parse_override("/crowd/tau=0.5"),
                                                     parse_override("/coupling/contact_rule=sum")});
    CHECK(crowds[1].loaded.canonical_json == same.canonical_json);
}

TEST_CASE("What the command line sets holds for each crowd that does not set it") {
    const auto crowds = crowds_of(R"([{"name": "a"}, {"name": "b", "set": {"/seed": 3}}])",
                                  {{"/seed", "7", "--seed 7"}, {"/duration_s", "5", "--until-s 5"}});
    CHECK(crowds[0].loaded.scene.seed == 7);
    CHECK(crowds[1].loaded.scene.seed == 3);
    CHECK(crowds[1].loaded.scene.duration == 5);
}

TEST_CASE("Events, name and description may differ between crowds") {
    const auto crowds = crowds_of(
        R"([{"name": "a", "set": {"/name": "x", "/description": "y", "/events/0": {"frame": 3, "tau": 1}}}])");
    CHECK(crowds[0].loaded.scene.name == "x");
    CHECK(crowds[0].loaded.scene.events.size() == 1);
}

TEST_CASE("What a crowd sets is set in the order in which it is written") {
    std::string set;
    for (int i = 0; i < 11; ++i) {
        const std::string number = std::to_string(i);
        set += (i == 0 ? "\"/events/" : ", \"/events/") + number + R"(": {"frame": )" + number + R"(, "tau": 0.5})";
    }
    const auto crowds = crowds_of(R"([{"name": "a", "set": {)" + set + "}}]");
    REQUIRE(crowds[0].loaded.scene.events.size() == 11);
    CHECK(crowds[0].loaded.scene.events[10].frame == 10);
    CHECK(crowds_of(R"([{"name": "a", "set": {"/crowd/tau": {"min": 0, "max": 1}, "/crowd/tau/max": 0.5}}])")[0]
              .loaded.scene.crowd->groups[0]
              .tau->hi == 0.5);
}

TEST_CASE("A crowd cannot change the water, but may state it") {
    CHECK_NOTHROW(crowds_of(R"([{"name": "a", "set": {"/channel/velocity_m_s": 1.5}}])"));
    check_refusal(
        R"([{"name": "a", "set": {"/channel/velocity_m_s": 2}}])",
        {"list.json: crowd \"a\": /channel/velocity_m_s: 2.0 is not the scene's 1.5", "allowed to differ: /seed"});
    for (const char* set : {R"("/duration_s": 5)", R"("/frame_rate_hz": 60)", R"("/world/length_m": 120)",
                            R"("/fluid/particle_spacing_m": 0.4)", R"("/world/gravity_m_s2": 1)",
                            R"("/channel/initial_river": "filled")", R"("/coupling/agents_stream": "serial")"}) {
        check_refusal(R"([{"name": "ok"}, {"name": "a", "set": {)" + std::string(set) + "}}]",
                      {"list.json: crowd \"a\": /", "all crowds share one water"});
    }
}

TEST_CASE("A water that the agents move cannot be shared") {
    const std::vector<SceneOverride> serial{parse_override("/coupling/agents_stream=serial")};
    CHECK_THROWS_WITH(crowds_of(R"([{"name": "a"}])", serial), Contains("s05.json: /coupling/agents_stream"));
}

TEST_CASE("Names are those of folders, one for each crowd") {
    for (const char* name :
         {R"("")", R"("a/b")", R"("..")", R"(".hidden")", R"("a b")", R"("ä")", "3", "null", R"("-rf")"}) {
        check_refusal(std::string(R"([{"name": )") + name + "}]",
                      {"list.json: /0/name: ", "is not allowed; allowed: 1 to"});
    }
    check_refusal(R"([{"name": ")" + std::string(101, 'a') + R"("}])", {"allowed: 1 to 100"});
    check_refusal(R"([{"name": "a"}, {"name": "a"}])", {"list.json: /1/name: \"a\" is the name of an earlier crowd"});
    check_refusal(R"([{"name": "a"}, {"name": "A"}])", {"list.json: /1/name: \"A\" is the name of an earlier crowd"});
    check_refusal(R"([{"set": {}}])", {"list.json: /0/name: required key"});
    // Files that the programs or scripts leave beside the folders.
    for (const char* name : {"crowds.csv", "Crowds.CSV", "crowds.csv.part", "outcome.json", "fluid_server.log",
                             "figure.png", "water.bin", "trajectories.sqlite", "events.jsonl", "last_sound.state"}) {
        check_refusal(R"([{"name": ")" + std::string(name) + R"("}])",
                      {"list.json: /0/name: \"", "could be a file beside the folders", "allowed: "});
    }
    CHECK(crowds_of(R"([{"name": "tau-0.25"}, {"name": "_a"}, {"name": "csv"}])").size() == 3);
}

TEST_CASE("Errors in what a crowd sets name the list, the crowd, the key, the value and what is allowed") {
    check_refusal(R"([{"name": "a", "set": {"/crowd/tau": 2}}])",
                  {"list.json: crowd \"a\": /crowd/tau: 2 is out of range; allowed: >= 0 and <= 1"});
    check_refusal(R"([{"name": "a", "set": {"/crowd/tua": 0.5}}])",
                  {"list.json: crowd \"a\": /crowd/tua: unknown key"});
    check_refusal(R"([{"name": "a", "set": {"seed": 2}}])", {"list.json: crowd \"a\": \"seed\" is not a JSON pointer"});
    check_refusal(R"([{"name": "a", "set": {"/events/0": {"frame": 1, "agent": 99, "tau": 1}}}])",
                  {"list.json: crowd \"a\": ", "/events/0/agent: there is no agent 99; allowed: 0 to 49"});
    check_refusal(R"([{"name": "a", "set": [1]}])", {"list.json: crowd \"a\": /set: expected an object"});
    check_refusal(R"([{"name": "a", "sett": {}}])", {"list.json: /0: unknown key \"sett\"", "\"set\""});
    check_refusal(R"([{"name": "a", "pictures": 1}])",
                  {"list.json: crowd \"a\": /pictures: 1 is not allowed; allowed: true or false"});
}

TEST_CASE("A crowd has pictures unless it says otherwise") {
    const auto crowds =
        crowds_of(R"([{"name": "a"}, {"name": "b", "pictures": false}, {"name": "c", "pictures": true}])");
    CHECK(crowds[0].pictures);
    CHECK_FALSE(crowds[1].pictures);
    CHECK(crowds[2].pictures);
}

TEST_CASE("A list is not empty and a list") {
    for (const char* list : {"[]", "{}", "3", "[3]", R"([["name"]])"}) check_refusal(list, {"list.json", "expected"});
    check_refusal("[", {"list.json: not valid JSON"});
    check_refusal(R"([{"name": "a", "name": "b"}])", {"stands twice"});
}

TEST_CASE("The example list fits the scenes of the paper") {
    const auto file = std::filesystem::path(WADE_SCENES) / "example_crowds.json";
    CHECK(load_crowds(file, scene_file, {}, load_scene(scene_file)).size() == 6);
}
