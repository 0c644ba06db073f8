// Bodies, hands, ropes and tables of people that cannot be.

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using wade::LoadedScene;
using namespace wade::test;

TEST_CASE("people have bodies of the crowd or of their group, and values may be normal within limits") {
    const std::string two =
        crowd(group("a", 1, 1) + "," + group("b", 2, 2, R"(, "skill": "poor", "can_swim": true, "tau": 0.1)"));
    const LoadedScene loaded =
        load_patched(two, {"/crowd/response=measured", "/crowd/skill=braced", "/crowd/ground_friction=0.3",
                           R"(/crowd/height_m={"min":1.5,"max":2,"mean":1.7,"sd":0.1})"});
    const auto& groups = loaded.scene.crowd->groups;
    CHECK((!groups.at(0).tau && groups.at(1).tau == 0.1));
    CHECK((groups.at(0).body.skill == wade::Skill::braced && groups.at(1).body.skill == wade::Skill::poor));
    CHECK((!groups.at(0).body.can_swim && groups.at(1).body.can_swim));
    CHECK(groups.at(1).body.ground_friction == 0.3);
    CHECK((groups.at(0).body.height->sd == 0.1 && groups.at(1).body.height->mean == 1.7));
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);
    CHECK(load_patched(two, {"/crowd/response=measured", "/crowd/tau=0.4"}).scene.crowd->groups.at(0).tau ==
          std::nullopt);
    CHECK(load_patched(two, {}).scene.crowd->groups.at(0).tau == 0.0);
}

TEST_CASE("impossible bodies and unknown skills are refused by name, value and what is allowed") {
    const std::string one = crowd(group("a", 1, 1));
    const auto refused = [&](const std::string& set) { return refusal(one, {"/crowd/response=measured", set}); };
    CHECK_THAT(refused("/crowd/skill=brave"), Contains("/crowd/skill: \"brave\" is not allowed; allowed: \"braced\""));
    CHECK_THAT(refused("/crowd/height_m=3"), Contains("/crowd/height_m: 3") && Contains("<= 2.5 m"));
    CHECK_THAT(refused("/crowd/height_m=0.1"), Contains("/crowd/height_m: 0.1") && Contains(">= 0.5"));
    CHECK_THAT(refused("/crowd/mass_kg=20"), Contains("/crowd/groups/0/mass_kg: 20 kg with a height of 1.7 m") &&
                                                 Contains("allowed: 23.1 to 289 kg"));
    CHECK_THAT(refused("/crowd/mass_kg=300"), Contains("/crowd/groups/0/mass_kg: 300 kg"));
    CHECK_THAT(
        refused(R"(/crowd/height_m={"min":0.7,"max":1.9})"),
        Contains("/crowd/groups/0/height_m: 0.7 m is no body of a person at an age of 30 years; allowed: 1 to 2.5 m"));
    CHECK_THAT(refused("/crowd/ground_friction=0"), Contains("/crowd/ground_friction: 0"));
    CHECK_THAT(refused(R"(/crowd/height_m={"min":1.5,"max":2,"mean":1.7})"),
               Contains("/crowd/height_m: of mean and sd there is one; allowed: both, or none"));
    CHECK_THAT(refused("/fluid/particle_spacing_m=1.4"), Contains("/fluid/particle_spacing_m: 1.4 m"));
    CHECK_NOTHROW(load_patched(one, {"/crowd/mass_kg=20"}));  // of the paper's response only the mass is asked
}

