// Geometry and water that cannot be simulated.

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using namespace wade::test;

namespace {

std::string box(double x_min, double x_max, double z_min, double z_max, const std::string& height_key) {
    return R"({"x_min_m": )" + std::to_string(x_min) + R"(, "x_max_m": )" + std::to_string(x_max) + R"(, "z_min_m": )" +
           std::to_string(z_min) + R"(, "z_max_m": )" + std::to_string(z_max) + ", \"" + height_key + "\": 1}";
}

std::string obstacles(const std::string& boxes) {
    return R"({"obstacles": [)" + boxes + "]}";
}
std::string channel_with_blocks(const std::string& boxes) {
    return R"({"channel": {"water_blocks": [)" + boxes + "]}}";
}

const std::string recirculating_river =
    R"({"channel": {"flow": "recirculating", "initial_river": "filled", "velocity_m_s": 1}, "fluid": {"particle_spacing_m": 0.5}})";
const std::string emitter_river =
    R"({"channel": {"flow": "emitter", "velocity_m_s": 1}, "fluid": {"particle_spacing_m": 0.5}})";

}  // namespace

TEST_CASE("an interval whose ends are swapped or equal is refused") {
    CHECK_THAT(refusal(R"({"channel": {"x_min_m": 50}})"),
               Equals("scene.json: /channel/x_min_m: 50 m is not smaller than x_max_m = 40 m; allowed: < 40 m."));
    CHECK_THAT(refusal(R"({"channel": {"z_min_m": 30}})"),
               Contains("/channel/z_min_m: 30 m is not smaller than z_max_m = 30 m"));
    CHECK_THAT(refusal(obstacles(box(5, 4, 11, 12, "height_m"))), Contains("/obstacles/0/x_min_m: 5 m is not smaller"));
    CHECK_THAT(refusal(channel_with_blocks(box(3, 4, 13, 12, "depth_m"))),
               Contains("/channel/water_blocks/0/z_min_m: 13 m is not smaller"));
}

TEST_CASE("a channel outside the world is refused") {
    CHECK_THAT(
        refusal(R"({"world": {"length_m": 30}})"),
        Equals("scene.json: /channel: the channel at x 0 to 40 m, z 10 to 30 m reaches outside the world; allowed: "
               "x 0 to 30 m, z 0 to 50 m."));
}

TEST_CASE("an obstacle outside the channel is refused") {
    CHECK_THAT(
        refusal(obstacles(box(5, 6, 9, 12, "height_m"))),
        Equals(
            "scene.json: /obstacles/0: the obstacle at x 5 to 6 m, z 9 to 12 m reaches outside the channel; allowed: "
            "x 0 to 40 m, z 10 to 30 m."));
}

TEST_CASE("an obstacle within the particles' reach of the emitter or of a periodic border is refused") {
    const auto with = [](const std::string& flow, const std::string& boxes) {
        return flow.substr(0, flow.size() - 1) + R"(, "obstacles": [)" + boxes + "]}";
    };
    const wade::Channel channel = load_patched(emitter_river).scene.channel;
    const double end = channel.x.hi;
    const double z = 0.5 * (channel.z.lo + channel.z.hi);
    // The spacing is 0.5 m: 4 d = 2 m from the emitter, 2 d = 1 m from a periodic border.
    CHECK_THAT(refusal(with(emitter_river, box(end - 3, end - 1.9, z, z + 0.5, "height_m"))),
               Contains("scene.json: /obstacles/0: the obstacle at x ") && Contains("too near to the emitter"));
    CHECK_NOTHROW(load_patched(with(emitter_river, box(end - 3, end - 2, z, z + 0.5, "height_m"))));
    CHECK_THAT(refusal(with(recirculating_river, box(end - 2, end - 0.9, z, z + 0.5, "height_m"))),
               Contains("/obstacles/0") && Contains("periodic border (1 m)"));
    CHECK_NOTHROW(load_patched(with(recirculating_river, box(end - 2, end - 1, z, z + 0.5, "height_m"))));
}

