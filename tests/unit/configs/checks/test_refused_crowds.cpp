// Agents, markers and events that cannot be.

#include <cmath>

#include "configs/errors/exit_code.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using wade::LoadedScene;
using namespace wade::test;

namespace {

const std::string obstacle =
    R"("obstacles": [{"x_min_m": 10, "x_max_m": 12, "z_min_m": 20, "z_max_m": 22, "height_m": 1}])";

std::string crowd(const std::string& groups, const std::string& more = "") {
    return R"({"crowd": {"groups": [)" + groups + "]}" + more + "}";
}

}  // namespace

TEST_CASE("an agent that starts inside an obstacle is refused") {
    CHECK_THAT(
        refusal(crowd(group("a", 11, 19, R"(, "rows": 3)"), "," + obstacle)),
        Equals(
            "scene.json: /crowd/groups/0/start: agent 1 at (x 11 m, z 20 m) is inside /obstacles/0; allowed: anywhere "
            "but x 10 to 12 m with z 20 to 22 m."));
}

TEST_CASE("a goal inside an obstacle is refused") {
    CHECK_THAT(refusal(crowd(group("a", 1, 1), "," + obstacle),
                       {"/crowd/groups/0/goal/x_m=11", "/crowd/groups/0/goal/z_m=21"}),
               Contains("/crowd/groups/0/goal: the goal of group \"a\" at (x 11 m, z 21 m) is inside /obstacles/0"));
}

TEST_CASE("agents and goals outside the world are refused; its edge is inside") {
    CHECK_THAT(
        refusal(crowd(group("a", 99, 1, R"(, "columns": 3)"))),
        Equals("scene.json: /crowd/groups/0/start: agent 2 at (x 101 m, z 1 m) is outside the world; allowed: x 0 to "
               "100 m, z 0 to 50 m."));
    CHECK_THAT(refusal(crowd(group("a", 1, 1)), {"/crowd/groups/0/goal/z_m=50.1"}),
               Contains("/crowd/groups/0/goal: the goal of group \"a\" at (x 75 m, z 50.1 m) is outside the world"));
    CHECK(load_patched(crowd(group("a", 0, 0))).scene.crowd.groups.at(0).goal_z == 50);
}

TEST_CASE("a world with periodic ends has whole cells, people before its end and water that goes round") {
    const std::string ring = R"(, "world": {"length_m": 40, "ends": "periodic"})";
    const std::string round =
        R"(, "channel": {"x_min_m": 0, "x_max_m": 40, "flow": "recirculating", "initial_river": "filled"})";
    const LoadedScene loaded = load_patched(crowd(group("a", 1, 1), ring + round), {"/crowd/groups/0/goal/x_m=-4000"});
    CHECK(loaded.scene.world.period() == 40);
    CHECK(loaded.scene.crowd.groups.at(0).goal_x == -4000);
    CHECK(load_patched(crowd(group("a", 1, 1))).scene.world.period() == 0);

    CHECK_THAT(refusal(crowd(group("a", 1, 1), ring + round), {"/world/length_m=41"}),
               Contains("/world/length_m: 41 m cannot be the length of a world with periodic ends; allowed: 6 m, 8 m"));
    CHECK_THAT(refusal(crowd(group("a", 40, 1), ring + round)),
               Contains("/crowd/groups/0/start: an agent starts at x 40 m, which in a world with periodic ends is x 0 "
                        "m; allowed: x < 40 m."));
    CHECK_THAT(refusal(crowd(group("a", 1, 1), ring + round), {"/channel/x_max_m=38"}),
               Contains("/world/ends: \"periodic\" does not go with water that ends; allowed: \"open\", or a channel "
                        "from x 0 to 40 m with flow \"recirculating\" or \"periodic\""));
    CHECK_THAT(refusal(crowd(group("a", 1, 1)), {"/crowd/groups/0/goal/x_m=-1"}),
               Contains("the goal of group \"a\" at (x -1 m, z 50 m) is outside the world"));
}

TEST_CASE("two agents within a millimetre are refused") {
    CHECK_THAT(
        refusal(crowd(group("a", 1, 1, R"(, "columns": 3)") + "," + group("b", 3.0005, 1))),
        Equals("scene.json: /crowd/groups/1/start: agents 2 and 3 start at one place, (x 3.0005 m, z 1 m); allowed: a "
               "distance >= 0.001 m."));
    CHECK_THAT(refusal(crowd(group("a", 1, 1, R"(, "columns": 2)")), {"/crowd/groups/0/start/pitch_x_m=0"}),
               Contains("agents 0 and 1 start at one place"));
    CHECK(load_patched(crowd(group("a", 1, 1) + "," + group("b", 1.0011, 1))).scene.crowd.groups.size() == 2);
}

