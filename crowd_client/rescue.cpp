#include "crowd_client/rescue.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/hands.hpp"
#include "crowd_client/navigation/sight.hpp"

namespace wade::crowd {
namespace {

constexpr double sight = 20, line_length = 15;  // m; the line [A]
constexpr double safe = 0.8;                    // limit of D on a path
constexpr double shallow = 0.3;                 // m
constexpr double at_place = 0.5, beside = 1;    // m
constexpr double hauls = 0.5;                   // m/s [A]
constexpr double in_tow = 2;                    // m [A]
constexpr double time_between_throws = 20;      // s [A]
constexpr double detour = 30;                   // how far it may lead away from the rescuer along each axis, m [A]
constexpr double pace = 0.25;                   // between points of a detour, m
constexpr double time_between_looks = 1;        // for detours, s

bool sees(const CrowdWorld& crowd, const Vector2d& from, const Vector2d& to) {
    if (meets_a_house(crowd.walls.houses, from, to)) return false;
    const Vector2d lo = from.cwiseMin(to), hi = from.cwiseMax(to);
    return !any_near(crowd.walls.boxes, {lo.x(), hi.x()}, {lo.y(), hi.y()},
                     [&](const Obstacle& box) { return crosses(box, from, to); });
}

FeltStep water_at(const CrowdWorld& crowd, const WaterBins& water, Vector2d place) {
    if (const double period = crowd.scene.world->period(); period > 0) {
        place.x() -= period * std::floor(place.x() / period);
    }
    const FeltWater felt = feel_water(*crowd.feeling, water, place);
    return {felt.depth, felt.velocity};
}

// Returns true if the agent would stand with D < 0.8 on each metre of a path of `length`, m, along a unit vector.
bool is_safe(const CrowdWorld& crowd, const WaterBins& water, std::uint32_t id, const Vector2d& along, double length) {
    const WaterProperties properties{crowd.scene.fluid->rest_density, crowd.scene.world->gravity};
    for (int metre = 0; metre < length + 1; ++metre) {
        const Vector2d place = crowd.agents.position[id] + std::min<double>(metre, length) * along;
        const double demand =
            demand_at(crowd.agents.people, id, crowd.agents.mass[id], along, properties, water_at(crowd, water, place));
        if (!(demand < safe)) return false;
    }
    return true;
}

// Returns the same for a detour of points a `pace` apart, listed from the casualty back to the rescuer. The check ends
// where the line reaches the casualty and no obstacle is between them.
bool is_safe_round(const CrowdWorld& crowd, const WaterBins& water, std::uint32_t id,
                   const std::vector<Vector2d>& places) {
    const WaterProperties properties{crowd.scene.fluid->rest_density, crowd.scene.world->gravity};
    constexpr auto metre = static_cast<std::size_t>(1 / pace);
    const Vector2d& whom = places.front();
    for (std::size_t left = places.size(); left > 1; left -= std::min(metre, left)) {
        const Vector2d& place = places[left - 1];
        const double demand =
            demand_at(crowd.agents.people, id, crowd.agents.mass[id],
                      unit_or(places[left - 2] - place, Vector2d::Zero()), properties, water_at(crowd, water, place));
        if (!(demand < safe)) return false;
        if ((whom - place).squaredNorm() <= line_length * line_length && sees(crowd, place, whom)) break;
    }
    return true;
}

// Returns the nearest visible position with less than 0.3 m of water, in 16 directions and every metre up to 20 m.
// Positions also visible from the casualty come first, as no corner cuts off the line. Without any, returns the
// rescuer's goal.
Vector2d nearest_shallow(const CrowdWorld& crowd, const WaterBins& water, std::uint32_t id, const Vector2d& whom) {
    const World& world = crowd.scene.world;
    const Vector2d& here = crowd.agents.position[id];
    constexpr int directions = 16;
    std::optional<Vector2d> cut_off;
    for (int metre = 0; metre <= static_cast<int>(sight); ++metre) {
        for (int i = 0; i < (metre > 0 ? directions : 1); ++i) {
            const double angle = 2 * std::numbers::pi * i / directions;
            const Vector2d place = here + metre * Vector2d(std::cos(angle), std::sin(angle));
            const bool is_in_x = world.period() > 0 || (place.x() >= 0 && place.x() <= world.length);
            if (!is_in_x || place.y() < 0 || place.y() > world.width || !sees(crowd, here, place)) continue;
            if (water_at(crowd, water, place).depth >= shallow) continue;
            if (sees(crowd, whom, place)) return place;
            if (!cut_off) cut_off = place;
        }
    }
    return cut_off ? *cut_off : Vector2d(here + goal_offset(crowd.agents, id, world.period()));
}

Link* line_of(CrowdWorld& crowd, std::uint32_t id) {
    const auto line = std::find_if(crowd.links.begin(), crowd.links.end(),
                                   [&](const Link& link) { return link.kind == LinkKind::line && link.a == id; });
    return line == crowd.links.end() ? nullptr : &*line;
}

bool is_on_line(const CrowdWorld& crowd, std::uint32_t id) {
    return std::any_of(crowd.links.begin(), crowd.links.end(),
                       [&](const Link& link) { return link.kind == LinkKind::line && link.b == id; });
}

// Returns the ids of the casualties.
std::vector<std::uint32_t> people_to_rescue(const CrowdWorld& crowd) {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t id : crowd.active) {
        const PersonState state = crowd.agents.people.condition[id].state;
        if (crowd.agents.people.by_body[id] == 0) continue;
        const bool is_lost =
            state == PersonState::carried || state == PersonState::holding || state == PersonState::pinned;
        if (is_lost) found.push_back(id);
    }
    return found;
}

void throw_line(CrowdWorld& crowd, const WaterBins& water, Rescuer& rescuer, std::uint32_t whom) {
    std::erase_if(crowd.links, [&](const Link& link) {
        return link.a == whom || link.b == whom || link.a == rescuer.id || link.b == rescuer.id;
    });
    Link line = link_between(crowd.agents.people, rescuer.id, whom, false);
    line.kind = LinkKind::line;
    line.grip *= 2;
    const Vector2d way = way_to(crowd, rescuer.id, crowd.agents.position[whom]);
    line.rest = std::max(link_length, std::sqrt(way.squaredNorm()));
    crowd.links.push_back(line);
    rescuer.has_line = true;
    rescuer.retreat = nearest_shallow(crowd, water, rescuer.id, crowd.agents.position[rescuer.id] + way);
}

// Finds the shortest route round obstacles to a hidden casualty that the rescuer can walk.
void look_for_detour(const CrowdWorld& crowd, const WaterBins& water, Rescuer& rescuer,
                     const std::vector<std::uint32_t>& hidden) {
    const World& world = crowd.scene.world;
    const Vector2d& here = crowd.agents.position[rescuer.id];
    const bool goes_round = world.period() > 0;
    const Interval x{goes_round ? here.x() - detour : std::max(0.0, here.x() - detour),
                     goes_round ? here.x() + detour : std::min(world.length, here.x() + detour)};
    const Interval z{std::max(0.0, here.y() - detour), std::min(world.width, here.y() + detour)};
    const Navigation ways = ways_within(crowd.scene, crowd.walls, x, z, here);
    rescuer.round.clear();
    for (const std::uint32_t id : hidden) {
        const Vector2d whom = here + way_to(crowd, rescuer.id, crowd.agents.position[id]);
        std::vector<Vector2d> places = places_on_way(ways, ways.fields.at(0), whom, pace);
        if (places.empty() || (!rescuer.round.empty() && places.size() >= rescuer.round.size())) continue;
        if (is_safe_round(crowd, water, rescuer.id, places)) rescuer.round = std::move(places);
    }
}

// Sends the rescuer round obstacles if it can reach no casualty in sight, and the scene lets agents go round.
void go_round(CrowdWorld& crowd, const WaterBins& water, Rescuer& rescuer, const std::vector<std::uint32_t>& hidden) {
    if (hidden.empty() || crowd.scene.crowd->navigation.rule == NavigationRule::straight) return rescuer.round.clear();
    if (time_of(crowd) >= rescuer.next_look) {
        look_for_detour(crowd, water, rescuer, hidden);
        rescuer.next_look = time_of(crowd) + time_between_looks;
    }
    const auto next = [&] { return way_to(crowd, rescuer.id, rescuer.round.back()); };
    while (!rescuer.round.empty() && next().squaredNorm() <= at_place * at_place) rescuer.round.pop_back();
    if (!rescuer.round.empty()) rescuer.way = next();
}

// Sends the rescuer to the nearest casualty that it can reach; throws the line once it is long enough.
void look_for_somebody(CrowdWorld& crowd, const WaterBins& water, Rescuer& rescuer,
                       const std::vector<std::uint32_t>& candidates) {
    const Vector2d& here = crowd.agents.position[rescuer.id];
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const std::uint32_t id : candidates) {
        const Vector2d way = way_to(crowd, rescuer.id, crowd.agents.position[id]);
        const double distance = std::sqrt(way.squaredNorm());
        if (id != rescuer.id && distance <= sight && !is_on_line(crowd, id)) near.emplace_back(distance, id);
    }
    std::sort(near.begin(), near.end());
    std::vector<std::uint32_t> hidden;
    for (const auto& [distance, id] : near) {
        const Vector2d way = way_to(crowd, rescuer.id, crowd.agents.position[id]);
        const double on_foot = std::max(0.0, distance - line_length);
        if (!sees(crowd, here, here + way)) {
            hidden.push_back(id);
            continue;
        }
        if (!is_safe(crowd, water, rescuer.id, unit_or(way, Vector2d::Zero()), on_foot)) continue;
        rescuer.round.clear();
        rescuer.way = way;
        rescuer.stands = !(on_foot > 0);
        if (rescuer.stands && time_of(crowd) >= rescuer.next_throw) throw_line(crowd, water, rescuer, id);
        return;
    }
    go_round(crowd, water, rescuer, hidden);
}

