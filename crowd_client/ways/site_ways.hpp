#pragma once
// Ways in a site: round houses, over slopes, to shelters, high ground or a goal, as the water rises.
//
// Fields of the travel time (travel_time.hpp) from all nodes of the goals at once: of shelters that have room those within reach of
// their polygons, and ground above /crowd/navigation/safe_above_m; or the disc round a group's own goal. Solved at the start and
// again every /crowd/navigation/every_s, and when a shelter is full, for each group with
//
//   s = 1 / (r w)            of ground that it may enter, 1000 times as much elsewhere
//   r                        walking_speed_ratio() of the group in the water there, by its share of men (people/person.hpp)
//   w                        of a slope of steepness S, with and against it alike: (t(S) + t(-S)) / 2
//   t(S) = exp(-3.5 |S + 0.05|) / exp(-0.175)    Tobler, Three presentations on geographical analysis and modeling, NCGIA report
//                            93-1 (1993): speed over that on level ground, S the rise along the way
//   may enter                D < 0.8 of the group's mean person who stands there, and no more than enters_up_to_m of water
//
// Water is that of cells of 2 m, whatever the cells of the fluid: depth = mass / (rho, ground without houses), velocity =
// momentum / mass.
//
// Who is not warned takes a field without water until water that it may not enter is in sight before it, sight_m ahead on its way
// with no house between; from then on it knows as much as the warned [A].
// Who is outside of water that it may not enter, and would be in it a metre on, waits at its edge [A]; who is caught in it, or afloat, takes the
// way out that the field has. Who sees no way at all stays.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/water/water_bins.hpp"
#include "crowd_client/ways/way_fields.hpp"

namespace wade::crowd {

inline constexpr double shelter_reach = 1;  // within which one is at a shelter, m [A]

// Speed on a slope over that on level ground; rise: metres a metre along the way.
[[nodiscard]] double tobler(double rise);

// Fields for the groups of the scene's people, without water. Throws ConfigurationError for shelters that nobody has, for the rule
// `straight` with people who go to shelters, for more cells than memory should hold, and, with the rule `travel_time`, for people
// without a way.
[[nodiscard]] Navigation make_site_ways(const Scene& scene, const Agents& agents);

// Whether the ways take in the water of this step, that of all the site.
[[nodiscard]] bool are_site_ways_due(const Navigation& navigation, std::uint64_t step);

// Takes in this water, for which the fields become due.
void update_site_ways(Navigation& navigation, const Scene& scene, const WaterBins& water, int threads);

// Solves the fields if they are due. While all people are indoors none is needed. positions: of the people outdoors, m.
void solve_due_ways(Navigation& navigation, std::span<const Vector2d> positions, int threads);

// Turns goal_offsets, m, into the ways that the active agents take, and notes who waits.
void steer_in_site(Navigation& navigation, const Agents& agents, std::span<const std::uint32_t> active,
                   std::span<const Vector2d> positions, std::span<Vector2d> goal_offsets, std::uint64_t decision,
                   int threads);

// The shelter that holds a place of somebody, by number; of high ground their number; nothing elsewhere, and where there is no room.
[[nodiscard]] std::optional<std::size_t> shelter_at(const Navigation& navigation, const Vector2d& p);

// Takes somebody in.
void take_in(Navigation& navigation, std::size_t shelter);

// Moves residents at a door without a route to a goal to another door of their house that has one. Those of a house without any stay in it
// for good. Returns a warning that names such houses, or nothing.
[[nodiscard]] std::string choose_doors(const Navigation& navigation, const Scene& scene, Agents& agents);

// Names people without a route to a goal at the start in a sentence, or returns nothing; residents indoors are left out.
[[nodiscard]] std::string people_cut_off(const Navigation& navigation, const Scene& scene, const Agents& agents);

// Returns the share of its speed that a person has at p, walking along `way`: by the slope, 0 while it waits; 1 without a site.
[[nodiscard]] double share_on_ground(const Navigation& navigation, std::uint32_t id, const Vector2d& p,
                                     const Vector2d& way);

// Parts of this, once the grid is laid out: 1 / w by node; the ground of cells without houses; depth and speed by cell, and whether
// there is any water; slowness and shut cells of a group.
void find_dry_slowness(Navigation& navigation);
void find_free_ground(Navigation& navigation);
[[nodiscard]] bool find_water(SiteWays& site, const WaterBins& water, double rest_density);
void find_wet_slowness(const Navigation& navigation, GroupWays& group, const WaterProperties& water);

// Whether an agent waits at the water's edge, or has no way.
[[nodiscard]] inline bool is_waiting(const Navigation& navigation, std::uint32_t id) {
    return navigation.site && navigation.way[id] == Vector2d::Zero();
}

}  // namespace wade::crowd