TEST_CASE("starts that are drawn at random need no distance on the grid") {
    const std::string heap = crowd(group("a", 1, 1, R"(, "columns": 9)") + "," + group("b", 1, 1));
    CHECK_THAT(refusal(heap), Contains("agents 0 and 9 start at one place"));
    CHECK(load_patched(heap, {"/crowd/groups/0/start/pitch_x_m=0", "/crowd/groups/0/start/jitter_m=2"})
              .scene.crowd.groups.at(0)
              .count == 9);
    CHECK_THAT(refusal(heap, {"/crowd/groups/1/start/jitter_m=2", "/crowd/groups/0/start/pitch_x_m=0"}),
               Contains("agents 0 and 1 start at one place"));
}

TEST_CASE("more agents than places are refused; fewer leave the last row incomplete") {
    CHECK_THAT(
        refusal(crowd(group("a", 1, 1, R"(, "columns": 3, "rows": 2, "count": 7)"))),
        Equals("scene.json: /crowd/groups/0/count: 7 agents do not fit on the start grid of 3 columns and 2 rows; "
               "allowed: <= 6."));
    CHECK_THAT(refusal(crowd(group("a", 1, 1, R"(, "columns": 100000, "rows": 100000)"))),
               Contains("/crowd/groups/0/count: 10000000000 is out of range; allowed: >= 1 and <= 1000000."));
    CHECK(
        load_patched(crowd(group("a", 1, 1, R"(, "columns": 3, "rows": 2, "count": 4)"))).scene.crowd.groups[0].count ==
        4);
    CHECK(load_patched(crowd(group("a", 1, 1, R"(, "columns": 3, "rows": 2)"))).scene.crowd.groups[0].count == 6);
}

TEST_CASE("two groups of one name are refused") {
    CHECK_THAT(refusal(crowd(group("a", 1, 1) + "," + group("a", 5, 5))),
               Contains("/crowd/groups/1/name: \"a\" is the name of an earlier group"));
}

TEST_CASE("markers that do not fit into a cell are refused with the largest distance") {
    // sqrt(8 / (64 pi)) = 0.199471 m
    CHECK_THAT(refusal("{}", {"/crowd/marker_min_distance_m=0.2"}),
               Equals("scene.json: /crowd/marker_min_distance_m: 0.2 m is too large for 64 markers to fit at random "
                      "into a cell of "
                      "2 x 2 m; allowed: <= 0.199471 m."));
    CHECK(load_patched("{}", {"/crowd/marker_min_distance_m=0.199"}).scene.crowd.marker_min_distance == 0.199);
}

TEST_CASE("groups that set no tau, mass or speed take the crowd's") {
    const LoadedScene loaded = load_patched(
        crowd(group("a", 1, 1) + "," + group("b", 5, 5, R"(, "tau": 0.9, "mass_kg": 80, "desired_speed_m_s": 2)")),
        {"/crowd/tau=0.2", "/crowd/mass_kg=70", "/crowd/desired_speed_m_s=1.1"});
    const auto& groups = loaded.scene.crowd.groups;
    CHECK(groups.at(0).tau == 0.2);
    CHECK(groups.at(0).mass == 70);
    CHECK(groups.at(0).desired_speed == 1.1);
    CHECK(groups.at(1).tau == 0.9);
    CHECK(groups.at(1).mass == 80);
    CHECK(groups.at(1).desired_speed == 2);
}

