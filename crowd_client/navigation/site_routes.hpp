#pragma once
// Routes in a site: around houses, over slopes, to shelters, high ground or a goal, as the water rises.
//
// Travel-time fields (travel_time.hpp) start from all goal nodes at once. For shelters with free capacity these are the
// nodes within reach of their polygons, and ground above /crowd/navigation/safe_above_m. For a group's own goal they
// are the nodes of the disc around it. Fields are solved at the start, every /crowd/navigation/every_s, and when a
// shelter becomes full, for each group with
//
//   s = 1 / (r w)            on ground that it may enter, 1000 times as much elsewhere
//   r                        walking_speed_ratio() of the group in the water there, by its fraction of men
//                            (people/person.hpp)
//   w                        for a slope of steepness S, uphill and downhill alike: (t(S) + t(-S)) / 2
//   t(S) = exp(-3.5 |S + 0.05|) / exp(-0.175)    Tobler, Three presentations on geographical analysis and modeling,
//                            NCGIA report 93-1 (1993): speed over that on level ground, S the rise along the route
//   may enter                D < 0.8 for the group's mean person standing there, and at most enters_up_to_m of water
//
// Water is sampled in cells of 2 m, whatever the cells of the fluid: depth = mass / (rho A), velocity = momentum /
// mass. A is the larger of the cell's area without houses and its area under columns, at least 1/16 of the cell.
//
// An unwarned agent follows a field without water. Once it sees water that it may not enter, up to sight_m ahead on its
// route with no house between, it changes to the field of the warned agents for good [A]. An agent outside of such
// water that would be in it a metre on waits at its edge [A]. An agent caught in it, or afloat, follows the field out
// of it. An agent without a route stays.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/navigation/travel_time_fields.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

inline constexpr double shelter_reach = 1;  // distance at which an agent is at a shelter, m [A]

// Returns the speed on a slope over that on level ground; rise: metres a metre along the route.
[[nodiscard]] double tobler(double rise);

// Returns fields for the groups of the scene's people, without water. Throws ConfigurationError for people who go to
// shelters in a scene without shelters and high ground or with the rule `straight`, for too many cells for the memory,
// and, with the rule `travel_time`, for people without a route.
[[nodiscard]] Navigation make_site_routes(const Scene& scene, const Agents& agents);

// Returns whether this step updates the routes from the water of the whole site.
[[nodiscard]] bool are_site_routes_due(const Navigation& navigation, std::uint64_t step);

// Updates the cells and the slowness of each group from this water; the fields become due.
void update_site_routes(Navigation& navigation, const Scene& scene, const WaterBins& water, int threads);

// Solves the fields if they are due. They are not needed while all people are indoors. positions: of the people
// outdoors, m.
void solve_due_fields(Navigation& navigation, std::span<const Vector2d> positions, int threads);

// Turns goal_offsets, m, into offsets along the routes of the active agents, and records the waiting agents.
void steer_in_site(Navigation& navigation, const Agents& agents, std::span<const std::uint32_t> active,
                   std::span<const Vector2d> positions, std::span<Vector2d> goal_offsets, std::uint64_t decision,
                   int threads);

// Returns the number of the nearest shelter with free capacity within shelter_reach of p; on high ground the number of
// shelters; else nothing.
[[nodiscard]] std::optional<std::size_t> shelter_at(const Navigation& navigation, const Vector2d& p);

// Counts one more person in a shelter.
void take_in(Navigation& navigation, std::size_t shelter);

// Moves residents at a door without a route to a goal to another door of their house that has one. Those of a house without any stay in it
// for good. Returns a warning that names such houses, or nothing.
[[nodiscard]] std::string choose_doors(const Navigation& navigation, const Scene& scene, Agents& agents);

// Names people without a route to a goal at the start in a sentence, or returns nothing; residents indoors are left out.
[[nodiscard]] std::string people_cut_off(const Navigation& navigation, const Scene& scene, const Agents& agents);

// Returns the fraction of its speed that a person has at p, walking along `way`: by the slope, 0 while it waits; 1
// without a site.
[[nodiscard]] double share_on_ground(const Navigation& navigation, std::uint32_t id, const Vector2d& p,
                                     const Vector2d& way);

// Parts of the functions above, once the grid is laid out: 1 / w by node; the ground of cells without houses; depth and
// speed by cell, and whether there is any water; slowness and shut cells of a group.
void find_dry_slowness(Navigation& navigation);
void find_free_ground(Navigation& navigation);
[[nodiscard]] bool find_water(SiteRoutes& site, const WaterBins& water, double rest_density);
void find_wet_slowness(const Navigation& navigation, GroupRoutes& group, const WaterProperties& water);

// Returns whether an agent waits at the water's edge, or has no route.
[[nodiscard]] inline bool is_waiting(const Navigation& navigation, std::uint32_t id) {
    return navigation.site && navigation.way[id] == Vector2d::Zero();
}

}  // namespace wade::crowd
