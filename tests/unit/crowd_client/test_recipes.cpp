// The recipes "An output file" and "A response of an agent" of CONTRIBUTING.md, as they stand there.

#include <algorithm>
#include <catch2/catch.hpp>

#include "crowd_client/crowd_world.hpp"
#include "crowd_client/outputs/run_folder.hpp"
#include "made_up_water.hpp"
#include "outputs/conformance.hpp"
#include "outputs/run_files.hpp"
#include "responses/conformance.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;

TEST_CASE("The output of the recipe keeps what outputs promise and lies in the folder of each run") {
    const auto found = std::find_if(outputs().begin(), outputs().end(),
                                    [](const RegisteredOutput& o) { return o.files[0] == "my_crowding.csv"; });
    REQUIRE(found != outputs().end());
    check_output(*found);

    TemporaryFolder folder;
    CrowdWorld crowd = make_crowd(one_agent_scene(10, 25, 75, 50, 0.2));
    RunFolder run(folder.path, crowd, RunLabels{}, Record{});
    for (int i = 0; i < 2; ++i) {
        step(crowd, {});
        run.record(crowd, {});
    }
    CHECK(content_of(folder.path / "my_crowding.csv") == "frame,active\n1,1\n2,1\n");
    CHECK(content_of(folder.path / "outcome.json").find("running") != std::string::npos);
}

TEST_CASE("The response of the recipe keeps what responses promise and moves a crowd") {
    const auto found = std::find_if(responses().begin(), responses().end(),
                                    [](const RegisteredResponse& r) { return r.name == "drift"; });
    REQUIRE(found != responses().end());
    for (const Scene& scene : coupled_scenes()) check_response(*found, scene);

    CrowdWorld crowd = make_crowd(one_agent_scene(50, 25, 75, 50, 1));
    crowd.response = make_response("drift", crowd.scene);
    step(crowd, uniform_water(45, 55, 20, 30, 1, 0.25, -0.5, 0.25).view());
    CHECK(crowd.agents.velocity[0].x() == Approx(-0.5));
    CHECK(crowd.agents.velocity[0].y() == Approx(0.25));
}