TEST_CASE("groups are given their own tau, mass or speed over the crowd's") {
    const auto tau_of = [](const LoadedScene& loaded) { return loaded.scene.crowd.groups.at(0).tau; };
    const std::string crowd_has_it = R"({"crowd": {"tau": 0.2, "groups": [)" + group("a", 1, 1) + "]}}";
    CHECK(tau_of(load_patched(crowd_has_it, {"/crowd/groups/0/tau=0.9"})) == 0.9);
    CHECK(tau_of(load_patched(crowd_has_it, {"/crowd/tau=0.3"})) == 0.3);
    CHECK(tau_of(load_patched(crowd_has_it, {R"(/crowd={"groups": [)" + group("b", 5, 5, R"(, "tau": 0.9)") + "]}"})) ==
          0.9);
    const TemporaryFolder folder;
    std::string parent = dry_scene;
    parent.insert(parent.size() - 1, R"(, "crowd": {"tau": 0.2, "groups": [)" + group("a", 1, 1) + "]}");
    folder.write("parent.json", parent);
    const std::string own = R"({"groups": [)" + group("b", 5, 5, R"(, "tau": 0.9)") + "]}";
    CHECK(tau_of(wade::load_scene(folder.write("child.json", R"({"extends": "parent.json", "crowd": )" + own + "}"))) ==
          0.9);
    CHECK_THAT(refusal(crowd_has_it, {"/crowd/groups/0/tau=0.9", "/crowd/tau=0.3"}),
               Contains("/crowd/tau: 0.3 has no effect"));
}

TEST_CASE("a crowd's tau that no group takes is refused") {
    CHECK_THAT(
        refusal(crowd(group("a", 1, 1, R"(, "tau": 0.9)")), {"/crowd/tau=0.2"}),
        Contains("/crowd/tau: 0.2 has no effect, as every group sets its own; set /crowd/groups/0/tau instead."));
}

TEST_CASE("an event's time becomes the first frame at or after it") {
    const auto frame = [](double time, double rate) {
        return load_patched("{}", {"/frame_rate_hz=" + std::to_string(rate), "/events/0/tau=0",
                                   "/events/0/time_s=" + std::to_string(time)})
            .scene.events.at(0)
            .frame;
    };
    CHECK(frame(0, 30) == 0);
    CHECK(frame(29, 30) == 870);
    CHECK(frame(0.1, 30) == 3);  // 0.1 * 30 is above 3 by rounding
    CHECK(frame(0.101, 30) == 4);
    CHECK(frame(0.01, 30) == 1);
}

TEST_CASE("an event needs exactly one of frame and time") {
    CHECK_THAT(
        refusal(R"({"events": [{"tau": 0}]})"),
        Equals("scene.json: /events/0: an event needs exactly one of \"frame\" and \"time_s\", and has neither."));
    CHECK_THAT(refusal(R"({"events": [{"tau": 0, "frame": 1, "time_s": 1}]})"),
               Contains("/events/0: ") && Contains("has both."));
}

TEST_CASE("an event that names nobody is refused") {
    const std::string two = group("a", 1, 1, R"(, "columns": 2)") + "," + group("b", 5, 5);
    CHECK_THAT(refusal(crowd(two, R"(, "events": [{"tau": 0, "frame": 1, "agent": 3}])")),
               Equals("scene.json: /events/0/agent: there is no agent 3; allowed: 0 to 2."));
    CHECK_THAT(refusal(crowd(two, R"(, "events": [{"tau": 0, "frame": 1, "group": "c"}])")),
               Equals("scene.json: /events/0/group: there is no group \"c\"; allowed: \"a\", \"b\"."));
    CHECK_THAT(refusal(R"({"events": [{"tau": 0, "frame": 1, "agent": 0}]})"), Contains("as the scene has no agents."));
    CHECK_THAT(refusal(R"({"events": [{"tau": 0, "frame": 1, "group": "a"}]})"),
               Contains("as the scene has no groups."));
    CHECK_THAT(refusal(crowd(two, R"(, "events": [{"tau": 0, "frame": 1, "agent": 1, "group": "a"}])")),
               Contains("/events/0: an event names an agent or a group, not both."));
}

TEST_CASE("events keep their order and whom they name") {
    const LoadedScene loaded = load_patched(crowd(
        group("a", 1, 1),
        R"(, "events": [{"tau": 0.1, "frame": 9}, {"tau": 0.2, "frame": 3, "agent": 0}, {"tau": 0.3, "frame": 3, "group": "a"}])"));
    const auto& events = loaded.scene.events;
    REQUIRE(events.size() == 3);
    CHECK((!events[0].agent && !events[0].group && events[0].frame == 9 && events[0].tau == 0.1));
    CHECK((events[1].agent == 0 && !events[1].group && events[1].tau == 0.2));
    CHECK((!events[2].agent && events[2].group == "a" && events[2].tau == 0.3));
}

