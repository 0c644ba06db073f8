#include "cases.hpp"

namespace wade::validation {

const std::vector<Case>& all_cases() {
    // The order of the report: rest, free-surface flow, channels, viscous flow, agents, crowd.
    static const std::vector<Case> cases{
        column_case(),
        dam_break_case(),
        wet_bed_02_case(),
        wet_bed_05_case(),
        wet_bed_01_case(),
        collapse_case(),
        spheric2_case(),
        sloshing_case(),
        uniform_river_case(),
        uniform_river_600s_case(),
        manning_river_case(),
        manning_river_600s_case(),
        bump_subcritical_case(),
        bump_transcritical_case(),
        bump_jump_case(),
        jump_fr2_case(),
        jump_fr3_case(),
        jump_fr5_case(),
        jump_fr5_wide_case(),
        block_case(),
        poiseuille_case(),
        couette_case(),
        taylor_green_case(),
        cavity_100_case(),
        cavity_400_case(),
        cavity_1000_case(),
        impulse_river_case(),
        impulse_front_case(),
        impulse_lee_case(),
        crowd_free_speed_case(),
        crowd_rimea_01_case(),
        crowd_rimea_04_case(),
        crowd_rimea_06_case(),
        crowd_rimea_09_case(),
        crowd_rimea_12_case(),
        crowd_circle_case(),
        crowd_counterflow_case(),
        crowd_mirror_case(),
        crowd_bodies_case(),
    };
    return cases;
}

}  // namespace wade::validation
