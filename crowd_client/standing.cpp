#include "crowd_client/standing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/start_warnings.hpp"

namespace wade::crowd {
namespace {

// Returns the position of an agent, with x unwrapped over the periods of a periodic world.
Vector2d place_of(const CrowdWorld& crowd, std::uint32_t id) {
    return crowd.agents.position[id] + Vector2d(crowd.agents.laps[id] * crowd.scene.world->period(), 0);
}

bool stands(CrowdWorld& crowd, std::uint32_t id, std::uint64_t step) {
    Agents& agents = crowd.agents;
    const Vector2d place = place_of(crowd, id);
    const double reach = standing_share * standing_time * agents.desired_speed[id];
    if ((place - agents.stay[id]).squaredNorm() > reach * reach || !(reach > 0)) {
        agents.stay[id] = place;
        agents.stay_step[id] = step;
        agents.stay_wet_steps[id] = agents.wet_steps[id];
    }
    return static_cast<double>(step - agents.stay_step[id]) * crowd.dt >= standing_time - 0.5 * crowd.dt;
}

Vector2d rest_of_way(const CrowdWorld& crowd, std::size_t k) {
    return crowd.agents.goal[crowd.active[k]] - place_of(crowd, crowd.active[k]);
}

// Returns the displacement, m, along the route of a travel-time field, if one leads agent k. It is looked up anew, as
// not each step decides on routes.
std::optional<Vector2d> way_led(const CrowdWorld& crowd, std::size_t k) {
    const Navigation& navigation = crowd.navigation;
    if (!finds_routes(navigation)) return std::nullopt;
    const std::uint32_t id = crowd.active[k];
    const TravelTimeField& field = navigation.fields[navigation.field_of[id]];
    if (!field.is_solved()) return std::nullopt;
    return way_from(navigation, field, crowd.agents.position[id], rest_of_way(crowd, k));
}

// Returns true if a box or house is within half a metre of the agent along `way`.
bool faces_an_obstacle(const CrowdWorld& crowd, std::size_t k, const Vector2d& way) {
    constexpr double look = 0.5;  // m, from the skin
    const Vector2d& p = crowd.agents.position[crowd.active[k]];
    const double length = std::sqrt(way.squaredNorm());
    if (!(length > 0)) return false;
    const double radius = has_bodies(crowd) ? crowd.bodies.radius : 0, reach = look + radius;
    const Vector2d to = p + std::min(1.0, reach / length) * way;
    const Vector2d aside = 0.9 * radius / length * Vector2d(-way.y(), way.x());
    const PlacedHouses& houses = crowd.walls.houses;
    if (meets_a_house(houses, p, to) || meets_a_house(houses, p + aside, to + aside) ||
        meets_a_house(houses, p - aside, to - aside)) {
        return true;
    }
    return any_near(crowd.walls.boxes, {p.x() - 2 * reach, p.x() + 2 * reach}, {p.y() - 2 * reach, p.y() + 2 * reach},
                    [&](const Obstacle& box) {
                        return crosses(box, p, to) || crosses(box, p + aside, to + aside) ||
                               crosses(box, p - aside, to - aside);
                    });
}

bool is_mostly_in_water(const Agents& agents, std::uint32_t id, std::uint64_t steps) {
    return agents.tau[id] > 0 && 2 * (agents.wet_steps[id] - agents.stay_wet_steps[id]) > steps - agents.stay_step[id];
}

bool is_near_others(const CrowdWorld& crowd, std::size_t k) {
    constexpr double near = 1;  // m
    return std::count_if(crowd.positions.begin(), crowd.positions.end(), [&](const Vector2d& other) {
               return (other - crowd.positions[k]).squaredNorm() < near * near;
           }) > 1;
}

StandingReason hold_of(const CrowdWorld& crowd, std::size_t k) {
    if (is_waiting(crowd.navigation, crowd.active[k])) return StandingReason::water;
    if (!is_firm(crowd.agents.people.condition[crowd.active[k]].state)) return StandingReason::footing;
    const bool owns_none = !has_bodies(crowd) && crowd.motion.owned[k] == 0;
    if (owns_none || has_too_few_markers(crowd.scene.crowd)) return StandingReason::markers;
    const std::optional<Vector2d> led = way_led(crowd, k);
    const bool faces = faces_an_obstacle(crowd, k, led.value_or(rest_of_way(crowd, k)));
    // An agent with a route round obstacles, between an obstacle and other agents, waits for the other agents.
    if (faces && !(led && is_near_others(crowd, k))) return StandingReason::obstacle;
    if (is_mostly_in_water(crowd.agents, crowd.active[k], crowd.steps)) return StandingReason::water;
    return is_near_others(crowd, k) ? StandingReason::people : StandingReason::unknown;
}

// Returns the reason in words, and the key that helps.
std::string words_of(StandingReason hold, const Crowd& settings, bool in_site) {
    switch (hold) {
        case StandingReason::footing:
            return "the water keeps them from walking, see their states; look at its depth and speed, and at skill, "
                   "height_m and mass_kg of people";
        case StandingReason::markers:
            return "they own too few markers to walk by; set /crowd/markers_per_cell to " +
                   std::to_string(least_markers_per_cell(settings)) + " or more";
        case StandingReason::obstacle:
            return settings.navigation.rule == NavigationRule::straight
                       ? "an obstacle is before them; with /crowd/navigation/rule \"auto\" they walk round it"
                       : "an obstacle is before them and no way that they fit through leads round it; look at "
                         "/obstacles, the goals and /crowd/body_radius_m";
        case StandingReason::water:
            if (in_site) {
                return "they wait at the edge of water that is too deep or fast for them, or have no way; look at "
                       "/site/shelters and /crowd/navigation/enters_up_to_m";
            }
            return "the water holds them; look at /crowd/tau and the speed of the water";
        case StandingReason::people:
            if (settings.markers == MarkerRule::fixed || settings.bodies == BodyRule::none) {
                return "people are before them; crowds get past one another with /crowd/markers \"redrawn\" and "
                       "/crowd/bodies \"human\"";
            }
            return in_site ? "people are before them"
                           : "people are before them; /crowd/navigation/crowding leads round crowds";
        case StandingReason::unknown:
            break;
    }
    return settings.evasion.rule != EvasionRule::off ? "they keep away from water; look at /crowd/evasion"
                                                     : "nothing is before them; look at their goals";
}

void warn(CrowdWorld& crowd, StandingReason hold, const std::vector<std::uint32_t>& ids, std::uint64_t step) {
    constexpr std::size_t shown = 3;
    std::ostringstream text;
    text << (ids.size() == 1 ? "a person stands" : std::to_string(ids.size()) + " people stand")
         << " since t = " << std::max(0.0, static_cast<double>(step) * crowd.dt - standing_time)
         << " s, a twentieth of the free way or less in " << standing_time << " s: ";
    for (std::size_t i = 0; i < std::min(shown, ids.size()); ++i) {
        const Vector2d& p = crowd.agents.position[ids[i]];
        text << (i > 0 ? ", " : "") << "agent " << ids[i] << " at (" << std::round(10 * p.x()) / 10 << ", "
             << std::round(10 * p.y()) / 10 << ") m";
    }
    if (ids.size() > shown) text << " and others";
    text << "; " << words_of(hold, crowd.scene.crowd, crowd.navigation.site.has_value())
         << " (said once; outcome.json counts the standing)";
    crowd.warnings.push_back(text.str());
}

}  // namespace

void note_standing(CrowdWorld& crowd, std::uint64_t step) {
    constexpr double time_between_looks = 1;  // s
    const auto every = static_cast<std::uint64_t>(std::max(1.0, std::round(time_between_looks / crowd.dt)));
    if (step % every != 0) return;
    constexpr std::size_t most_looked_at = 100;  // number of agents checked for their reason in one call
    std::array<std::vector<std::uint32_t>, holds> found;
    std::size_t looked_at = 0;
    for (std::size_t k = 0; k < crowd.active.size(); ++k) {
        const std::uint32_t id = crowd.active[k];
        const bool did = crowd.agents.standing[id];
        crowd.agents.standing[id] = stands(crowd, id, step);
        if (did || !crowd.agents.standing[id] || ++looked_at > most_looked_at) continue;
        found[static_cast<std::size_t>(hold_of(crowd, k))].push_back(id);
    }
    for (std::size_t h = 0; h < holds; ++h) {
        const auto bit = static_cast<std::uint8_t>(1U << h);
        if (found[h].empty() || (crowd.holds_told & bit) != 0) continue;
        crowd.holds_told |= bit;
        warn(crowd, static_cast<StandingReason>(h), found[h], step);
    }
}

std::size_t count_standing(const CrowdWorld& crowd) {
    const auto is_standing = [&](std::uint32_t id) { return crowd.agents.standing[id]; };
    return static_cast<std::size_t>(std::count_if(crowd.active.begin(), crowd.active.end(), is_standing));
}

std::vector<std::string_view> state_names(const Scene& scene) {
    std::vector<std::string_view> names{"walking", "standing", "arrived", "dead"};
    if (scene.crowd->response == ResponseKind::measured) {
        names.insert(names.end(), person_states.begin() + 1, person_states.end());
    }
    if (scene.site) {
        for (const Outcome outcome : {Outcome::sheltered, Outcome::indoors, Outcome::upper_floor}) {
            names.push_back(outcome_name(outcome));
        }
    }
    return names;
}

std::string_view state_name(const CrowdWorld& crowd, std::size_t id) {
    const PersonState state = crowd.agents.people.condition[id].state;
    const std::string_view in_water = person_states[static_cast<std::size_t>(state)];
    if (crowd.agents.outcome[id] != Outcome::active) {
        return state == PersonState::drowned ? in_water : outcome_name(crowd.agents.outcome[id]);
    }
    return is_firm(state) && crowd.agents.standing[id] ? "standing" : in_water;
}

}  // namespace wade::crowd