TEST_CASE("a ragdoll by v_F needs a channel whose velocity the scene sets") {
    const std::string closed = R"({"channel": {"flow": "closed"}})";
    CHECK_THAT(refusal(closed, {"/crowd/ragdoll/condition=paper"}),
               Contains("/crowd/ragdoll/condition: \"paper\" asks for v_F, and nothing sets the speed of a closed "
                        "channel; allowed: \"off\", \"local_speed\", \"depth_speed\", or flow"));
    const LoadedScene loaded = load_patched(closed, {"/crowd/ragdoll/condition=depth_speed"});
    CHECK(loaded.scene.crowd.ragdoll.condition == wade::RagdollCondition::depth_speed);
    CHECK_THAT(refusal("{}", {"/crowd/ragdoll/tau_min=1.5"}), Contains("/crowd/ragdoll/tau_min"));
}

TEST_CASE("tau and mass are numbers or limits, of the crowd or of a group") {
    const std::string two = crowd(group("a", 1, 1) + "," + group("b", 2, 2, R"(, "tau": {"min": 0.1, "max": 0.2})"));
    const auto load = [&](const std::string& last) {
        return load_patched(two,
                            {R"(/crowd/tau={"min":0.4,"max":0.8})", R"(/crowd/mass_kg={"min":40,"max":100})", last});
    };
    const LoadedScene loaded = load("/seed=1");
    const auto& groups = loaded.scene.crowd.groups;
    CHECK((groups.at(0).tau->lo == 0.4 && groups.at(0).tau->hi == 0.8));
    CHECK((groups.at(1).tau->lo == 0.1 && groups.at(1).tau->hi == 0.2));
    CHECK((groups.at(1).mass.lo == 40 && groups.at(1).mass.hi == 100));
    CHECK(load("/crowd/tau=0.5").scene.crowd.groups.at(0).tau == 0.5);
    CHECK(load("/crowd/tau/max=0.9").scene.crowd.groups.at(0).tau->hi == 0.9);
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);
}

TEST_CASE("people have bodies of the crowd or of their group, and values may be normal within limits") {
    const std::string two =
        crowd(group("a", 1, 1) + "," + group("b", 2, 2, R"(, "skill": "poor", "can_swim": true, "tau": 0.1)"));
    const LoadedScene loaded =
        load_patched(two, {"/crowd/response=measured", "/crowd/skill=braced", "/crowd/ground_friction=0.3",
                           R"(/crowd/height_m={"min":1.5,"max":2,"mean":1.7,"sd":0.1})"});
    const auto& groups = loaded.scene.crowd.groups;
    CHECK((!groups.at(0).tau && groups.at(1).tau == 0.1));
    CHECK((groups.at(0).body.skill == wade::Skill::braced && groups.at(1).body.skill == wade::Skill::poor));
    CHECK((!groups.at(0).body.can_swim && groups.at(1).body.can_swim));
    CHECK(groups.at(1).body.ground_friction == 0.3);
    CHECK((groups.at(0).body.height.sd == 0.1 && groups.at(1).body.height.mean == 1.7));
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);
    CHECK(load_patched(two, {"/crowd/response=measured", "/crowd/tau=0.4"}).scene.crowd.groups.at(0).tau ==
          std::nullopt);
    CHECK(load_patched(two, {}).scene.crowd.groups.at(0).tau == 0.0);
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
    CHECK_THAT(refused(R"(/crowd/height_m={"min":0.7,"max":1.9})"), Contains("65 kg with a height of 0.7 m"));
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
    CHECK_THAT(refused({hands}), Contains("/crowd/groups/0/hand_in_hand: along_x: people who answer the water by tau"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/tau=0.5"}), Contains("hold nobody"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/start/pitch_x_m=0.9"}),
               Contains("0.9 m apart (/start/pitch_x_m") && Contains("allowed: <= 0.8 m"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/start/pitch_x_m=0.7", "/crowd/groups/0/start/jitter_m=0.1"}),
               Contains("up to 0.9 m apart"));
    CHECK_NOTHROW(load_patched(two, {hands, measured, "/crowd/groups/0/start/pitch_x_m=0.7"}));
    CHECK_THAT(refused({"/crowd/groups/0/rescuer=true"}), Contains("/crowd/groups/0/rescuer: true: people who answer"));
    CHECK_THAT(refused({"/crowd/groups/0/rescuer=true", measured, "/crowd/groups/0/tau=0.5"}), Contains("/rescuer"));
    CHECK_THAT(refused({hands, measured, "/crowd/groups/0/start/pitch_x_m=0.7", "/crowd/groups/0/rescuer=true"}),
               Contains("/crowd/groups/0/rescuer: true: a line takes both hands") && Contains("hand_in_hand \"none\""));
    CHECK_NOTHROW(load_patched(two, {"/crowd/groups/0/rescuer=true", measured}));
    CHECK_THAT(refused({"/crowd/helping=true"}), Contains("/crowd/helping: true") && Contains("\"measured\""));
    CHECK_NOTHROW(load_patched(two, {"/crowd/helping=true", measured}));
    CHECK_THAT(refused({"/crowd/fatigue=true"}), Contains("/crowd/fatigue: true") && Contains("\"measured\""));
    CHECK_THAT(refused({"/crowd/water_temperature_c=5"}),
               Contains("/crowd/water_temperature_c: 5 C: people who answer"));
    CHECK_THAT(refused({"/crowd/water_temperature_c=-3", measured}),
               Contains("/crowd/water_temperature_c: -3 is out of range; allowed: >= 0"));
    CHECK_NOTHROW(load_patched(two, {"/crowd/fatigue=true", "/crowd/water_temperature_c=5", measured}));
}