TEST_CASE("hands that no one has or that do not reach are refused, and keys of bodies where nobody has one") {
    const std::string two = crowd(group("a", 2, 2, R"(, "columns": 2)"));
    const auto refused = [&](const std::vector<std::string>& set) { return refusal(two, set); };
    const std::string hands = "/crowd/groups/0/hand_in_hand=along_x", measured = "/crowd/response=measured";
    CHECK_THAT(refused({hands}),
               Contains("/crowd/groups/0/hand_in_hand: along_x: people that answer the water by tau"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/tau=0.5"}), Contains("hold no others"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/start/pitch_x_m=0.9"}),
               Contains("0.9 m apart (/start/pitch_x_m") && Contains("allowed: <= 0.8 m"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/start/pitch_x_m=0.7", "/crowd/groups/0/start/jitter_m=0.1"}),
               Contains("up to 0.9 m apart"));
    CHECK_NOTHROW(load_patched(two, {hands, measured, "/crowd/groups/0/start/pitch_x_m=0.7"}));
    CHECK_THAT(refused({"/crowd/groups/0/rescuer=true"}),
               Contains("/crowd/groups/0/rescuer: true: people that answer"));
    CHECK_THAT(refused({"/crowd/groups/0/rescuer=true", measured, "/crowd/groups/0/tau=0.5"}), Contains("/rescuer"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/start/pitch_x_m=0.7", "/crowd/groups/0/rescuer=true"}),
               Contains("/crowd/groups/0/rescuer: true: a line takes both hands") && Contains("hand_in_hand \"none\""));
    CHECK_NOTHROW(load_patched(two, {"/crowd/groups/0/rescuer=true", measured}));
    CHECK_THAT(refused({"/crowd/water_temperature_c=-3", measured}),
               Contains("/crowd/water_temperature_c: -3 is out of range; allowed: >= 0"));
    CHECK_THAT(refused({"/crowd/air_budget_s=10", measured}),
               Contains("/crowd/air_budget_s: 10 is out of range; allowed: >= 20 and <= 90 s"));
    CHECK_NOTHROW(load_patched(two, {"/crowd/fatigue=true", "/crowd/water_temperature_c=5", measured}));
}

TEST_CASE("a hazard is a number, low, best and high, or a word") {
    const std::string one = crowd(group("a", 1, 1)), measured = "/crowd/response=measured";
    const auto set = [&](const std::string& value) { return "/crowd/drift_hazard_per_s=" + value; };
    const auto hazard = [&](const std::string& value) {
        return load_patched(one, {measured, set(value)}).scene.crowd->drift_hazard;
    };
    CHECK((hazard("0.01").low == 0.01 && hazard("0.01").best == 0.01 && hazard("0.01").high == 0.01));
    CHECK((hazard("[0, 0.01, 0.1]").low == 0 && hazard("[0, 0.01, 0.1]").high == 0.1));
    CHECK((hazard("under").is_under && hazard("under").best == 0.006 && !hazard("0").is_under));
    const LoadedScene loaded = load_patched(one, {measured, set("[0, 0.01, 0.1]")});
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);
    const auto refused = [&](const std::string& value) { return refusal(one, {measured, set(value)}); };
    CHECK_THAT(refused("2"), Contains("/crowd/drift_hazard_per_s: 2 is out of range; allowed: >= 0 and <= 1 1/s"));
    CHECK_THAT(refused("above"), Contains("\"above\" is not allowed") && Contains("\"under\""));
    CHECK_THAT(refused("true"), Contains("expected a number, an array [low, best, high] or \"under\", found true"));
    for (const std::string value : {"[0.01, 0.002, 0.02]", "[0.002, 0.006]", "[0.002, \"b\", 0.02]", "[0, 0.5, 3]"}) {
        CHECK_THAT(refused(value), Contains("is not allowed; allowed: [low, best, high], low <= best <= high, each"));
    }
}

