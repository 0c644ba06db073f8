#pragma once
// Scenes with the model "auto", and tables made up for tests.

#include <string>

#include "configs/loading/scene_loader.hpp"
#include "fluid_server/model_choice/model_choice.hpp"

namespace wade::fluid::model_choice::test {

inline const std::string river =
    R"("flow": "recirculating", "initial_river": "filled", "depth_m": 1, "velocity_m_s": 1.5)";

// A channel of 12 m x 6 m with four people that stand in it. `more` is JSON of the scene after a comma.
inline LoadedScene scene_with(const std::string& channel, const std::string& more = "",
                              const std::string& demand = "0.1") {
    const std::string text =
        R"({"duration_s": 10, "world": {"length_m": 12, "width_m": 8}, "channel": {"x_min_m": 0, "x_max_m": 12,
        "z_min_m": 1, "z_max_m": 7, )" +
        channel +
        R"(}, "crowd": {"groups": [{"name": "g", "columns": 4, "start": {"x_m": 2, "z_m": 4, "pitch_x_m": 2},
        "goal": {"x_m": 12, "z_m": 8}, "desired_speed_m_s": 0}]}, "fluid": {"model": "auto", "max_impulse_error": )" +
        demand + "}" + more + "}";
    return load_scene_text(text, "open.json");
}

inline const std::string header =
    "kind,model,spacing_m,tolerance,divergence_tolerance,cfl,kernel,impulse_median,impulse_p95,steps_per_s,"
    "us_per_particle_step,wave_speed_m_s\n";

// A cheap model that is 20 % wrong in a river and 60 % in a lee, and dfsph at two spacings. Estimates are 1.5 times that.
inline std::vector<TableRow> made_up_table() {
    return parse_table("# made up\n" + header +
                       "river,shallow_water,0.5,,,,,0.2,0.3,30,0.1,4.6\n"
                       "river,dfsph,0.4,0.0005,0.001,0.5,cubic_spline,0.06,0.1,30,1,4.6\n"
                       "river,dfsph,0.2,0.0005,0.001,0.5,cubic_spline,0.02,0.04,60,1,4.6\n"
                       "lee,shallow_water,0.5,,,,,0.6,0.9,30,0.1,4.6\n"
                       "lee,dfsph,0.4,0.0005,0.001,0.5,cubic_spline,0.1,0.3,30,1,4.6\n"
                       "lee,dfsph,0.2,0.0005,0.001,0.5,cubic_spline,0.04,0.1,60,1,4.6\n");
}

}  // namespace wade::fluid::model_choice::test
