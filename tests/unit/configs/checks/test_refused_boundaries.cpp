// Bed, top, planes without slip, slope, friction and inflow that cannot be, or that would have no effect.

#include "configs/scene/channel.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using namespace wade::test;

namespace {

// The dry scene's channel is x 0 to 40 m, z 10 to 30 m; spacing 0.5 m, so that a support radius is 1 m.
std::string scene(const std::string& channel, const std::string& more = "") {
    return R"({"fluid": {"particle_spacing_m": 0.5}, "channel": {)" + channel + "}" + more + "}";
}
const std::string periodic = R"("flow": "periodic", "initial_river": "filled", "depth_m": 2)";
const std::string emitter = R"("flow": "emitter", "velocity_m_s": 1, "depth_m": 2)";
const std::string recirculating = R"("flow": "recirculating", "initial_river": "filled", "velocity_m_s": 1)";

std::string block(const std::string& more = R"("depth_m": 1)") {
    return R"({"x_min_m": 5, "x_max_m": 15, "z_min_m": 11, "z_max_m": 13, )" + more + "}";
}
std::string blocks(const std::string& list, const std::string& more = "") {
    return R"("water_blocks": [)" + list + "]" + more;
}
std::string bed(const std::string& points) {
    return R"(, "bed_points": [)" + points + "]";
}
std::string point(double x, double y) {
    return R"({"x_m": )" + std::to_string(x) + R"(, "y_m": )" + std::to_string(y) + "}";
}
std::string no_slip(const std::string& planes) {
    return R"(, "no_slip": [)" + planes + "]";
}

const std::string bump = point(10, 0) + "," + point(12, 0.5) + "," + point(14, 0);

}  // namespace

TEST_CASE("a periodic channel is filled or starts with blocks, not both and not neither") {
    CHECK_NOTHROW(load_patched(scene(periodic)));
    CHECK_NOTHROW(load_patched(scene(blocks(block(), R"(, "flow": "periodic")"))));
    CHECK_THAT(refusal(scene(R"("flow": "periodic")")),
               Contains("/channel/initial_river: a periodic channel keeps the water that it starts with"));
    CHECK_THAT(refusal(scene(blocks(block(), "," + periodic))),
               Contains("/channel/water_blocks: a periodic channel whose initial_river is \"filled\""));
    CHECK_THAT(refusal(scene(blocks(block(), R"(, "flow": "periodic", "velocity_m_s": 1)"))),
               Contains("/channel/velocity_m_s: 1 m/s has no effect in a periodic channel that starts with"));
    CHECK_THAT(refusal(scene(periodic), {"/channel/x_max_m=2.9"}),
               Contains("/channel/x_max_m: the periodic channel's length is 2.9 m"));
}

TEST_CASE("periodic lengths follow the support radius of the kernel") {
    CHECK_THAT(refusal(scene(periodic), {"/channel/x_max_m=4.4", "/fluid/kernel=wendland_c2"}),
               Contains("allowed: >= 9 fluid.particle_spacing_m = 4.5 m."));
    CHECK_NOTHROW(load_patched(scene(periodic), {"/channel/x_max_m=4.5", "/fluid/kernel=wendland_c2"}));
    CHECK_NOTHROW(load_patched(scene(periodic), {"/channel/x_max_m=3.6", "/fluid/kernel=quartic_spline"}));
    CHECK_THAT(refusal(scene(periodic), {"/channel/x_max_m=3.5", "/fluid/kernel=quartic_spline"}),
               Contains("allowed: >= 7.2 fluid.particle_spacing_m = 3.6 m."));
    CHECK_THAT(
        refusal(scene(periodic + R"(, "top": "periodic", "height_m": 2.9)", R"(, "world": {"gravity_m_s2": 0})")),
        Contains("/channel/height_m: the height between bottom and top, which are periodic, is 2.9 m"));
}