TEST_CASE("tau in time has its points in order, and belongs to who has a tau") {
    const std::string points = R"([{"time_s":0,"tau":0.2},{"time_s":5,"tau":1},{"time_s":5,"tau":0}])";
    const std::string two = crowd(group("a", 1, 1) + "," + group("b", 2, 2));
    const std::string measured = "/crowd/response=measured", of_group = "/crowd/groups/1/tau_history=";
    const auto refused = [&](const std::vector<std::string>& set) { return refusal(two, set); };
    const LoadedScene loaded = load_patched(two, {measured, of_group + points});
    CHECK((loaded.scene.crowd->groups.at(1).tau_history.size() == 3 && loaded.scene.crowd->groups.at(1).tau == 0.2));
    CHECK(!loaded.scene.crowd->groups.at(0).tau);  // answers by its body
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);

    CHECK_THAT(refused({of_group + R"([{"time_s":3,"tau":0.2},{"time_s":2,"tau":1}])"}),
               Contains("/crowd/groups/1/tau_history/1/time_s: 2 s is earlier than that of the point before; allowed: "
                        ">= 3 s."));
    CHECK_THAT(refused({of_group + R"([{"time_s":3,"tau":1.2}])"}),
               Contains("/crowd/groups/1/tau_history/0/tau: 1.2 is out of range; allowed: >= 0 and <= 1."));
    CHECK_THAT(refused({of_group + R"([{"tau":1}])"}), Contains("/crowd/groups/1/tau_history/0/time_s"));
    const std::string of_one = R"(/crowd/people=[{"tau_history":)" + points + "}]";
    CHECK_NOTHROW(load_patched(two, {of_one}));
    CHECK_THAT(refused({of_one, measured, "/crowd/groups/0/tau=0.5"}),
               Contains("/crowd/people/0/tau_history: a person of group \"b\" answers the water by its body and has no "
                        "tau"));
    CHECK_NOTHROW(load_patched(two, {of_one, measured, "/crowd/groups/0/tau=0", "/crowd/groups/1/tau=0"}));
}

TEST_CASE("ropes that lead nowhere are refused") {
    const std::string one = crowd(group("a", 1, 1));
    const auto refused = [&](const std::string& rope) {
        return refusal(one, {"/crowd/response=measured", "/crowd/ropes=[{" + rope + "}]"});
    };
    const std::string from = R"("from": {"x_m": 5, "z_m": 6})", to = R"("to": {"x_m": 5, "z_m": 9})";
    CHECK_THAT(refusal(one, {"/crowd/ropes=[{" + from + "," + to + "}]"}),
               Contains("/crowd/ropes/0: people that answer the water by tau hold no rope"));
    CHECK_THAT(refused(to), Contains("/crowd/ropes/0/from"));
    CHECK_THAT(refused(from), Contains("/crowd/ropes/0: a rope has either a second end, to, or a free one"));
    CHECK_THAT(refused(from + "," + to + R"(, "free_length_m": 3)"), Contains("allowed: one of both"));
    CHECK_THAT(refused(from + R"(, "to": {"x_m": 5})"), Contains("/crowd/ropes/0/to: an end has x_m and z_m"));
    CHECK_THAT(refused(from + R"(, "to": {"x_m": 5, "z_m": 6})"), Contains("both ends are at one place"));
    CHECK_THAT(refused(from + R"(, "to": {"x_m": 5, "z_m": 6000})"), Contains("outside the world"));
    CHECK_THAT(refused(from + R"(, "free_length_m": -1)"), Contains("/crowd/ropes/0/free_length_m: -1"));
    CHECK(load_patched(one, {"/crowd/response=measured", "/crowd/ropes=[{" + from + R"(, "free_length_m": 3}])"})
              .scene.crowd->ropes.size() == 1);
}