TEST_CASE("boxes that overlap are refused, boxes that touch are not") {
    CHECK_THAT(
        refusal(obstacles(box(5, 7, 11, 13, "height_m") + "," + box(6, 8, 12, 14, "height_m"))),
        Equals("scene.json: /obstacles/1: overlaps /obstacles/0 at x 6 to 7 m, z 12 to 13 m; they may touch at most."));
    CHECK(load_patched(obstacles(box(5, 7, 11, 13, "height_m") + "," + box(7, 8, 11, 13, "height_m")))
              .scene.obstacles.size() == 2);
    CHECK_THAT(refusal(channel_with_blocks(box(5, 7, 11, 13, "depth_m") + "," + box(6, 8, 12, 14, "depth_m"))),
               Contains("/channel/water_blocks/1: overlaps /channel/water_blocks/0"));
    CHECK_THAT(
        refusal(channel_with_blocks(box(5, 7, 11, 13, "depth_m")), {"/obstacles/0=" + box(6, 8, 12, 14, "height_m")}),
        Contains("/channel/water_blocks/0: overlaps /obstacles/0"));
}

TEST_CASE("a capacity too small for the water is refused with what is needed") {
    // 40 m x 20 m x 1 m / (0.5 m)^3 = 6400
    CHECK_THAT(
        refusal(recirculating_river, {"/fluid/max_particles=6399"}),
        Equals(
            "scene.json: /fluid/max_particles: 6399 particles are too few for the water of this scene at a spacing of "
            "0.5 m; allowed: >= 6400."));
    CHECK(load_patched(recirculating_river, {"/fluid/max_particles=6400"}).scene.fluid->max_particles == 6400);
    // (40 + 5 * 0.5) m x 20 m x 1 m / (0.5 m)^3 = 6800
    CHECK_THAT(refusal(emitter_river, {"/fluid/max_particles=6799"}), Contains("allowed: >= 6800."));
    CHECK(wade::particles_needed(load_patched(emitter_river).scene) == 6800);
    CHECK(wade::river_particles(load_patched(emitter_river).scene) == 6400);
    // Two blocks of 2 m x 2 m x 1 m: 2 * 32
    const std::string two = channel_with_blocks(box(5, 7, 11, 13, "depth_m") + "," + box(7, 9, 11, 13, "depth_m"));
    CHECK_THAT(refusal(two, {"/fluid/particle_spacing_m=0.5", "/fluid/max_particles=63"}), Contains("allowed: >= 64."));
}

TEST_CASE("a spacing larger than the water is refused") {
    CHECK_THAT(refusal(emitter_river, {"/fluid/particle_spacing_m=1.5"}),
               Equals("scene.json: /fluid/particle_spacing_m: 1.5 m is larger than the channel's depth of 1 m; "
                      "allowed: <= 1 m."));
    CHECK_THAT(refusal(emitter_river, {"/channel/z_max_m=10.4"}),
               Contains("0.5 m is larger than the channel's width of 0.4 m"));
    CHECK_THAT(refusal(emitter_river, {"/channel/x_max_m=0.4"}),
               Contains("0.5 m is larger than the channel's length of 0.4 m"));
    CHECK_THAT(refusal(channel_with_blocks(box(5, 7, 11, 11.3, "depth_m"))),
               Contains("0.4642 m is larger than the width of /channel/water_blocks/0 of 0.3 m"));
    CHECK_THAT(refusal(channel_with_blocks(box(5, 7, 11, 13, "depth_m")), {"/channel/water_blocks/0/depth_m=0.3"}),
               Contains("0.4642 m is larger than the depth of /channel/water_blocks/0 of 0.3 m"));
}

