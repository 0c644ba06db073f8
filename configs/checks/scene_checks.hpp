#pragma once
// Checks that need several values of a scene at once.

#include <string>
#include <vector>

#include "configs/errors/problems.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// Tolerance for sums of decimal values such as 6 * 0.05, which differ from the decimal sum by rounding.
inline constexpr double rounding_tolerance = 1e-9;

// Throws one ConfigurationError with a line for each fault; a line begins with `source` and the JSON pointer. Faults of
// the geometry, then of the site, end the checks, because later checks compute with their lengths and positions:
//   geometry    intervals, the channel in the world, obstacles and water blocks in the channel and apart from one another
//   boundaries  bed points, top, planes without slip, slope, friction, an inflow that changes
//   site        if the scene has one: ground without holes, houses and water that lie on it, and no agents in walls
//   water       a possible flow, spacing against the channel, periodic lengths, capacity, iteration limits
//   crowd       groups, start positions, goals, markers, ragdoll, events
void check_scene(const Scene& scene, const std::string& source);

// Start positions of a scene's agents before their jitter, m, in the order of agent ids.
struct StartPlace {
    double x = 0, z = 0;
    std::size_t group = 0;
};
[[nodiscard]] std::vector<StartPlace> start_places(const Crowd& crowd);

// The parts.
void check_geometry(const Scene& scene, const std::string& source, Problems& problems);
void check_boundaries(const Scene& scene, const std::string& source, Problems& problems);
void check_water(const Scene& scene, const std::string& source, Problems& problems);
void check_ground(const Scene& scene, const std::string& source, Problems& problems);
void check_site(const Scene& scene, const std::string& source, Problems& problems);
// Requires shapes that check_site() has found in the world.
void check_outlets(const Scene& scene, const std::string& source, Problems& problems);
void check_crowd(const Scene& scene, const std::string& source, Problems& problems);

// Parts of the boundaries and of the water; each throws for the first that is wrong.
void check_bed(const Scene& scene, const std::string& source);
void check_shallow_water(const Scene& scene, const std::string& source);
void check_mixed(const Scene& scene, const std::string& source);
void check_steering(const Scene& scene, const std::string& source);

// Parts of the crowd: events that name what exists; houses, shelters and residents of a site.
void check_events(const Scene& scene, const std::string& source, Problems& problems);
void check_residents(const Scene& scene, const std::string& source, Problems& problems);

// A sentence for each gap between obstacles, or between one and a wall, that is so narrow that particles choke in it, the narrowest
// first; of more than five the last sentence tells how many. None if the water does not consist of particles.
[[nodiscard]] std::vector<std::string> narrow_gaps(const Scene& scene);

// Returns warnings for frame or step rates so low that outcomes of people with the body response depend on them in
// changing water; for both programs.
[[nodiscard]] std::vector<std::string> rate_warnings(const Scene& scene);

// Whether the flow brings or starts with water up to channel.depth.
[[nodiscard]] bool has_river(const Channel& channel);

// Lines on the map; scene_checks_site.cpp.
namespace on_map {

// Twice the area of a triangle, m2, positive if its corners run from x towards z.
[[nodiscard]] double turn(const MapPoint& a, const MapPoint& b, const MapPoint& c);

// Whether the lines from a to b and from c to d cross.
[[nodiscard]] bool cross(const MapPoint& a, const MapPoint& b, const MapPoint& c, const MapPoint& d);

// The point of the line from a to b that is nearest to p.
[[nodiscard]] MapPoint nearest_on(const MapPoint& a, const MapPoint& b, const MapPoint& p);

}  // namespace on_map

// A number as errors show it: up to six digits, no trailing zeros.
[[nodiscard]] std::string short_number(double value);

// Throws "SOURCE: POINTER: SENTENCE".
[[noreturn]] void refuse(const std::string& source, const std::string& pointer, const std::string& sentence);

// Throws at the first time of a list, s, that is earlier than the time before it.
void check_times(const std::vector<double>& times, const std::string& source, const std::string& list);

}  // namespace wade