TEST_CASE("tau in time has its points in order, and belongs to who has a tau") {
    const std::string points = R"([{"time_s":0,"tau":0.2},{"time_s":5,"tau":1},{"time_s":5,"tau":0}])";
    const std::string two = crowd(group("a", 1, 1) + "," + group("b", 2, 2));
    const std::string measured = "/crowd/response=measured", of_group = "/crowd/groups/1/tau_history=";
    const auto refused = [&](const std::vector<std::string>& set) { return refusal(two, set); };
    const LoadedScene loaded = load_patched(two, {measured, of_group + points});
    CHECK((loaded.scene.crowd.groups.at(1).tau_history.size() == 3 && loaded.scene.crowd.groups.at(1).tau == 0.2));
    CHECK(!loaded.scene.crowd.groups.at(0).tau);  // answers by its body
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
               Contains("/crowd/ropes/0: people who answer the water by tau hold no rope"));
    CHECK_THAT(refused(to), Contains("/crowd/ropes/0/from"));
    CHECK_THAT(refused(from), Contains("/crowd/ropes/0: a rope has either a second end, to, or a free one"));
    CHECK_THAT(refused(from + "," + to + R"(, "free_length_m": 3)"), Contains("allowed: one of both"));
    CHECK_THAT(refused(from + R"(, "to": {"x_m": 5})"), Contains("/crowd/ropes/0/to: an end has x_m and z_m"));
    CHECK_THAT(refused(from + R"(, "to": {"x_m": 5, "z_m": 6})"), Contains("both ends are at one place"));
    CHECK_THAT(refused(from + R"(, "to": {"x_m": 5, "z_m": 6000})"), Contains("outside the world"));
    CHECK_THAT(refused(from + R"(, "free_length_m": -1)"), Contains("/crowd/ropes/0/free_length_m: -1"));
    CHECK(load_patched(one, {"/crowd/response=measured", "/crowd/ropes=[{" + from + R"(, "free_length_m": 3}])"})
              .scene.crowd.ropes.size() == 1);
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
    REQUIRE(loaded.scene.crowd.people.size() == 2);
    CHECK((loaded.scene.crowd.people[0].height == 1.2 && loaded.scene.crowd.people[0].can_swim == true));
    CHECK((loaded.scene.crowd.people[1].mass == 90.0 && !loaded.scene.crowd.people[1].sex));
    CHECK(wade::load_scene_text(loaded.canonical_json, "elsewhere.json").canonical_json == loaded.canonical_json);

    CHECK_THAT(refused("height_m\n1.7\n5\n"),
               Contains("people.csv, line 3: /height_m: 5 is out of range; allowed: >= 0.5"));
    CHECK_THAT(refused("height_m\ntall\n"), Contains("people.csv, line 2: /height_m") && Contains("\"tall\""));
    CHECK_THAT(refused("skill\nbrave\n"), Contains("people.csv, line 2: /skill: \"brave\" is not allowed"));
    CHECK_THAT(refused("height\n1.7\n"), Contains("people.csv, line 2: /height: unknown key") && Contains("height_m"));
    CHECK_THAT(refused("height_m,mass_kg\n1.7\n"), Contains("people.csv, line 2: there are 1 values; allowed: 2"));
    CHECK_THAT(refused("height_m,mass_kg\n1.7,5\n"), Contains("/crowd/people/0/mass_kg: 5 kg with a height of 1.7 m"));
    CHECK_THAT(refused("height_m\n"), Contains("people.csv: there are no people"));
    const auto with_tau = load("height_m,tau_history\n1.7,0:0.2 5:0.8\n1.8,\n", "paper").scene.crowd.people;
    CHECK((with_tau.at(0).tau_history.at(1).time == 5 && with_tau.at(0).tau_history.at(1).tau == 0.8));
    CHECK(with_tau.at(1).tau_history.empty());
    CHECK_THAT(refused("tau_history\n0:0.2 3:1.5\n"),
               Contains("people.csv, line 2: /tau_history/1/tau: 1.5 is out of range"));
    CHECK_THAT(refused("tau_history\n0:0.2 3\n"),
               Contains("people.csv, line 2: /tau_history: expected an array, found \"0:0.2 3\""));
    CHECK_THAT(refused("tau_history\n3:0.2 2:1\n"), Contains("/crowd/people/0/tau_history/1/time_s: 2 s is earlier"));
    CHECK_THAT(refusal(R"({"crowd": {"people_csv": "none.csv"}})", {}),
               Contains("/crowd/people_csv: the file none.csv cannot be read"));
}