TEST_CASE("blocks of water may lie above one another") {
    const std::string low = block(), high = block(R"("y_min_m": 1, "depth_m": 1)");
    CHECK(load_patched(scene(blocks(low + "," + high))).scene.channel->water_blocks.size() == 2);
    CHECK_THAT(refusal(scene(blocks(low + "," + block(R"("y_min_m": 0.9, "depth_m": 1)")))),
               Contains("/channel/water_blocks/1: overlaps /channel/water_blocks/0"));
    const std::string obstacle =
        R"(, "obstacles": [{"x_min_m": 5, "x_max_m": 6, "z_min_m": 11, "z_max_m": 12, "height_m": 1}])";
    CHECK_NOTHROW(load_patched(scene(blocks(high), obstacle)));
    CHECK_THAT(refusal(scene(blocks(low), obstacle)), Contains("/channel/water_blocks/0: overlaps /obstacles/0"));
}

TEST_CASE("a top below the water is refused, and so is gravity without a bed") {
    CHECK_THAT(refusal(scene(periodic + R"(, "top": "wall", "height_m": 1.9)")),
               Equals("scene.json: /channel/height_m: 1.9 m is lower than the water of /channel/depth_m, which reaches "
                      "up to 2 m; allowed: >= 2 m."));
    CHECK_NOTHROW(load_patched(scene(periodic + R"(, "top": "wall", "height_m": 2)")));
    CHECK_THAT(refusal(scene(blocks(block(R"("y_min_m": 1, "depth_m": 1.5)"), R"(, "top": "wall", "height_m": 2)"))),
               Contains("lower than /channel/water_blocks/0, which reaches up to 2.5 m"));
    const std::string round = periodic + R"(, "top": "periodic", "height_m": 4)";
    CHECK_THAT(refusal(scene(round)), Contains("/world/gravity_m_s2: 9.81 m/s2 would let the water fall for ever"));
    CHECK_NOTHROW(load_patched(scene(round), {"/world/gravity_m_s2=0"}));
    CHECK_THAT(refusal(scene(round), {"/world/gravity_m_s2=0", "/obstacles/0=" + block(R"("height_m": 1)")}),
               Contains("/obstacles: there is no bed"));
    CHECK_THAT(refusal(scene(round + bed(bump)), {"/world/gravity_m_s2=0"}),
               Contains("/channel/bed_points: there is no"));
    CHECK_THAT(refusal(scene(round + R"(, "manning_n": 0.03)"), {"/world/gravity_m_s2=0"}),
               Contains("/channel/manning_n: 0.03 s/m^(1/3) is the friction of a bed"));
    CHECK_THAT(refusal(scene(round + R"(, "slope": 0.01)"), {"/world/gravity_m_s2=0"}),
               Contains("/channel/slope: 0.01 has no effect where /channel/top is \"periodic\""));
}

TEST_CASE("points of the bed ascend and leave room for the water") {
    CHECK_NOTHROW(load_patched(scene(periodic + bed(bump))));
    CHECK_THAT(refusal(scene(periodic + bed(point(10, 0) + "," + point(10, 0.5)))),
               Equals("scene.json: /channel/bed_points/1/x_m: 10 m is not larger than that of the point before; "
                      "allowed: > 10 m."));
    CHECK_THAT(refusal(scene(periodic + bed(point(10, 0) + "," + point(14, 1.6)))),
               Equals("scene.json: /channel/bed_points/1/y_m: 1.6 m leaves less than a particle spacing below the "
                      "water's surface at /channel/depth_m = 2 m; allowed: <= 1.5 m."));
    CHECK_THAT(refusal(scene(R"("top": "wall", "height_m": 1)" + bed(point(10, 0.6)))),
               Contains("below the lid at /channel/height_m = 1 m; allowed: <= 0.5 m."));
    CHECK_THAT(refusal(scene(periodic + bed(point(-1, 0)))),
               Contains("/channel/bed_points/0/x_m: -1.0 is out of range"));
    CHECK_THAT(refusal(scene(periodic + bed(point(1, -1)))),
               Contains("/channel/bed_points/0/y_m: -1.0 is out of range"));
    CHECK_THAT(refusal(scene(periodic + bed(point(10, 0) + "," + point(12, 1.2)))),
               Contains("/channel/bed_points/1/y_m: 1.2 m is 1.2 m from that of the point before, steeper than 1 : 2; "
                        "allowed: 0 to 1 m. A step is an obstacle."));
}