TEST_CASE("people come from a table beside the scene, and a bad line is named with file, line, column and value") {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& table, const std::string& response = "measured") {
        folder.write("people.csv", table);
        return wade::load_scene(folder.write(
            "scene.json", R"({"channel": {"x_min_m": 0, "x_max_m": 40, "z_min_m": 0, "z_max_m": 30, "flow": "closed"},
                "crowd": {"people_csv": "people.csv", "response": ")" +
                              response + R"(", "groups": [)" + group("a", 1, 1) + "]}}"));
    };
    const auto refused = [&](const std::string& table) {
        try {
            load(table);
        } catch (const wade::ConfigurationError& error) {
            return std::string(error.what());
        }
        return std::string("nothing is refused");
    };
    const LoadedScene loaded =
        load("# of a census\nheight_m, mass_kg, sex,can_swim\n1.2,30,female,true\r\n1.9,90,,false\n");
    REQUIRE(loaded.scene.crowd->people.size() == 2);
    CHECK((loaded.scene.crowd->people[0].height == 1.2 && loaded.scene.crowd->people[0].can_swim == true));
    CHECK((loaded.scene.crowd->people[1].mass == 90.0 && !loaded.scene.crowd->people[1].sex));
    CHECK(wade::load_scene_text(loaded.canonical_json, "elsewhere.json").canonical_json == loaded.canonical_json);

    CHECK_THAT(refused("height_m\n1.7\n5\n"),
               Contains("people.csv: line 3: /height_m: 5 is out of range; allowed: >= 0.5"));
    CHECK_THAT(refused("height_m\ntall\n"), Contains("people.csv: line 2: /height_m") && Contains("\"tall\""));
    CHECK_THAT(refused("skill\nbrave\n"), Contains("people.csv: line 2: /skill: \"brave\" is not allowed"));
    CHECK_THAT(refused("height\n1.7\n"),
               Contains("people.csv: line 1: there is no column \"height\"; allowed: ") && Contains("height_m [m]"));
    CHECK_THAT(refused("height_m,mass_kg\n1.7\n"), Contains("people.csv: line 2: 1 values; allowed: 2"));
    CHECK_THAT(refused("height_m,mass_kg\n1.7,5\n"),
               Contains("people.csv: line 2: /mass_kg: 5 kg with a height of 1.7 m"));
    CHECK_THAT(refused("height_m\n"), Contains("people.csv: there are no people"));
    const auto with_tau = load("height_m,tau_history\n1.7,0:0.2 5:0.8\n1.8,\n", "paper").scene.crowd->people;
    CHECK((with_tau.at(0).tau_history.at(1).time == 5 && with_tau.at(0).tau_history.at(1).tau == 0.8));
    CHECK(with_tau.at(1).tau_history.empty());
    CHECK_THAT(refused("tau_history\n0:0.2 3:1.5\n"),
               Contains("people.csv: line 2: /tau_history/1/tau: 1.5 is out of range"));
    CHECK_THAT(refused("tau_history\n0:0.2 3\n"),
               Contains("people.csv: line 2: /tau_history: expected an array, found \"0:0.2 3\""));
    CHECK_THAT(refused("tau_history\n3:0.2 2:1\n"), Contains("/crowd/people/0/tau_history/1/time_s: 2 s is earlier"));
    CHECK_THAT(refusal(R"({"crowd": {"people_csv": "none.csv"}})", {}),
               Contains("/crowd/people_csv: the file none.csv cannot be read"));
}

TEST_CASE("fewer than 2 frames or steps a second are warned of where people by their bodies meet changing water") {
    const auto warnings = [](std::vector<std::string> assignments) {
        assignments.emplace_back("/crowd/paths/rate_hz=0.5");
        return wade::rate_warnings(load_patched(crowd(group("a", 1, 1)), assignments).scene);
    };
    const std::string measured = "/crowd/response=measured", solved = "/fluid/model=shallow_water",
                      river = "/channel/flow=emitter";
    const auto rare = warnings({measured, solved, river, "/channel/velocity_m_s=1", "/frame_rate_hz=1"});
    REQUIRE(rare.size() == 1);
    CHECK_THAT(rare[0],
               Contains("/frame_rate_hz: 1 frames of the water a second") && Contains("Remedy: /frame_rate_hz 2"));
    const auto long_steps = warnings({measured, solved, river, "/channel/velocity_m_s=1", "/crowd/step_rate_hz=0.5"});
    REQUIRE(long_steps.size() == 1);
    CHECK_THAT(long_steps[0], Contains("/crowd/step_rate_hz: 0.5 steps"));
    CHECK(warnings({measured, solved, river, "/channel/velocity_m_s=1", "/frame_rate_hz=2"}).empty());
    CHECK(warnings({solved, river, "/channel/velocity_m_s=1", "/frame_rate_hz=1"}).empty());
    CHECK(warnings({measured, "/crowd/groups/0/tau=0.5", solved, river, "/channel/velocity_m_s=1", "/frame_rate_hz=1"})
              .empty());
    CHECK(warnings({measured, "/fluid/model=kinematic", river, "/channel/initial_river=filled",
                    "/channel/velocity_m_s=1", "/frame_rate_hz=1"})
              .empty());
    CHECK(warnings({measured, "/fluid/model=kinematic", river, "/channel/velocity_m_s=1", "/frame_rate_hz=1"}).size() ==
          1);
}
