// What the mixed model of the water cannot do, and what it needs.

#include "configs/scene/choices.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
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
    const wade::MixedWindow given = load_patched(river(R"("x_min_m": 5, "x_max_m": 12)")).scene.fluid.mixed;
    CHECK(given.x_min == 5);
    CHECK(given.x_max == 12);
    CHECK_FALSE(given.margin.has_value());
    CHECK(given.chunk == 4);
    CHECK_FALSE(given.obstacles);
    CHECK(load_patched(river(R"("margin_m": 2)", "", serial)).scene.fluid.mixed.margin == 2);
    const std::string off = R"("agents_stream": "off")";
    CHECK_THAT(refusal(river("", "", off)),
               Contains("/fluid/model: \"mixed\" does not know where particles are needed; "
                        "allowed: /coupling/agents_stream \"serial\" or \"parallel\""));
    CHECK_THAT(refusal(river(R"("obstacles": true)", "", off)), Contains("does not know where particles are needed"));
}

TEST_CASE("mixed water asks for the people itself where only they can say where particles are needed") {
    using wade::AgentsStream;
    CHECK(load_patched(river("")).scene.coupling.agents_stream == AgentsStream::serial);
    CHECK(load_patched(river("", "", R"("agents_stream": "parallel")")).scene.coupling.agents_stream ==
          AgentsStream::parallel);
    CHECK(load_patched(river(R"("x_min_m": 5, "x_max_m": 12)")).scene.coupling.agents_stream == AgentsStream::off);
    CHECK(load_patched("{}").scene.coupling.agents_stream == AgentsStream::off);
}

TEST_CASE("a model is switched by one key") {
    const std::string s04 = std::string(WADE_SCENES) + "/paper/s04.json";
    for (const std::string& model : wade::names_of<wade::ModelKind>()) {
        INFO(model);
        CHECK_NOTHROW(wade::load_scene(s04, {{"/fluid/model", model, "--set"}}));
    }
    CHECK(wade::load_scene(s04, {{"/fluid/model", "auto", "--set"}}).scene.fluid.max_impulse_error == 0.3);
    CHECK(wade::load_scene(s04, {{"/fluid/model", "dfsph", "--set"}}).scene.fluid.max_impulse_error == 0);
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
