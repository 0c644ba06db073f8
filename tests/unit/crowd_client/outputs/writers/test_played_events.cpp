// Commands for tau become events that repeat the run.

#include <catch2/catch.hpp>

#include "configs/loading/scene_loader.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"
#include "crowd_client/outputs/writers/played_events.hpp"
#include "made_up_water.hpp"

using namespace wade;
using namespace wade::crowd;
using wade::crowd::testing::one_agent_scene;

namespace {

TauCommand tau_of_all(double tau) {
    TauCommand command;
    command.tau = tau;
    return command;
}

CrowdWorld crowd_after(Scene scene, std::uint64_t steps) {
    CrowdWorld crowd = make_crowd(scene);
    while (crowd.steps < steps) step(crowd, {});
    return crowd;
}

}  // namespace

TEST_CASE("A command holds from the next step on, at equal rates from the next frame on") {
    for (const std::uint64_t steps : {0U, 1U, 7U, 100U}) {
        CHECK(event_of(crowd_after(one_agent_scene(10, 25, 75, 50, 0.2), steps), tau_of_all(0.5)).frame == steps + 1);
    }
}

TEST_CASE("At other rates the event's frame leads back to the first step that a frame begins with") {
    for (const auto& [frames, steps] : {std::pair{30.0, 45.0}, {30.0, 10.0}, {7.0, 3.0}, {29.97, 1000.0}}) {
        Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
        scene.frame_rate = frames;
        scene.crowd->step_rate = steps;
        CrowdWorld crowd = make_crowd(scene);
        for (crowd.steps = 0; crowd.steps < 500; ++crowd.steps) {
            const std::uint64_t frame = event_of(crowd, tau_of_all(0.5)).frame;
            const std::uint64_t from = step_of_frame(scene, frame);
            REQUIRE(from >= crowd.steps + 1);
            // No earlier step would do, and no later frame has the same step.
            std::uint64_t earlier = frame;
            while (earlier > 0 && step_of_frame(scene, earlier) == from) --earlier;
            REQUIRE(step_of_frame(scene, earlier) < crowd.steps + 1);
            REQUIRE(step_of_frame(scene, frame + 1) > from);
        }
    }
}

TEST_CASE("A command acts after the scene's events of the same step, and commands act in their order") {
    Scene scene = one_agent_scene(10, 25, 75, 50, 0.2);
    scene.crowd->step_rate = 10;  // frames 4, 5 and 6 lead to step 2
    scene.events.push_back({6, std::nullopt, std::nullopt, 0.6});
    scene.events.push_back({7, std::nullopt, std::nullopt, 0.7});
    CrowdWorld crowd = crowd_after(scene, 1);
    add_event(crowd, event_of(crowd, tau_of_all(0.1)));
    add_event(crowd, event_of(crowd, tau_of_all(0.9)));
    step(crowd, {});
    CHECK(crowd.agents.tau[0] == 0.9);
    step(crowd, {});
    CHECK(crowd.agents.tau[0] == 0.7);
}

TEST_CASE("A wrong agent or group is refused with what is allowed") {
    const CrowdWorld crowd = make_crowd(one_agent_scene(10, 25, 75, 50, 0.2));
    TauCommand command = tau_of_all(0.5);
    command.agent = 1;
    CHECK_THROWS_WITH(event_of(crowd, command), Catch::Contains("no agent 1") && Catch::Contains("0 to 0"));
    command.agent = std::nullopt;
    command.group = "swimmers";
    CHECK_THROWS_WITH(event_of(crowd, command), Catch::Contains("\"swimmers\"") && Catch::Contains("walkers"));
    command.group = "walkers";
    CHECK_NOTHROW(event_of(crowd, command));
}

TEST_CASE("The scene as played is valid, holds its own events first and has another hash") {
    const std::string text =
        R"({"channel": {"x_min_m": 0, "x_max_m": 40, "z_min_m": 10, "z_max_m": 30, "flow": "closed"},
            "crowd": {"groups": [{"name": "a", "start": {"x_m": 1, "z_m": 2}, "goal": {"x_m": 3, "z_m": 4}}]},
            "events": [{"time_s": 1, "tau": 0.5}]})";
    const LoadedScene before = load_scene_text(text, "scene.json");
    const std::vector<TauEvent> played{{30, 0, std::nullopt, 1}, {12, std::nullopt, "a", 0.123456789012345678}};
    const LoadedScene after = load_scene_text(scene_with_events(before.canonical_json, played), "scene.json");
    REQUIRE(after.scene.events.size() == 3);
    CHECK(after.scene.events[0].frame == 30);
    CHECK(after.scene.events[0].tau == 0.5);
    CHECK(after.scene.events[1].agent == 0);
    CHECK(after.scene.events[2].group == "a");
    CHECK(after.scene.events[2].frame == 12);
    CHECK(after.scene.events[2].tau == played[1].tau);
    CHECK(after.scene.hash != before.scene.hash);
}
