// What the mixed and the steering model of the water cannot do, and what they need.

#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/steering.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using namespace wade::test;

namespace {

// A river of mixed water; `mixed` are the keys of the model, `more` comes after those of the channel.
std::string river(const std::string& mixed, const std::string& more = "", const std::string& coupling = "") {
    return R"({"channel": {"flow": "recirculating", "initial_river": "filled", "velocity_m_s": 1)" + more +
           R"(}, "fluid": {"model": "mixed", "particle_spacing_m": 0.5, "mixed": {)" + mixed + R"(}}, "coupling": {)" +
           coupling + "}}";
}

const std::string serial = R"("agents_stream": "serial")";

}  // namespace

TEST_CASE("the window of mixed water is given, follows people, or follows obstacles") {
    const wade::MixedWindow given = load_patched(river(R"("x_min_m": 5, "x_max_m": 12)")).scene.fluid->mixed;
    CHECK(given.x_min == 5);
    CHECK(given.x_max == 12);
    CHECK_FALSE(given.margin.has_value());
    CHECK(given.chunk == 4);
    CHECK_FALSE(given.obstacles);
    CHECK(load_patched(river(R"("margin_m": 2)", "", serial)).scene.fluid->mixed.margin == 2);
    const std::string off = R"("agents_stream": "off")";
    CHECK_THAT(refusal(river("", "", off)),
               Contains("/fluid/model: \"mixed\" does not know where particles are needed; "
                        "allowed: /coupling/agents_stream \"serial\" or \"parallel\""));
    CHECK_THAT(refusal(river(R"("obstacles": true)", "", off)), Contains("does not know where particles are needed"));
}

TEST_CASE("mixed water asks for the people itself where only they can say where particles are needed") {
    using wade::AgentsStream;
    CHECK(load_patched(river("")).scene.coupling->agents_stream == AgentsStream::serial);
    CHECK(load_patched(river("", "", R"("agents_stream": "parallel")")).scene.coupling->agents_stream ==
          AgentsStream::parallel);
    CHECK(load_patched(river(R"("x_min_m": 5, "x_max_m": 12)")).scene.coupling->agents_stream == AgentsStream::off);
    CHECK(load_patched("{}").scene.coupling->agents_stream == AgentsStream::off);
}

TEST_CASE("a model is switched by one key") {
    const std::string s04 = std::string(WADE_SCENES) + "/paper/s04.json";
    for (const std::string& model : wade::names_of<wade::ModelKind>()) {
        INFO(model);
        CHECK_NOTHROW(wade::load_scene(s04, {{"/fluid/model", model, "--set"}}));
    }
    CHECK(wade::load_scene(s04, {{"/fluid/model", "auto", "--set"}}).scene.fluid->max_impulse_error == 0.3);
    CHECK(wade::load_scene(s04, {{"/fluid/model", "dfsph", "--set"}}).scene.fluid->max_impulse_error == 0);
    CHECK_THAT(refusal(R"({"fluid": {"model": "auto", "max_impulse_error": 0}})"),
               Contains("/fluid/max_impulse_error: 0: the model \"auto\" is chosen by the error that is allowed"));
    CHECK_THAT(refusal(R"({"fluid": {"max_impulse_error": 0.1}})"), Contains("has no effect"));
}

TEST_CASE("the ends of the window of mixed water must make sense") {
    CHECK_THAT(refusal(river(R"("x_min_m": 5)")),
               Contains("/fluid/mixed/x_max_m: is missing; allowed: both ends of the window, or none."));
    CHECK_THAT(refusal(river(R"("x_min_m": 12, "x_max_m": 5)")),
               Contains("/fluid/mixed/x_min_m: 12 m; allowed: from the channel's begin, 0 m, to below x_max_m = 5 m."));
    CHECK_THAT(refusal(river(R"("x_min_m": 12, "x_max_m": 41)")),
               Contains("/fluid/mixed/x_max_m: 41 m lies beyond the channel; allowed: <= 40 m."));
    CHECK_THAT(refusal(river(R"("chunk_m": 0)", "", serial)), Contains("/fluid/mixed/chunk_m"));
}

TEST_CASE("mixed water refuses what shallow water cannot show, and uneven beds") {
    CHECK_THAT(refusal(river("", R"(, "bed_points": [{"x_m": 5, "y_m": 0.1}])", serial)),
               Contains("/fluid/model: \"mixed\" hands water over on a level bed only"));
    CHECK_THAT(refusal(river("", R"(, "top": "wall", "height_m": 2)", serial)),
               Contains("/fluid/model: \"mixed\" has a free surface, and /channel/top is \"wall\""));
    CHECK_THAT(refusal(river("", R"(, "x_min_m": 36)", serial)),
               Contains("/fluid/model: \"mixed\" needs a guard of 1.5 m before each end of its window, and the channel "
                        "is 4 m long; allowed: >= 5 m"));
}

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
    const wade::Steering s = load_patched(tank()).scene.fluid->steering;
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
