// Keys that are set where they have no effect.

#include "configs/scene/keys.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using namespace wade::test;
using Warnings = std::vector<std::string>;

namespace {

const std::string two_groups = crowd(group("a", 1, 1) + "," + group("b", 2, 2));
const std::string measured = "/crowd/response=measured";

Warnings warnings(const std::vector<std::string>& assignments) {
    return load_patched(two_groups, assignments).warnings;
}

}  // namespace

TEST_CASE("keys of a site are refused on a channel, with their value and where they act") {
    const auto refused = [](const std::string& change) { return refusal(two_groups, {change}); };
    CHECK_THAT(refused("/crowd/navigation/slope=tobler"),
               Equals("scene.json: /crowd/navigation/slope: \"tobler\" has no effect, as it acts only beside /site; "
                      "allowed: \"level\"."));
    CHECK_THAT(refused("/crowd/navigation/sight_m=5"),
               Contains("sight_m: 5 has no effect") && Contains("allowed: 20."));
    CHECK_THAT(refused("/crowd/navigation/enters_up_to_m=1"),
               Contains("enters_up_to_m: 1 has no effect") && Contains("allowed: none."));
    CHECK_THAT(refused("/crowd/navigation/safe_above_m=1"), Contains("safe_above_m: 1 has no effect"));
    CHECK_THAT(refused("/crowd/groups/1/warned=false"), Contains("/crowd/groups/1/warned: false has no effect"));
    CHECK_THAT(refused(R"(/crowd/groups/1/leaves={"rule":"normal","mean_s":9})"),
               Contains("/crowd/groups/1/leaves/rule: \"normal\" has no effect, as it acts only with start/from "
                        "\"houses\"; allowed: \"at_once\".") &&
                   Contains("/crowd/groups/1/leaves/mean_s: 9"));
    CHECK_NOTHROW(load_patched(two_groups, {"/crowd/navigation/slope=level", "/crowd/navigation/sight_m=20"}));
}

TEST_CASE("keys that a switch of the scene turns off are warned of, one sentence a reason") {
    CHECK(warnings({}).empty());
    CHECK(warnings({"/crowd/marker_epoch_s=1"}) ==
          Warnings{"/crowd/marker_epoch_s: no effect; acts only with /crowd/markers \"redrawn\"."});
    CHECK(warnings({"/crowd/marker_epoch_s=1", "/crowd/markers=redrawn"}).empty());
    const Warnings by_tau = warnings({"/crowd/fatigue=true", "/crowd/helping=true", "/crowd/air_budget_s=40",
                                      "/crowd/water_temperature_c=5", "/crowd/drift_hazard_per_s=under"});
    REQUIRE(by_tau.size() == 1);
    CHECK_THAT(by_tau[0], Equals("/crowd/fatigue, /crowd/water_temperature_c, /crowd/drift_hazard_per_s, "
                                 "/crowd/air_budget_s, /crowd/helping: no effect; acts only with /crowd/response "
                                 "\"measured\" and no tau of the group."));
    CHECK(warnings({"/crowd/fatigue=true", "/crowd/helping=true", measured}).empty());
    REQUIRE(warnings({"/crowd/tau=0.3", measured}).size() == 1);
    CHECK_THAT(warnings({"/crowd/tau=0.3", measured})[0], Contains("/crowd/tau: no effect"));
    const Warnings rows = warnings({R"(/crowd/people=[{"skill":"good"},{"skill":"poor"},{"mass_kg":80}])"});
    REQUIRE(rows.size() == 1);
    CHECK_THAT(rows[0], Contains("/crowd/people/0/skill (and 1 more): no effect"));
    CHECK(warnings({"/crowd/sex=male", "/crowd/age=10"}).empty());  // children have masses by age and sex
    CHECK(warnings({"/crowd/sex=male"}).size() == 1);
    CHECK(warnings({"/crowd/skill=good", measured, "/crowd/groups/0/tau=0.5"}).empty());  // for the other group
    CHECK(warnings({"/crowd/groups/0/skill=good", measured, "/crowd/groups/0/tau=0.5"}).size() == 1);
    CHECK(warnings({"/fluid/steering/max_speed=3"}).size() == 1);
    CHECK(warnings({"/fluid/steering/max_speed=3", "/fluid/model=auto"}).empty());
    CHECK(warnings({"/fluid/density_solve/tolerance=0.01", "/fluid/viscosity_m2_s=0.1"}).empty());
    CHECK(warnings({"/fluid/density_solve/tolerance=0.01", "/fluid/viscosity_m2_s=0.1", "/fluid/model=shallow_water",
                    "/fluid/cfl=0.4"}) ==
          Warnings{"/fluid/viscosity_m2_s, /fluid/density_solve/tolerance: no effect; acts only with the models dfsph, "
                   "mixed and auto."});
}

TEST_CASE("a scene that is printed with all its defaults warns of no more than the scene itself") {
    for (const std::string response : {"paper", "measured"}) {
        const wade::LoadedScene loaded = load_patched(two_groups, {"/crowd/response=" + response});
        CHECK(loaded.warnings.empty());
        CHECK(wade::load_scene_text(loaded.canonical_json, "again.json").warnings.empty());
    }
}
