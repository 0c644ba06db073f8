#include "tests/bench/scenes.hpp"

#include <cmath>

#include "configs/loading/scene_loader.hpp"

namespace wade::bench {

Scene scene_of(const std::string& file, const std::map<std::string, std::string>& values) {
    std::vector<SceneOverride> overrides;
    for (const auto& [pointer, value] : values) overrides.push_back({pointer, value, "bench"});
    return load_scene(std::string(WADE_CONFIGS) + "/bench/" + file, overrides).scene;
}

Scene river_scene(const River& river, std::map<std::string, std::string> more) {
    more.merge(std::map<std::string, std::string>{{"/world/length_m", std::to_string(river.length)},
                                                  {"/world/width_m", std::to_string(river.width)},
                                                  {"/channel/x_max_m", std::to_string(river.length)},
                                                  {"/channel/z_max_m", std::to_string(river.width)},
                                                  {"/fluid/particle_spacing_m", std::to_string(river.spacing)},
                                                  {"/fluid/max_particles", std::to_string(river.size)}});
    return scene_of("river.json", more);
}

std::string boxes_on_grid(const River& river, int columns, int rows) {
    std::string boxes;
    for (int k = 0; k < columns * rows; ++k) {
        const double x = (k % columns + 0.5) * river.length / columns, z = (k / columns + 0.5) * river.width / rows;
        const auto side = [](const std::string& axis, double middle) {
            return '"' + axis + "_min_m\": " + std::to_string(middle - 0.5) + ", \"" + axis +
                   "_max_m\": " + std::to_string(middle + 0.5) + ", ";
        };
        boxes += (k > 0 ? ", {" : "{") + side("x", x) + side("z", z) + "\"height_m\": 3}";
    }
    return '[' + boxes + ']';
}

std::map<std::string, std::string> block_in_the_corner() {
    return {{"/channel/flow", "\"closed\""},
            {"/channel/initial_river", "\"dry\""},
            {"/channel/velocity_m_s", "0"},
            {"/channel/water_blocks", R"([{"x_min_m": 0, "x_max_m": 50, "z_min_m": 0, "z_max_m": 50, "depth_m": 1}])"}};
}

Scene river_with_crowd(std::uint64_t particles, int columns, int rows, std::map<std::string, std::string> more,
                       const std::string& who) {
    constexpr double length = 100, width = 27;
    const std::string groups = R"([{"name": "waders", "columns": )" + std::to_string(columns) + R"(, "rows": )" +
                               std::to_string(rows) + R"(, "start": {"x_m": 0.4, "z_m": 0.2, "pitch_x_m": )" +
                               std::to_string(length / columns) + R"(, "pitch_z_m": )" + std::to_string(width / rows) +
                               R"(, "jitter_m": 0.2}, "goal": {"x_m": 50, "z_m": 27}, )" + who + "}]";
    const double spacing = std::cbrt(length * width / static_cast<double>(particles));
    more.merge(std::map<std::string, std::string>{{"/fluid/particle_spacing_m", std::to_string(spacing)},
                                                  {"/fluid/max_particles", std::to_string(particles + 1000)},
                                                  {"/crowd/groups", groups}});
    return scene_of("river.json", more);
}

}  // namespace wade::bench
