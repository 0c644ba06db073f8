#include "crowd_client/people/drift.hpp"

#include <algorithm>
#include <cmath>

#include "crowd_client/people/wear.hpp"

namespace wade::crowd {
namespace {

constexpr double of_swimmers = 0.25, of_children = 1.5, child_below = 1.4;  // M_swim; M_child; H, m
constexpr double of_calm = 0.5, of_rough = 1, of_wild = 3;                  // M_Fr
constexpr double calm = 0.3, rough = 0.6, wild = 1;                         // Fr
constexpr double warm_breath = 38, cold_time = 120;                         // s
constexpr double struggle_back = 3;                                         // as fast as it goes

double froude_weight(double froude) {
    if (froude <= rough) return std::lerp(of_calm, of_rough, std::max(0.0, (froude - calm) / (rough - calm)));
    return std::lerp(of_rough, of_wild, std::min(1.0, (froude - rough) / (wild - rough)));
}

}  // namespace

double drift_weight(const Drifter& drifter) {
    if (!(drifter.depth > 0)) return 0;
    const double froude = drifter.speed / std::sqrt(drifter.gravity * drifter.depth);
    return (drifter.swims ? of_swimmers : 1) * (drifter.height < child_below ? of_children : 1) * froude_weight(froude);
}

double cold_weight(const std::optional<double>& water_temperature, double adrift) {
    if (!water_temperature || adrift >= cold_time) return 1;
    return std::max(1.0, warm_breath / breath_in(*water_temperature));
}

void drift_on(Drift& drift, double weight, bool counts, double dt) {
    drift.time += dt;
    if (!counts) return breathe(drift, dt);
    const double counted = std::clamp(drift.struggle + dt - struggle_time, 0.0, dt);
    drift.struggle = std::min(struggle_time, drift.struggle + dt);
    drift.exposure += weight * counted;
}

void breathe(Drift& drift, double dt) {
    drift.struggle = std::max(0.0, drift.struggle - struggle_back * dt);
}

}  // namespace wade::crowd
