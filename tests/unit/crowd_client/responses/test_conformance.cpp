// What every response promises; one that is registered is tried here by being registered.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/choices.hpp"
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

TEST_CASE("Each response is a word of the scene's key and each word is a response") {
    std::vector<std::string> names;
    for (const RegisteredResponse& entry : responses()) names.emplace_back(entry.name);
    CHECK(names == names_of<ResponseKind>());
    std::sort(names.begin(), names.end());
    CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("A response that is not there is refused with those that are") {
    CHECK_THROWS_AS(make_response("papper", Scene{}), ConfigurationError);
    CHECK_THROWS_WITH(make_response("papper", Scene{}),
                      Catch::Contains("/crowd/response: \"papper\"") && Catch::Contains("\"paper\""));
}