bool is_safe_now(const People& people, std::uint32_t id) {
    return is_firm(people.condition[id].state) && std::max(people.slip[id], people.topple[id]) < safe;
}

// Moves the rescuer or hauls the line. Returns true if the line can be let go.
bool bring_in(CrowdWorld& crowd, Rescuer& rescuer, Link& line) {
    const People& people = crowd.agents.people;
    const Vector2d& here = crowd.agents.position[rescuer.id];
    const Vector2d to_whom = way_to(crowd, line.a, crowd.agents.position[line.b]);
    const double distance = std::sqrt(to_whom.squaredNorm());
    if (is_safe_now(people, line.b) && (people.depth[line.b] < shallow || distance <= beside)) return true;
    const Vector2d back = way_to(crowd, rescuer.id, rescuer.retreat);
    const bool is_back = people.depth[rescuer.id] < shallow || back.squaredNorm() <= at_place * at_place;
    // A line cannot pass a corner, so that it is hauled in first.
    const bool is_cut_off = distance > in_tow && !sees(crowd, here + to_whom, here + back);
    rescuer.stands = is_back || is_cut_off;
    if (!rescuer.stands) {
        if (sees(crowd, here, here + back)) rescuer.way = back;  // else to its goal, on the usual route
    } else if (line.pull < 0.5 * line.grip) {
        line.rest = std::max(link_length, std::min(line.rest, distance) - hauls * crowd.dt);
    }
    return false;
}