TEST_CASE("the bed is level at a periodic joint and at the emitter") {
    CHECK_THAT(refusal(scene(periodic + bed(point(10, 0) + "," + point(20, 0.5)))),
               Equals("scene.json: /channel/bed_points: the bed lies at 0.5 to 0.5 m within x 39 to 40 m, next to the "
                      "periodic joint; allowed: 0 m there."));
    CHECK_THAT(refusal(scene(recirculating + R"(, "depth_m": 2)" +
                             bed(point(0.9, 0) + "," + point(2, 0.5) + "," + point(3, 0)))),
               Contains("within x 0 to 1 m, next to the periodic joint; allowed: 0 m there."));
    CHECK_THAT(refusal(scene(emitter + bed(point(10, 0) + "," + point(20, 0.5)))),
               Contains("at the emitter; allowed: 0 m there."));
    CHECK_NOTHROW(load_patched(scene(emitter + bed(point(10, 0.5) + "," + point(39, 0)))));
}

TEST_CASE("a block of water keeps out of the bed") {
    const std::string beach = bed(point(6, 0) + "," + point(14, 2));
    CHECK_NOTHROW(load_patched(scene(blocks(block(), beach))));  // a wedge
    CHECK_THAT(refusal(scene(blocks(block(R"("y_min_m": 1.5, "depth_m": 1)"), beach))),
               Contains("/channel/water_blocks/0/y_min_m: 1.5 m reaches into the bed, which rises to 2 m"));
    CHECK_THAT(
        refusal(scene(blocks(block(), bed(point(1, 0.6))))),
        Contains("/channel/water_blocks/0/depth_m: 1 m, counted from y = 0 m, leaves less than a particle spacing") &&
            Contains("allowed: >= 1.1 m."));
}

