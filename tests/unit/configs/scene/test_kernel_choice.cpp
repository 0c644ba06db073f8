// Which kernel "auto" takes for a scene.

#include "configs/scene/fluid.hpp"
#include "configs/scene/kernel_choice.hpp"
#include "scene_texts.hpp"

using namespace wade::test;
using wade::KernelKind;

namespace wade::kernel_choice_test {
namespace {

const std::vector<std::string> by_itself{"/fluid/kernel=auto"};

KernelKind chosen(const std::string& scene, std::vector<std::string> assignments = {}) {
    std::vector<wade::SceneOverride> overrides{wade::parse_override(by_itself[0])};
    for (const std::string& one : assignments) overrides.push_back(wade::parse_override(one));
    return wade::load_scene(std::filesystem::path(WADE_SCENES) / (scene + ".json"), overrides).scene.fluid->kernel;
}

const std::string river = R"({"channel": {"flow": "recirculating", "initial_river": "filled"}})";

std::string tank(const std::string& blocks, const std::string& more = "") {
    return R"({"fluid": {"particle_spacing_m": 1}, "channel": {"water_blocks": [)" + blocks + "]" + more + "}}";
}

}  // namespace

TEST_CASE("a front takes the cubic spline, rivers, waves and still water the quartic one, a full channel Wendland's") {
    for (const std::string scene : {"paper/s05", "validation/dam_break", "validation/wet_bed",
                                    "validation/impulse_front", "validation/spheric2", "model_choice/block_front"}) {
        INFO(scene);
        CHECK(chosen(scene) == KernelKind::cubic_spline);
    }
    for (const std::string scene :
         {"river/s05", "manning/s08", "validation/column", "validation/people_river", "validation/impulse_river"}) {
        INFO(scene);
        CHECK(chosen(scene) == KernelKind::quartic_spline);
    }
    for (const std::string scene : {"validation/cavity", "validation/taylor_green"}) {
        INFO(scene);
        CHECK(chosen(scene) == KernelKind::wendland_c2);
    }
}

TEST_CASE("a scene by itself is the same scene as with the kernel that it takes") {
    const auto quartic = load_patched(river, {"/fluid/kernel=quartic_spline"});
    const auto by_itself_too = load_patched(river, {by_itself[0]});
    CHECK(by_itself_too.scene.hash == quartic.scene.hash);
    CHECK(by_itself_too.canonical_json == quartic.canonical_json);
}

TEST_CASE("a tank is still if its blocks fill it to one level and rest") {
    const std::string half = R"({"x_min_m": 0, "x_max_m": 20, "z_min_m": 10, "z_max_m": 30, "depth_m": 2})";
    const std::string other = R"({"x_min_m": 20, "x_max_m": 40, "z_min_m": 10, "z_max_m": 30, "depth_m": )";
    const auto kernel_of = [](const std::string& patch) { return load_patched(patch, by_itself).scene.fluid->kernel; };
    CHECK(kernel_of(tank(half + "," + other + "2}")) == KernelKind::quartic_spline);
    CHECK(kernel_of(tank(half)) == KernelKind::cubic_spline);
    CHECK(kernel_of(tank(half + "," + other + "1}")) == KernelKind::cubic_spline);
    CHECK(kernel_of(tank(half + "," + other + R"(2, "velocity_x_m_s": 1})")) == KernelKind::cubic_spline);
    const std::string lid = R"(, "top": "wall", "height_m": )";
    CHECK(kernel_of(tank(half + "," + other + "2}", lid + "2")) == KernelKind::wendland_c2);
    CHECK(kernel_of(tank(half + "," + other + "2}", lid + "9")) == KernelKind::quartic_spline);
}

TEST_CASE("a kernel that reaches too far for the walls gives way to a nearer one") {
    const auto in_width = [](double width, const std::string& more) {
        const std::string z_max = "/channel/z_max_m=" + std::to_string(10 + width);
        return load_patched(river,
                            {z_max, "/fluid/particle_spacing_m=1", "/fluid/max_particles=1000", by_itself[0], more})
            .scene.fluid->kernel;
    };
    CHECK(in_width(1.5, "/seed=1") == KernelKind::quartic_spline);
    CHECK(in_width(1.3, "/seed=1") == KernelKind::cubic_spline);
    CHECK(in_width(9, "/fluid/support_in_spacings=2.1") == KernelKind::cubic_spline);
    // Three supports of Wendland's kernel are 9 d, of the quartic one 7.2 d.
    CHECK(load_patched(R"({"channel": {"flow": "recirculating", "initial_river": "filled", "top": "periodic",
                           "height_m": 8, "depth_m": 8}, "fluid": {"particle_spacing_m": 1}, "world": {"gravity_m_s2": 0}})",
                       by_itself)
              .scene.fluid->kernel == KernelKind::quartic_spline);
}

}  // namespace wade::kernel_choice_test