TEST_CASE("walls too near for a wide kernel are refused") {
    const std::string wide = "/fluid/kernel=wendland_c2";
    CHECK_THAT(
        refusal(emitter_river, {wide, "/channel/z_max_m=10.9"}),
        Contains("/channel/z_max_m: the banks are 0.9 m apart, nearer than the kernel's support of 1.5 m allows; "
                 "allowed: >= 2 fluid.particle_spacing_m = 1 m, or the kernel \"cubic_spline\"."));
    CHECK(load_patched(emitter_river, {wide, "/channel/z_max_m=11"}).scene.channel->z.hi == 11);
    CHECK(load_patched(emitter_river, {"/channel/z_max_m=10.5"}).scene.channel->z.hi == 10.5);
    const std::string quartic = "/fluid/kernel=quartic_spline";
    CHECK_THAT(refusal(emitter_river, {quartic, "/channel/z_max_m=10.6"}),
               Contains("allowed: >= 1.4 fluid.particle_spacing_m"));
    CHECK(load_patched(emitter_river, {quartic, "/channel/z_max_m=10.8"}).scene.channel->z.hi == 10.8);
    CHECK_THAT(refusal(emitter_river, {wide, "/channel/depth_m=0.5", "/channel/top=wall", "/channel/height_m=0.7"}),
               Contains("/channel/height_m: bed and lid are 0.7 m apart"));
    CHECK_THAT(refusal(channel_with_blocks(box(5, 7, 11, 13, "depth_m")),
                       {wide, "/channel/x_min_m=5", "/channel/x_max_m=7", "/fluid/particle_spacing_m=1.2",
                        "/channel/water_blocks/0/depth_m=2"}),
               Contains("/channel/x_max_m: the end walls are 2 m apart"));
}

TEST_CASE("the support radius is that of the cubic spline") {
    const std::string wider = "/fluid/support_in_spacings=2.1";
    CHECK(load_patched(emitter_river, {wider}).scene.fluid->support_in_spacings == 2.1);
    CHECK_THAT(
        refusal(emitter_river, {wider, "/fluid/kernel=wendland_c2"}),
        Equals("scene.json: /fluid/support_in_spacings: 2.1 is for the kernel \"cubic_spline\", and /fluid/kernel is "
               "\"wendland_c2\", which reaches 3 d; allowed: 2."));
    CHECK_THAT(
        refusal(emitter_river, {wider, "/fluid/kernel=quartic_spline"}),
        Contains(
            "2.1 is for the kernel \"cubic_spline\", and /fluid/kernel is \"quartic_spline\", which reaches 2.4 d"));
    CHECK_THAT(refusal(emitter_river, {"/fluid/support_in_spacings=2.3"}), Contains("/fluid/support_in_spacings"));
    CHECK_THAT(refusal(emitter_river, {wider, "/channel/z_max_m=10.5"}),
               Contains("allowed: >= 1.1 fluid.particle_spacing_m = 0.55 m, or /fluid/support_in_spacings 2."));
}

TEST_CASE("periodic lengths below six spacings are refused") {
    CHECK_THAT(refusal(recirculating_river, {"/channel/x_max_m=2.9"}),
               Contains("/channel/x_max_m: the recirculating channel's length is 2.9 m") &&
                   Contains("allowed: >= 6 fluid.particle_spacing_m = 3 m."));
    CHECK_THAT(refusal(emitter_river, {"/channel/sides=periodic", "/channel/z_max_m=12.9"}),
               Contains("/channel/z_max_m: the width between periodic sides is 2.9 m"));
    CHECK(load_patched(recirculating_river, {"/channel/x_max_m=3"}).scene.channel->x.hi == 3);
    CHECK(load_patched(emitter_river, {"/channel/z_max_m=12.9"}).scene.channel->z.hi == 12.9);
}