TEST_CASE("a plane without slip exists, is named once and does not move across itself") {
    const auto refused = [](const std::string& plane, const std::string& channel = "") {
        const std::string water = channel.empty() ? "" : channel + ", ";
        return refusal(scene(water + R"("manning_n": 0)" + no_slip(plane)));
    };
    CHECK_NOTHROW(
        load_patched(scene(R"("top": "wall")" + no_slip(R"({"plane": "bed"}, {"plane": "x_min", "velocity_z_m_s": 1},
        {"plane": "top", "velocity_x_m_s": 1})"))));
    CHECK_THAT(
        refused(R"({"plane": "top"})"),
        Equals("scene.json: /channel/no_slip/0/plane: there is no plane \"top\", as /channel/top is not \"wall\"."));
    CHECK_THAT(refused(R"({"plane": "x_max"})", emitter), Contains("as /channel/flow is not \"closed\""));
    CHECK_THAT(refused(R"({"plane": "z_min"})", R"("sides": "periodic")"), Contains("/channel/sides is not \"walls\""));
    CHECK_THAT(refused(R"({"plane": "obstacles"})"), Contains("as /obstacles is empty"));
    CHECK_THAT(refused(R"({"plane": "bed"}, {"plane": "x_min"}, {"plane": "bed"})"),
               Contains("/channel/no_slip/2/plane: \"bed\" has its velocity in /channel/no_slip/0 already."));
    CHECK_THAT(
        refused(R"({"plane": "bed", "velocity_y_m_s": 1})"),
        Equals("scene.json: /channel/no_slip/0/velocity_y_m_s: 1 m/s would move \"bed\" into or out of the water; "
               "allowed: 0 m/s."));
    CHECK_THAT(refused(R"({"plane": "x_min", "velocity_x_m_s": 1})"), Contains("/channel/no_slip/0/velocity_x_m_s"));
    CHECK_THAT(refused(R"({"plane": "z_max", "velocity_z_m_s": -1})"), Contains("/channel/no_slip/0/velocity_z_m_s"));
    CHECK_THAT(refusal(scene(periodic + bed(bump) + no_slip(R"({"plane": "bed", "velocity_x_m_s": 1})"))),
               Contains("/channel/no_slip/0/velocity_x_m_s"));
    CHECK_THAT(refusal(scene(R"("manning_n": 0)" + no_slip(R"({"plane": "bed"})")), {"/fluid/viscosity_m2_s=0"}),
               Contains("/channel/no_slip: without viscosity a plane does not hold the water"));
}

TEST_CASE("a slope in a recirculating channel is refused") {
    CHECK_NOTHROW(load_patched(scene(periodic + R"(, "slope": 0.01, "manning_n": 0.03)")));
    CHECK_NOTHROW(load_patched(scene(emitter + R"(, "slope": 0.01)")));
    CHECK_THAT(refusal(scene(recirculating + R"(, "slope": 0.01)")),
               Contains("/channel/slope: 0.01 has no effect in a recirculating channel"));
}

TEST_CASE("an inflow that changes needs a flow that has one, and times in order") {
    const std::string history =
        R"(, "velocity_history": [{"time_s": 1, "velocity_m_s": 0}, {"time_s": 5, "velocity_m_s": 2}])";
    CHECK(load_patched(scene(R"("flow": "emitter")" + history)).scene.channel->velocity_history.size() == 2);
    CHECK_NOTHROW(load_patched(scene(recirculating + history)));
    CHECK_THAT(refusal(scene(periodic + history)),
               Contains("/channel/velocity_history: nothing sets the speed of a periodic channel"));
    CHECK_THAT(refusal(scene(R"("manning_n": 0)" + history)), Contains("nothing sets the speed of a closed channel"));
    CHECK_THAT(refusal(scene(emitter + history), {"/channel/velocity_history/1/time_s=0.5"}),
               Equals("scene.json: /channel/velocity_history/1/time_s: 0.5 s is earlier than that of the point before; "
                      "allowed: >= 1 s."));
    CHECK_NOTHROW(load_patched(scene(emitter + history), {"/channel/velocity_history/1/time_s=1"}));
    CHECK_THAT(refusal(scene(emitter + history), {"/channel/velocity_history/1/velocity_m_s=0"}),
               Contains("/channel/velocity_history: all velocities are 0 m/s"));
}

TEST_CASE("a kinematic stream refuses what only a solver can take into account") {
    const auto refused = [](const std::string& more) {
        return refusal(scene(emitter + ", " + more), {"/fluid/model=kinematic"});
    };
    const std::string why = "/fluid/model: \"kinematic\" solves nothing, so /channel/";
    CHECK_THAT(refused(R"("top": "wall", "height_m": 3)"), Contains(why + "top would have no effect"));
    CHECK_THAT(refused(bed(bump).substr(1)), Contains(why + "bed_points"));
    CHECK_THAT(refused(R"("slope": 0.01)"), Contains(why + "slope"));
    CHECK_THAT(refused(R"("manning_n": 0.01)"), Contains(why + "manning_n"));
    CHECK_THAT(refused(no_slip(R"({"plane": "bed"})").substr(1)), Contains(why + "no_slip"));
    CHECK_THAT(refused(R"("velocity_history": [{"time_s": 0, "velocity_m_s": 1}])"),
               Contains(why + "velocity_history"));
    CHECK_THAT(refusal(scene(periodic), {"/fluid/model=kinematic"}), Contains("/channel/flow is \"periodic\""));
}
