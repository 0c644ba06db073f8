// Agents, markers and events that cannot be.

#include <cmath>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using wade::LoadedScene;
using namespace wade::test;

namespace {

const std::string obstacle =
    R"("obstacles": [{"x_min_m": 10, "x_max_m": 12, "z_min_m": 20, "z_max_m": 22, "height_m": 1}])";

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
    CHECK(load_patched(crowd(group("a", 0, 0))).scene.crowd->groups.at(0).goal_z == 50);
}

TEST_CASE("a world with periodic ends has whole cells, people before its end and water that goes round") {
    const std::string ring = R"(, "world": {"length_m": 40, "ends": "periodic"})";
    const std::string round =
        R"(, "channel": {"x_min_m": 0, "x_max_m": 40, "flow": "recirculating", "initial_river": "filled"})";
    const LoadedScene loaded = load_patched(crowd(group("a", 1, 1), ring + round), {"/crowd/groups/0/goal/x_m=-4000"});
    CHECK(loaded.scene.world->period() == 40);
    CHECK(loaded.scene.crowd->groups.at(0).goal_x == -4000);
    CHECK(load_patched(crowd(group("a", 1, 1))).scene.world->period() == 0);

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
    CHECK(load_patched(crowd(group("a", 1, 1) + "," + group("b", 1.0011, 1))).scene.crowd->groups.size() == 2);
}

TEST_CASE("starts that are drawn at random need no distance on the grid") {
    const std::string heap = crowd(group("a", 1, 1, R"(, "columns": 9)") + "," + group("b", 1, 1));
    CHECK_THAT(refusal(heap), Contains("agents 0 and 9 start at one place"));
    CHECK(load_patched(heap, {"/crowd/groups/0/start/pitch_x_m=0", "/crowd/groups/0/start/jitter_m=2"})
              .scene.crowd->groups.at(0)
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
    CHECK(load_patched(crowd(group("a", 1, 1, R"(, "columns": 3, "rows": 2, "count": 4)")))
              .scene.crowd->groups[0]
              .count == 4);
    CHECK(load_patched(crowd(group("a", 1, 1, R"(, "columns": 3, "rows": 2)"))).scene.crowd->groups[0].count == 6);
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
    CHECK(load_patched("{}", {"/crowd/marker_min_distance_m=0.199"}).scene.crowd->marker_min_distance == 0.199);
}

TEST_CASE("groups that set no tau, mass or speed take the crowd's") {
    const LoadedScene loaded = load_patched(
        crowd(group("a", 1, 1) + "," + group("b", 5, 5, R"(, "tau": 0.9, "mass_kg": 80, "desired_speed_m_s": 2)")),
        {"/crowd/tau=0.2", "/crowd/mass_kg=70", "/crowd/desired_speed_m_s=1.1"});
    const auto& groups = loaded.scene.crowd->groups;
    CHECK(groups.at(0).tau == 0.2);
    CHECK(groups.at(0).mass == 70);
    CHECK(groups.at(0).desired_speed == 1.1);
    CHECK(groups.at(1).tau == 0.9);
    CHECK(groups.at(1).mass == 80);
    CHECK(groups.at(1).desired_speed == 2);
}

TEST_CASE("groups are given their own tau, mass or speed over the crowd's") {
    const auto tau_of = [](const LoadedScene& loaded) { return loaded.scene.crowd->groups.at(0).tau; };
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
    CHECK(loaded.scene.crowd->ragdoll.condition == wade::RagdollCondition::depth_speed);
    CHECK_THAT(refusal("{}", {"/crowd/ragdoll/tau_min=1.5"}), Contains("/crowd/ragdoll/tau_min"));
}

TEST_CASE("tau and mass are numbers or limits, of the crowd or of a group") {
    const std::string two = crowd(group("a", 1, 1) + "," + group("b", 2, 2, R"(, "tau": {"min": 0.1, "max": 0.2})"));
    const auto load = [&](const std::string& last) {
        return load_patched(two,
                            {R"(/crowd/tau={"min":0.4,"max":0.8})", R"(/crowd/mass_kg={"min":40,"max":100})", last});
    };
    const LoadedScene loaded = load("/seed=1");
    const auto& groups = loaded.scene.crowd->groups;
    CHECK((groups.at(0).tau->lo == 0.4 && groups.at(0).tau->hi == 0.8));
    CHECK((groups.at(1).tau->lo == 0.1 && groups.at(1).tau->hi == 0.2));
    CHECK((groups.at(1).mass->lo == 40 && groups.at(1).mass->hi == 100));
    CHECK(load("/crowd/tau=0.5").scene.crowd->groups.at(0).tau == 0.5);
    CHECK(load("/crowd/tau/max=0.9").scene.crowd->groups.at(0).tau->hi == 0.9);
    CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").canonical_json == loaded.canonical_json);
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
              .scene.coupling->sampling_rate == 120);
}
