#pragma once
// The list of keys of each struct of a scene.

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fields.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/steering.hpp"

namespace wade {

void fields(Scene& scene, Fields& f);
void fields(World& world, Fields& f);
void fields(Obstacle& obstacle, Fields& f);

void fields(Channel& channel, Fields& f);
void fields(BedPoint& point, Fields& f);
void fields(NoSlip& wall, Fields& f);
void fields(VelocityPoint& point, Fields& f);
void fields(WaterBlock& block, Fields& f);

void fields(SiteKeys& site, Fields& f);
void fields(GroundKeys& ground, Fields& f);
void fields(HouseKeys& house, Fields& f);
void fields(ZoneKeys& zone, Fields& f);
void fields(ManningKeys& manning, Fields& f);
void fields(SourceKeys& source, Fields& f);
void fields(RainKeys& rain, Fields& f);
void fields(OutletKeys& outlet, Fields& f);
void fields(GateKeys& gate, Fields& f);
void fields(WallKeys& wall, Fields& f);
void fields(WaterKeys& water, Fields& f);
void fields(ShelterKeys& shelter, Fields& f);

void fields(Fluid& fluid, Fields& f);
void fields(Kinematic& kinematic, Fields& f);
void fields(ShallowWaterGrid& grid, Fields& f);
void fields(MixedWindow& mixed, Fields& f);
void fields(Steering& steering, Fields& f);
void fields(SteeringClass& kind, Fields& f);
void fields(SteeringBody& body, Fields& f);

// The crowd takes a step for each frame unless it says otherwise; a group takes over the crowd's values.
void fields(Crowd& crowd, Fields& f, double frame_rate);
void fields(AgentGroup& group, Fields& f, const AgentGroup& of_crowd);
void fields(LeavingPoint& point, Fields& f);
void fields(Leaving& leaving, Fields& f);
void fields(Rope& rope, Fields& f);
void fields(EvasionSettings& evasion, Fields& f);
void fields(NavigationSettings& navigation, Fields& f);
void fields(RagdollRule& ragdoll, Fields& f);
void fields(PathSettings& paths, Fields& f);

// What the coupling is by default depends on the water.
void fields(Coupling& coupling, Fields& f, const Scene& scene);
void fields(TauPoint& point, Fields& f);
void fields(TauEvent& event, Fields& f, double frame_rate);

// Letters, digits, '_', '-' and '.', for what becomes a folder or a column.
inline constexpr TextRule short_name{1, 64, "A-Za-z0-9_.-"};

// x_min_m, x_max_m, z_min_m and z_max_m of a box.
void box_fields(Fields& f, Interval& x, Interval& z);

// velocity_x_m_s and so on, up to `fastest`, m/s, in either direction.
void velocity_fields(Fields& f, std::array<double, 3>& velocity, double fastest, std::string_view meaning_of_x);

}  // namespace wade
