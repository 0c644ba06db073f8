#pragma once
// One function a case file.

#include "validation_case.hpp"

namespace wade::validation {

inline constexpr double standard_gravity = 9.81;  // m/s2, of scenes that do not set another

Case column_case();
Case dam_break_case();
Case wet_bed_01_case();
Case wet_bed_02_case();
Case wet_bed_05_case();
Case collapse_case();
Case spheric2_case();
Case sloshing_case();
Case uniform_river_case();
Case uniform_river_600s_case();
Case manning_river_case();
Case manning_river_600s_case();
Case bump_subcritical_case();
Case bump_transcritical_case();
Case bump_jump_case();
Case jump_fr2_case();
Case jump_fr3_case();
Case jump_fr5_case();
Case jump_fr5_wide_case();
Case block_case();
Case taylor_green_case();
Case cavity_100_case();
Case cavity_400_case();
Case cavity_1000_case();
Case poiseuille_case();
Case couette_case();
Case impulse_river_case();
Case impulse_front_case();
Case impulse_lee_case();
Case people_drag_case();
Case people_drag_half_deep_case();
Case people_drag_slow_case();
Case people_drag_fast_case();
Case people_crowd_case();
Case people_crowd_dense_case();
Case people_file_case();
Case people_file_open_case();
Case people_wall_case();
Case people_free_body_case();
Case people_rates_case();
Case people_vegetation_case();
Case people_row_case();
Case crowd_free_speed_case();
Case crowd_rimea_01_case();
Case crowd_rimea_04_case();
Case crowd_rimea_06_case();
Case crowd_rimea_09_case();
Case crowd_rimea_12_case();
Case crowd_circle_case();
Case crowd_counterflow_case();
Case crowd_mirror_case();
Case crowd_bodies_case();
Case crowd_openings_case();
Case crowd_doors_case();
Case crowd_pushed_case();
Case crowd_rooms_case();
Case crowd_blocks_case();
Case crowd_two_way_doors_case();
Case crowd_two_way_case();
Case crowd_crossing_case();
Case crowd_head_on_case();
Case crowd_walks_case();
Case crowd_corner_case();
Case crowd_exits_case();
Case crowd_cabins_case();
Case crowd_step_rates_case();
Case turned_column_case();
Case turned_lake_house_case();
Case turned_lake_l_case();
Case turned_shore_case();
Case turned_bumps_case();
Case turned_dam_break_case();
Case turned_block_case();
Case turned_street_case();
Case site_bowl_case();
Case site_lake_case();
Case site_street_case();
Case site_long_channels_case();
Case site_hydrograph_case();
Case site_merewether_case();
Case site_seaside_case();

}  // namespace wade::validation
