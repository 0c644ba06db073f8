#pragma once
// What kinds of water a scene has. All rules stand here.
//
//   obstacles                        lee
//   recirculating, or a filled periodic channel                     river
//   emitter                          inflow; river as well if it starts filled
//   velocity_history of a river, from an emitter or recirculating   wet_front as well
//   water blocks                     dry_front if they leave ground dry, wet_front if they differ in depth, else river
//   bed_points                       wet_front as well, as depth and speed change along the way
//
// A scene of several kinds takes the worst error of them.

#include <string>
#include <vector>

#include "fluid_server/model_choice/table.hpp"

namespace wade::fluid::model_choice {

struct KindOfWater {
    WaterKind kind = WaterKind::river;
    std::string why;
};

struct SceneWater {
    std::vector<KindOfWater> kinds;  // each once, at least one
    double depth = 0;                // of the deepest water that there is or comes in, m
    double velocity = 0;             // the largest v_F or velocity of a block, m/s
    // What lengths of the table, in metres, are multiplied with: the depth, or if that is less the contact distance over that
    // of the table. The coarser the particles are against either, the more what touches an agent scatters.
    double scale = 1;
};

[[nodiscard]] SceneWater water_of(const Scene& scene);

// Within which particles touch an agent, by Coupling::contact_rule, m.
[[nodiscard]] double contact_distance(const Coupling& coupling);

// sqrt(g depth) + velocity, m/s.
[[nodiscard]] double wave_speed(const Scene& scene, const SceneWater& water);

}  // namespace wade::fluid::model_choice
