#include <catch2/catch.hpp>

#include "open_scenes.hpp"

using namespace wade::fluid::model_choice;
using wade::fluid::model_choice::test::river;
using wade::fluid::model_choice::test::scene_with;

namespace {

// Their names, with blanks between.
std::string kinds(const std::string& channel, const std::string& more = "") {
    std::string list;
    for (const KindOfWater& kind : water_of(scene_with(channel, more).scene).kinds) {
        if (!list.empty()) list += ' ';
        list += name_of(kind.kind);
    }
    return list;
}

std::string block(const std::string& x, const std::string& depth) {
    return R"({"x_min_m": )" + x + R"(, "z_min_m": 1, "z_max_m": 7, "depth_m": )" + depth + "}";
}

}  // namespace

TEST_CASE("what the water of a scene is follows from the scene") {
    const std::string obstacle =
        R"(, "obstacles": [{"x_min_m": 3.5, "x_max_m": 5, "z_min_m": 5, "z_max_m": 6.5, "height_m": 2}])";
    const std::string emitter = R"("flow": "emitter", "velocity_m_s": 1)";
    const std::string history =
        R"(, "velocity_history": [{"time_s": 0, "velocity_m_s": 1}, {"time_s": 5, "velocity_m_s": 2}])";
    const std::string closed = R"("flow": "closed", "water_blocks": [)";
    const std::string half = block(R"(6, "x_max_m": 12)", "1"), rest = block(R"(0, "x_max_m": 6)", "0.5");

    CHECK(kinds(river) == "river");
    CHECK(kinds(river, obstacle) == "river lee");
    CHECK(kinds(river + history) == "river wet_front");
    CHECK(kinds(emitter) == "inflow");
    CHECK(kinds(emitter + history) == "inflow");
    CHECK(kinds(emitter + R"(, "initial_river": "filled")") == "inflow river");
    CHECK(kinds(closed + half + "]") == "dry_front");
    CHECK(kinds(closed + half + ", " + rest + "]") == "wet_front");
    CHECK(kinds(closed + half + "]", obstacle) == "dry_front lee");
    CHECK(kinds(closed + block(R"(0, "x_max_m": 12)", "1") + "]") == "river");
    CHECK(kinds(emitter + R"(, "bed_points": [{"x_m": 2, "y_m": 0.3}, {"x_m": 6, "y_m": 0}])") == "inflow wet_front");
    CHECK(kinds(R"("flow": "closed")") == "river");
}

TEST_CASE("lengths of the table grow with the depth, but no further than the contact distance allows") {
    const auto scale = [](const std::string& depth, const std::string& more) {
        const std::string flow =
            R"("flow": "recirculating", "initial_river": "filled", "velocity_m_s": 1, "depth_m": )";
        return water_of(scene_with(flow + depth, more).scene).scale;
    };
    CHECK(scale("0.5", "") == Approx(0.5));
    CHECK(scale("1", "") == Approx(1));
    CHECK(scale("3", "") == Approx(1));  // contact distance 0.25 m, as in the table
    CHECK(scale("3", R"(, "coupling": {"contact_rule": "sum"})") == Approx(3));
}
