// What every response promises; one that is registered is tried here by being registered.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "responses/conformance.hpp"

using namespace wade;
using namespace wade::crowd;
using namespace wade::crowd::testing;

TEST_CASE("Every response keeps what responses promise") {
    for (const RegisteredResponse& entry : responses()) {
        for (const Scene& scene : coupled_scenes()) {
            INFO("response " << entry.name << ", coupling " << name_of(scene));
            check_response(entry, scene);
        }
    }
}

TEST_CASE("Names of responses differ, and one that is not there is refused with those that are") {
    std::vector<std::string_view> names;
    for (const RegisteredResponse& entry : responses()) names.push_back(entry.name);
    std::sort(names.begin(), names.end());
    CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
    REQUIRE(std::find(names.begin(), names.end(), "paper") != names.end());
    CHECK_THROWS_AS(make_response("papper", Scene{}), ConfigurationError);
    CHECK_THROWS_WITH(make_response("papper", Scene{}),
                      Catch::Contains("/crowd/response: \"papper\"") && Catch::Contains("\"paper\""));
}