TEST_CASE("flows that cannot be are refused") {
    CHECK_THAT(refusal(emitter_river, {"/channel/velocity_m_s=0"}),
               Equals("scene.json: /channel/velocity_m_s: 0 m/s: an emitter needs a velocity; allowed: > 0 m/s."));
    CHECK_THAT(refusal(recirculating_river, {"/channel/initial_river=dry"}),
               Contains("/channel/initial_river: a recirculating channel keeps"));
    CHECK_THAT(refusal("{}", {"/channel/initial_river=filled"}),
               Contains("a closed channel is filled by water_blocks."));
    CHECK_THAT(refusal("{}", {"/channel/velocity_m_s=1"}),
               Contains("1 m/s has no effect in a closed channel; allowed: 0 m/s."));
    CHECK_THAT(refusal(emitter_river, {"/channel/water_blocks/0=" + box(5, 7, 11, 13, "depth_m")}),
               Contains("/channel/water_blocks: blocks of water need flow \"closed\" or \"periodic\""));
}

TEST_CASE("iteration limits that contradict one another are refused") {
    CHECK_THAT(
        refusal("{}", {"/fluid/density_solve/min_iterations=5", "/fluid/density_solve/max_iterations=4"}),
        Equals("scene.json: /fluid/density_solve/min_iterations: 5 is more than max_iterations = 4; allowed: <= 4."));
    for (const char* solve : {"density", "divergence"}) {
        const std::string pointer = std::string("/fluid/") + solve + "_solve/min_iterations";
        CHECK_THAT(refusal("{}", {pointer + "=0"}), Contains(pointer) && Contains("allowed: >= 1"));
    }
    CHECK(
        load_patched("{}", {"/fluid/divergence_solve/max_iterations=0"}).scene.fluid->divergence_solve.max_iterations ==
        0);
}

TEST_CASE("shallow water refuses what has no place in it") {
    const auto refused = [](const std::string& channel, const std::string& more = "") {
        return refusal(R"({"fluid": {"model": "shallow_water", "viscosity_m2_s": 0.1}, "channel": {)" + channel + "}" +
                       more + "}");
    };
    const std::string block = R"("water_blocks": [{"x_min_m": 5, "x_max_m": 9, "z_min_m": 11, "z_max_m": 20, )";
    CHECK_NOTHROW(
        load_patched(R"({"fluid": {"model": "shallow_water"}, "channel": {)" + block + R"("depth_m": 2}]}})"));
    CHECK_THAT(refused(R"("top": "wall", "height_m": 3)"),
               Equals("scene.json: /fluid/model: \"shallow_water\" has a free surface, and /channel/top is \"wall\"; "
                      "allowed: \"open\", or the model \"dfsph\"."));
    CHECK_THAT(refused(R"("no_slip": [{"plane": "bed"}])"), Contains("/channel/no_slip would have no effect"));
    CHECK_THAT(refused("", R"(, "world": {"gravity_m_s2": 0})"), Contains("/world/gravity_m_s2: 0 m/s2"));
    CHECK_THAT(refused(block + R"("depth_m": 2, "y_min_m": 1}])"),
               Contains("/channel/water_blocks/0/y_min_m: 1 m: the water of \"shallow_water\" stands on the bed"));
    CHECK_THAT(refused(block + R"("depth_m": 2, "velocity_y_m_s": 1}])"),
               Contains("/channel/water_blocks/0/velocity_y_m_s: 1 m/s"));
    const std::string model = R"({"fluid": {"model": "shallow_water"}})";
    CHECK_THAT(refusal(model, {"/fluid/cfl=0.7"}), Contains("/fluid/cfl: 0.7 is too large for the model"));
    CHECK_THAT(refusal(model, {"/fluid/shallow_water/cell_size_m=50"}),
               Contains("/fluid/shallow_water/cell_size_m: 50 m is larger than the channel's length of 40 m"));
    CHECK_THAT(refusal(model, {"/fluid/shallow_water/cell_size_m=0.001"}), Contains("more than 1e+08 cells"));
    CHECK_THAT(refusal(model, {"/fluid/shallow_water/cell_size_m=0"}), Contains("/fluid/shallow_water/cell_size_m"));
    CHECK_THAT(refused("", R"(, "obstacles": [)" + box(5, 5.3, 12, 13, "height_m") + "]"),
               Contains("/obstacles/0: the obstacle is 0.3 m long in x, less than a cell of 0.5 m"));
}