// Returns true if the rescuer can act: active, on its feet, not getting up, and responding by body. Else drops its
// line.
bool acts(CrowdWorld& crowd, Rescuer& rescuer) {
    const std::uint32_t id = rescuer.id;
    const bool is_there = crowd.agents.outcome[id] == Outcome::active && crowd.agents.people.by_body[id] != 0;
    const PersonState state = crowd.agents.people.condition[id].state;
    const bool has_feet = is_on_feet(state);
    if (is_there && has_feet) return true;
    rescuer.lost_feet = rescuer.lost_feet || !has_feet;
    std::erase_if(crowd.links, [&](const Link& link) { return link.kind == LinkKind::line && link.a == id; });
    rescuer.has_line = false;
    return false;
}

const Rescuer* rescuer_of(const CrowdWorld& crowd, std::uint32_t id) {
    const std::vector<Rescuer>& all = crowd.rescues.rescuers;
    const auto found =
        std::lower_bound(all.begin(), all.end(), id, [](const Rescuer& one, std::uint32_t it) { return one.id < it; });
    return found != all.end() && found->id == id ? &*found : nullptr;
}

void decide(CrowdWorld& crowd, const WaterBins& water, Rescuer& rescuer, const std::vector<std::uint32_t>& candidates) {
    rescuer.way.reset();
    rescuer.stands = false;
    if (!acts(crowd, rescuer)) return;
    Link* line = line_of(crowd, rescuer.id);
    if (rescuer.has_line && line == nullptr) rescuer.next_throw = time_of(crowd) + time_between_throws;
    rescuer.has_line = line != nullptr;
    if (line != nullptr) {
        if (!bring_in(crowd, rescuer, *line)) return;
        crowd.rescues.brought_in[line->b] = 1;
        crowd.links.erase(crowd.links.begin() + (line - crowd.links.data()));
        rescuer.has_line = false;
    }
    look_for_somebody(crowd, water, rescuer, candidates);
    if (rescuer.way) return;
    const Vector2d rest = goal_offset(crowd.agents, rescuer.id, crowd.scene.world->period());
    rescuer.stands = rest.squaredNorm() <= at_place * at_place;
}

}  // namespace

