#include "crowd_client/hands.hpp"

#include <algorithm>
#include <cmath>

#include "crowd_client/people/push.hpp"

namespace wade::crowd {
namespace {

constexpr std::uint8_t hands_of_one = 2;

Link link_between(const People& people, std::uint32_t a, std::uint32_t b, bool pushes) {
    return {a, b, pushes, std::min(grip_of(people, a), grip_of(people, b))};
}

bool stands(const People& people, std::uint32_t id) {
    return has_ground(people.condition[id].state);
}

// From one person to another, in a periodic world the shorter way.
Vector2d way_between(const CrowdWorld& crowd, std::uint32_t a, std::uint32_t b) {
    Vector2d way = crowd.agents.position[b] - crowd.agents.position[a];
    if (const double period = crowd.scene.world.period(); period > 0) way.x() -= period * std::round(way.x() / period);
    return way;
}

void let_go_of_who_ended(CrowdWorld& crowd) {
    const auto walks = [&](std::uint32_t id) {
        return crowd.agents.outcome[id] == Outcome::active && crowd.agents.people.by_body[id] != 0;
    };
    std::erase_if(crowd.links, [&](const Link& link) { return !walks(link.a) || !walks(link.b); });
}

std::vector<std::uint8_t> hands_in_use(const CrowdWorld& crowd) {
    std::vector<std::uint8_t> used(crowd.agents.size(), 0);
    for (const Link& link : crowd.links) {
        ++used[link.a];
        ++used[link.b];
    }
    return used;
}

// Whoever drifts past is held by the nearest who stands with a hand free, in the order of their ids.
void take_hold(CrowdWorld& crowd) {
    const People& people = crowd.agents.people;
    std::vector<std::uint32_t> drifting;
    for (const std::uint32_t id : crowd.active) {
        if (people.by_body[id] != 0 && people.condition[id].state == PersonState::carried) drifting.push_back(id);
    }
    if (drifting.empty()) return;
    std::vector<std::uint8_t> used = hands_in_use(crowd);
    BodyCells cells;
    sort_people(cells, crowd.scene.world, crowd.positions, link_reach);
    for (const std::uint32_t id : drifting) {
        if (used[id] > 0) continue;
        std::uint32_t helper = id;
        double nearest = link_reach * link_reach;
        cells.visit_near(crowd.agents.position[id], link_reach, [&](std::uint32_t k, double dx, double dz) {
            const std::uint32_t other = crowd.active[k];
            const double square = dx * dx + dz * dz;
            if (square >= nearest || other == id || people.by_body[other] == 0) return;
            if (!stands(people, other) || used[other] >= hands_of_one) return;
            nearest = square;
            helper = other;
        });
        if (helper == id) continue;
        crowd.links.push_back(link_between(people, helper, id, false));
        ++used[id];
        ++used[helper];
    }
}

// The linked people of a step, and which of them each link joins.
struct Linked {
    std::vector<LinkedPerson> people;
    std::vector<std::size_t> place;  // in the list of the active
    std::vector<LinkPlaces> of_link;
};

Linked linked_people(const CrowdWorld& crowd) {
    Linked linked;
    std::vector<std::uint32_t> ids;
    for (const Link& link : crowd.links) {
        ids.push_back(link.a);
        ids.push_back(link.b);
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    const Agents& agents = crowd.agents;
    const WaterProperties water{crowd.scene.fluid.rest_density, crowd.scene.world.gravity};
    for (const std::uint32_t id : ids) {
        const auto k = static_cast<std::size_t>(std::lower_bound(crowd.active.begin(), crowd.active.end(), id) -
                                                crowd.active.begin());
        LinkedPerson one;
        FeltStep felt{crowd.felt[k].depth, crowd.felt[k].velocity, crowd.part_time};
        one.velocity = agents.momentary[id];
        if (crowd.pushing) {
            felt.most_impulse = largest_push({felt.stream - one.velocity, crowd.felt[k].weight, crowd.felt[k].theta});
        }
        one.person = person_in_water(agents.people, id, agents.mass[id], crowd.walking[k], water, felt);
        one.next = crowd.next.at_end[k];
        linked.people.push_back(one);
        linked.place.push_back(k);
    }
    const auto place_of = [&](std::uint32_t id) {
        return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    };
    for (const Link& link : crowd.links) {
        linked.of_link.push_back({place_of(link.a), place_of(link.b), way_between(crowd, link.a, link.b)});
    }
    return linked;
}

// Grips as time has left them.
void weaken(const People& people, std::vector<Link>& links) {
    if (people.wear.empty()) return;
    for (Link& link : links) link.grip = std::min(grip_of(people, link.a), grip_of(people, link.b));
}

// Of two hands the one that holds more counts [A].
void tire_all_hands(CrowdWorld& crowd) {
    People& people = crowd.agents.people;
    if (!people.tires) return;
    std::vector<double> load(people.size(), 0);
    for (const Link& link : crowd.links) {
        for (const std::uint32_t id : {link.a, link.b}) {
            load[id] = std::max(load[id], std::abs(link.pull) / grip_of(people.sex[id]));
        }
    }
    for (const std::uint32_t id : crowd.active) tire_hands(people, id, load[id], crowd.part_time);
}

void note_holds(CrowdWorld& crowd) {
    People& people = crowd.agents.people;
    std::fill(people.hold.begin(), people.hold.end(), 0.0);
    for (const Link& link : crowd.links) {
        if (stands(people, link.b)) people.hold[link.a] += moment_of_hold(people.height[link.a], link.grip);
        if (stands(people, link.a)) people.hold[link.b] += moment_of_hold(people.height[link.b], link.grip);
    }
}

}  // namespace

std::vector<Link> links_of_scene(const Scene& scene, const Agents& agents) {
    std::vector<Link> links;
    std::uint32_t first = 0;
    for (const AgentGroup& group : scene.crowd.groups) {
        const auto count = static_cast<std::uint32_t>(group.count);
        const auto columns = static_cast<std::uint32_t>(group.columns);
        for (std::uint32_t k = 0; k < count && group.hand_in_hand != HandInHand::none; ++k) {
            const bool along_x = group.hand_in_hand == HandInHand::along_x;
            const std::uint32_t next = along_x ? k + 1 : k + columns;
            if (next >= count || (along_x && next % columns == 0)) continue;
            links.push_back(link_between(agents.people, first + k, first + next, group.hold == Hold::arms));
        }
        first += count;
    }
    return links;
}

void hold_hands(CrowdWorld& crowd) {
    if (crowd.links.empty() && !crowd.scene.crowd.helping) return;
    let_go_of_who_ended(crowd);
    if (crowd.scene.crowd.helping) take_hold(crowd);
    if (!crowd.links.empty()) {
        weaken(crowd.agents.people, crowd.links);
        Linked linked = linked_people(crowd);
        pull_links(linked.people, crowd.links, linked.of_link, crowd.part_time);
        for (std::size_t i = 0; i < linked.people.size(); ++i) {
            const LinkedPerson& one = linked.people[i];
            crowd.next.at_end[linked.place[i]] = one.next;
            crowd.next.push[linked.place[i]] = step_in_water(one.person, one.velocity, one.pulls, crowd.part_time).drag;
            crowd.next.mean[linked.place[i]] =
                one.person.has_ground ? one.next : Vector2d(0.5 * (one.velocity + one.next));
        }
        std::erase_if(crowd.links, [&](const Link& link) { return lets_go(link, crowd.part_time); });
    }
    tire_all_hands(crowd);
    note_holds(crowd);
}

}  // namespace wade::crowd
