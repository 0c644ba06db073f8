// What the steering model of the water cannot do.

#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using namespace wade::test;

namespace {

// A tank of steering water; `more` is appended to its keys, `steering` to those of the model.
std::string tank(const std::string& more = "", const std::string& steering = "") {
    return R"({"world": {"length_m": 40, "width_m": 40}, "channel": {"water_blocks": [{"x_min_m": 0, "x_max_m": 4,
        "z_min_m": 10, "z_max_m": 14, "depth_m": 1}])" +
           more + R"(}, "fluid": {"model": "steering", "particle_spacing_m": 0.5, "steering": {)" + steering + "}}}";
}

std::string body(double x, double y, double radius) {
    return R"("bodies": [{"x_m": )" + std::to_string(x) + R"(, "y_m": )" + std::to_string(y) +
           R"(, "z_m": 20, "radius_m": )" + std::to_string(radius) + "}]";
}

}  // namespace

TEST_CASE("steering water loads with the weights of the schema") {
    const wade::Steering s = load_patched(tank()).scene.fluid.steering;
    CHECK(s.separation.radius > 1);
    CHECK(s.separation.weight > 0);
    CHECK(s.separation.angle == 180);
    CHECK(s.alignment.weight == 0);
    CHECK(s.cohesion_form == wade::CohesionForm::equal);
    CHECK(s.walls == wade::SteeringWalls::both);
    CHECK(s.loss_form == wade::LossForm::relative);
    CHECK(s.classes.empty());
    CHECK(s.bodies.empty());
}

TEST_CASE("steering water refuses the friction that it does not know") {
    CHECK_THAT(refusal(tank(R"(, "manning_n": 0.03)")), Contains("/fluid/model: \"steering\" does not know "
                                                                 "/channel/manning_n"));
    CHECK_THAT(refusal(tank(R"(, "no_slip": [{"plane": "bed"}])")),
               Contains("\"steering\" does not know /channel/no_slip"));
}

TEST_CASE("neighbourhoods of steering water must fit the emitter, periods and obstacles") {
    const std::string emitter = R"({"channel": {"flow": "emitter", "velocity_m_s": 1}, "fluid": {"model": "steering",
        "particle_spacing_m": 0.5, "steering": {"cohesion": {"radius": 2.5, "weight": 0.1}}}})";
    CHECK_THAT(refusal(emitter), Contains("/fluid/steering/cohesion/radius: neighbourhoods of 2.5 d reach behind"));
    CHECK_THAT(refusal(tank(R"(, "sides": "periodic")", R"("cohesion": {"radius": 3, "weight": 0.1})"),
                       {"/channel/z_max_m=13"}),
               Contains("/channel"));
    const std::string thin = tank();
    CHECK_THAT(refusal(thin.substr(0, thin.size() - 1) +
                       R"(, "obstacles": [{"x_min_m": 10, "x_max_m": 10.2, "z_min_m": 20, "z_max_m": 25,
                           "height_m": 1}]})"),
               Contains("/obstacles/0: 0.2 m thick: steering particles feel one another through it"));
}

TEST_CASE("classes and bodies of steering water are checked") {
    CHECK_THAT(refusal(tank("", R"("classes": [{"share": 0.7}, {"share": 0.6}])")),
               Contains("/fluid/steering/classes: the shares sum up to 1.3; allowed: <= 1"));
    CHECK_THAT(refusal(tank("", body(20, 3, 0.4))),
               Contains("/fluid/steering/bodies/0/radius_m: 0.4 m would slip between the particles; allowed: >= "
                        "fluid.particle_spacing_m = 0.5 m."));
    CHECK_THAT(
        refusal(tank("", body(0.5, 3, 1))),
        Contains("/fluid/steering/bodies/0/x_m: 0.5 m: the sphere starts outside the channel; allowed: 1 to 39 m."));
    CHECK_THAT(refusal(tank("", body(20, 0.5, 1))), Contains("/fluid/steering/bodies/0/y_m: 0.5 m"));
    CHECK_THAT(refusal(tank("", R"("separation": {"radius": 4})")), Contains("/fluid/steering/separation/radius"));
    CHECK_NOTHROW(load_patched(tank("", body(20, 3, 1))));
}