TEST_CASE("shallow water does not keep the rules of particles") {
    const std::vector<std::string> thin{"/channel/z_min_m=12", "/channel/z_max_m=12.4",
                                        "/fluid/shallow_water/cell_size_m=0.04"};
    const std::string block = R"({"fluid": {"model": ")",
                      channel = R"(", "max_particles": 1}, "channel": {"sides": "periodic",
        "water_blocks": [{"x_min_m": 5, "x_max_m": 5.2, "z_min_m": 12, "z_max_m": 12.4, "depth_m": 0.1}]}})";
    CHECK_NOTHROW(load_patched(block + "shallow_water" + channel, thin));
    const std::string particles = refusal(block + "dfsph" + channel, thin);
    CHECK_THAT(particles, Contains("/fluid/particle_spacing_m: 0.4642 m is larger than the channel's width of 0.4 m"));
    CHECK_THAT(refusal(block + "mixed" + channel, thin), Contains("/fluid/particle_spacing_m"));
}

TEST_CASE("a kinematic stream in a closed channel or round an obstacle is refused") {
    const std::string kinematic = R"({"fluid": {"model": "kinematic"}, "channel": )";
    CHECK_THAT(refusal(kinematic + R"({}})"), Equals("scene.json: /fluid/model: \"kinematic\" is a stream of given "
                                                     "velocity, and /channel/flow is \"closed\"; allowed: "
                                                     "\"emitter\" and \"recirculating\"."));
    const std::string flow = kinematic + R"({"flow": "emitter", "velocity_m_s": 1})";
    CHECK_NOTHROW(load_patched(flow + "}"));
    CHECK_THAT(refusal(flow + R"(, "obstacles": [)" + box(5, 6, 12, 13, "height_m") + "]}"),
               Contains("/fluid/model: \"kinematic\" does not flow round obstacles, and /obstacles holds 1"));
}

TEST_CASE("gaps of less than three spacings are named, the narrowest first") {
    wade::Scene scene;
    scene.channel->x = {0, 10}, scene.channel->z = {0, 4};
    scene.channel->flow = wade::Flow::closed;
    scene.fluid->particle_spacing = 0.1;
    // Gaps: 0.25 m to the bank, 0.2 m between obstacles 0 and 1, 0.3 m between 1 and 2; no obstacle faces obstacle 3.
    scene.obstacles = {{{2, 3}, {0.25, 2}, 1}, {{3.2, 4}, {1, 2}, 1}, {{4.3, 5}, {1, 2}, 1}, {{5.1, 6}, {2.5, 3}, 1}};
    CHECK(wade::narrow_gaps(scene).empty());  // nor is there water
    scene.channel->water_blocks = {{{0, 10}, {0, 4}, 1}};
    const std::vector<std::string> gaps = wade::narrow_gaps(scene);
    REQUIRE(gaps.size() == 2);
    CHECK_THAT(gaps[0], Contains("0.2 m between /obstacles/0 and /obstacles/1") && Contains("<= 0.0666667."));
    CHECK_THAT(gaps[1], Contains("/obstacles/0 and the bank at z_min_m"));
    for (double x = 6.1; x < 8; x += 0.2) scene.obstacles.push_back({{x, x + 0.1}, {1, 2}, 1});
    const std::vector<std::string> many = wade::narrow_gaps(scene);
    REQUIRE(many.size() == 6);
    CHECK_THAT(many[5], Contains("more gaps"));
    scene.fluid->model = wade::ModelKind::shallow_water;
    CHECK(wade::narrow_gaps(scene).empty());
}