TEST_CASE("limits that are out of range, incomplete or the wrong way round are refused") {
    const std::string one = crowd(group("a", 1, 1));
    CHECK_THAT(refusal(one, {R"(/crowd/tau={"min":0.8,"max":0.4})"}),
               Contains("scene.json: /crowd/tau: min 0.8 is above max 0.4; allowed: min <= max."));
    CHECK_THAT(refusal("{}", {R"(/crowd/tau={"min":0.9,"max":0.1})"}),
               Contains("/crowd/tau: min 0.9 is above max 0.1"));
    CHECK_THAT(refusal(one, {R"(/crowd/mass_kg={"min":90,"max":40})"}), Contains("/crowd/mass_kg: min 90"));
    CHECK_THAT(refusal(one, {R"(/crowd/groups/0/tau={"min":0.8,"max":0.4})"}),
               Contains("/crowd/groups/0/tau: min 0.8 is above max 0.4"));
    CHECK_THAT(refusal(one, {R"(/crowd/tau={"min":0.8,"max":1.4})"}),
               Contains("/crowd/tau/max: 1.4 is out of range; allowed: >= 0 and <= 1"));
    CHECK_THAT(refusal(one, {R"(/crowd/mass_kg={"min":0,"max":1})"}),
               Contains("/crowd/mass_kg/min: 0 is out of range"));
    CHECK_THAT(refusal(one, {R"(/crowd/tau={"min":0.8})"}),
               Contains("/crowd/tau/max: required key \"max\" is missing"));
    CHECK_THAT(refusal(one, {R"(/crowd/tau={"min":0.1,"mox":0.8})"}),
               Contains("/crowd/tau/mox: unknown key \"mox\"; the nearest known key is \"max\""));
    CHECK_THAT(refusal(one, {R"(/crowd/tau="much")"}),
               Contains("/crowd/tau: expected a number or an object {\"min\": ..., \"max\": ...}, found"));
    CHECK_THAT(refusal(one, {"/crowd/tau=0.2", "/crowd/tau/max=0.5"}),
               Contains(R"(/crowd/tau is no object and no array)") &&
                   Contains(R"(it may be an object: /crowd/tau={"min":...,"max":...}.)"));
    CHECK_THAT(refusal(one, {"/seed/max=0.5"}), Contains("nothing lies below it."));
    CHECK_THAT(refusal(one, {"/crowd/groups/0/start/jitter_m=-1"}), Contains("/crowd/groups/0/start/jitter_m: -1"));
}

TEST_CASE("sampling the water within a step needs the rule continuous") {
    CHECK_THAT(
        refusal("{}", {"/coupling/sampling_rate_hz=120"}),
        Equals("scene.json: /coupling/sampling_rate_hz: 120 1/s: the rule \"per_frame\" takes the water once a step; "
               "allowed: 0, or any rate with the rule \"continuous\"."));
    CHECK(load_patched("{}", {"/coupling/rule=continuous", "/coupling/sampling_rate_hz=120"})
              .scene.coupling.sampling_rate == 120);
}