Rescues rescues_of_scene(const Scene& scene, const Agents& agents) {
    Rescues rescues;
    for (std::uint32_t id = 0; id < agents.size(); ++id) {
        if (scene.crowd->groups[agents.group[id]].rescuer) rescues.rescuers.emplace_back().id = id;
    }
    if (!rescues.rescuers.empty()) rescues.brought_in.assign(agents.size(), 0);
    return rescues;
}

void send_rescuers(CrowdWorld& crowd, const WaterBins& water) {
    if (crowd.rescues.rescuers.empty()) return;
    const std::vector<std::uint32_t> candidates = people_to_rescue(crowd);
    for (Rescuer& rescuer : crowd.rescues.rescuers) decide(crowd, water, rescuer, candidates);
}

void lead_rescued(CrowdWorld& crowd) {
    if (crowd.rescues.rescuers.empty()) return;
    const auto place_of = [&](std::uint32_t id) {
        return static_cast<std::size_t>(std::lower_bound(crowd.active.begin(), crowd.active.end(), id) -
                                        crowd.active.begin());
    };
    const auto walks = [&](std::uint32_t id) { return crowd.agents.outcome[id] == Outcome::active; };
    for (const Rescuer& rescuer : crowd.rescues.rescuers) {
        if (rescuer.way && walks(rescuer.id)) crowd.goal_offsets[place_of(rescuer.id)] = *rescuer.way;
    }
    for (const Link& link : crowd.links) {
        if (link.kind != LinkKind::line || !walks(link.b)) continue;
        crowd.goal_offsets[place_of(link.b)] = way_to(crowd, link.b, crowd.agents.position[link.a]);
    }
}

bool waits(const CrowdWorld& crowd, std::uint32_t id) {
    const Rescuer* rescuer = rescuer_of(crowd, id);
    return rescuer != nullptr && rescuer->stands;
}

bool is_on_duty(const CrowdWorld& crowd, std::uint32_t id) {
    if (rescuer_of(crowd, id) == nullptr) return false;
    return std::any_of(crowd.active.begin(), crowd.active.end(),
                       [&](std::uint32_t other) { return rescuer_of(crowd, other) == nullptr; });
}

RescueCount count_rescues(const CrowdWorld& crowd) {
    const Rescues& rescues = crowd.rescues;
    RescueCount count;
    count.rescuers = rescues.rescuers.size();
    for (std::size_t id = 0; id < rescues.brought_in.size(); ++id) {
        if (rescues.brought_in[id] != 0 && crowd.agents.outcome[id] != Outcome::dead) ++count.saved;
    }
    for (const Rescuer& one : rescues.rescuers) count.lost_feet += one.lost_feet ? 1 : 0;
    return count;
}

}  // namespace wade::crowd
