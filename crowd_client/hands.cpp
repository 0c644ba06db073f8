#include "crowd_client/hands.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/people/push.hpp"

namespace wade::crowd {
namespace {

constexpr std::uint8_t hands_of_one = 2;
constexpr double rest_of_hands = 5;  // after a rope is let go, s [A]
constexpr double closing_time =
    1.6;  // of gaps in a file, s: four times that of legs, so that no follower runs into its leader

double hands_on(const Link& link) {
    return link.kind == LinkKind::hands ? 1 : hands_of_one;
}

bool stands(const People& people, std::uint32_t id) {
    return has_ground(people.condition[id].state);
}

bool drifts(const People& people, std::uint32_t id) {
    const PersonState state = people.condition[id].state;
    return state == PersonState::carried || state == PersonState::pinned;
}

// Returns true for an agent firm on its feet, which holds on by choice.
bool is_firm(const People& people, std::uint32_t id) {
    return is_firm(people.condition[id].state);
}

// Removes links of agents that have arrived or died, or no longer respond by body.
void let_go_of_who_ended(CrowdWorld& crowd) {
    const auto walks = [&](std::uint32_t id) {
        return crowd.agents.outcome[id] == Outcome::active && crowd.agents.people.by_body[id] != 0;
    };
    std::erase_if(crowd.links, [&](const Link& link) { return !walks(link.a) || !walks(link.b); });
}

// Links drifting and pinned people to the nearest standing person with a free hand, in the order of ids.
void take_hold(CrowdWorld& crowd) {
    const People& people = crowd.agents.people;
    std::vector<std::uint32_t> drifting;
    for (const std::uint32_t id : crowd.active) {
        if (people.by_body[id] != 0 && drifts(people, id)) drifting.push_back(id);
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
            if (!is_on_feet(people.condition[other].state) || used[other] >= hands_of_one) return;
            nearest = square;
            helper = other;
        });
        if (helper == id) continue;
        crowd.links.push_back(link_between(people, helper, id, false));
        ++used[id];
        ++used[helper];
    }
}

// A rope relative to an agent: the vector from its fixed end to its other end, which lies downstream if it is free.
struct RopeNear {
    Vector2d from = Vector2d::Zero(), along = Vector2d::Zero();  // m, the person at 0
    double free_length = -1;                                     // m; below 0: both ends are fixed

    // Returns the displacement to the nearest point of the rope, m.
    [[nodiscard]] Vector2d nearest() const {
        const double square = along.squaredNorm();
        const double share = square > 0 ? std::clamp(-from.dot(along) / square, 0.0, 1.0) : 0;
        return from + share * along;
    }
};

RopeNear rope_near(const CrowdWorld& crowd, std::uint32_t id, std::size_t i) {
    const Rope& rope = crowd.scene.crowd->ropes[i];
    const Vector2d from(rope.from_x, rope.from_z);
    RopeNear near{way_to(crowd, id, from)};
    if (rope.to_x && rope.to_z) {
        near.along = Vector2d(*rope.to_x, *rope.to_z) - from;
        return near;
    }
    near.free_length = rope.free_length.value_or(0);
    near.along = near.free_length * unit_or(mean_stream(crowd.agents.people, id), Vector2d::Zero());
    return near;
}

// Returns true if a firm agent is farther than `length` from the point that it holds, and wants to go farther.
bool wants_away(const People& people, std::uint32_t id, const Vector2d& to_hold, double length) {
    if (!is_firm(people, id) || !(to_hold.squaredNorm() > length * length)) return false;
    const Vector2d& wanted = people.wanted[id];
    return -wanted.dot(to_hold) > 0.5 * std::sqrt(wanted.squaredNorm() * to_hold.squaredNorm());
}

// Moves the hands of an agent with ground along the rope as far as it wants to go; without ground they clasp the rope.
void follow_rope(const CrowdWorld& crowd, Link& link, const RopeNear& rope) {
    const People& people = crowd.agents.people;
    if (!stands(people, link.a)) return;
    const Vector2d& place = crowd.agents.position[link.a];
    const Vector2d& wanted = people.wanted[link.a];
    if (rope.free_length < 0) {
        const Vector2d nearest = place + rope.nearest();
        if ((nearest - link.tie).dot(wanted) > 0) link.tie = nearest;
        return;
    }
    const double distance = std::sqrt(rope.from.squaredNorm()), outwards = -wanted.dot(rope.from);
    if (outwards < 0) link.rest = std::min(link.rest, std::max(link_length, distance));
    if (outwards > 0) link.rest = std::max(link.rest, std::min(rope.free_length + link_length, distance));
}

// Moves the hands of agents on ropes, and removes links of firm agents to ropes that they leave.
void follow_ropes(CrowdWorld& crowd) {
    const People& people = crowd.agents.people;
    for (Link& link : crowd.links) {
        if (link.kind == LinkKind::rope) follow_rope(crowd, link, rope_near(crowd, link.a, link.rope));
    }
    std::erase_if(crowd.links, [&](const Link& link) {
        if (link.kind != LinkKind::rope || !is_firm(people, link.a)) return false;
        const Vector2d nearest = rope_near(crowd, link.a, link.rope).nearest();
        return nearest.squaredNorm() > link_reach * link_reach || people.depth[link.a] == 0 ||
               wants_away(people, link.a, way_to(crowd, link.a, link.tie), link.rest);
    });
}

Link hold_of_rope(const CrowdWorld& crowd, std::uint32_t id, std::size_t i, const RopeNear& rope) {
    Link link = link_between(crowd.agents.people, id, id, false);
    link.kind = LinkKind::rope;
    link.grip *= hands_of_one;
    link.rope = i;
    const bool is_free = rope.free_length >= 0;
    link.tie = crowd.agents.position[id] + (is_free ? rope.from : rope.nearest());
    if (is_free) link.rest = std::max(link_length, std::sqrt(rope.from.squaredNorm()));
    return link;
}

// Links each agent in water with both hands free to the nearest rope within reach.
void take_ropes(CrowdWorld& crowd) {
    const People& people = crowd.agents.people;
    const std::vector<std::uint8_t> used = hands_in_use(crowd);
    for (const std::uint32_t id : crowd.active) {
        if (people.by_body[id] == 0 || used[id] > 0 || !(people.depth[id] > 0)) continue;
        if (time_of(crowd) < crowd.hands_spent[id]) continue;
        const bool is_rescuer = crowd.scene.crowd->groups[crowd.agents.group[id]].rescuer;
        if (is_rescuer && stands(people, id)) continue;  // its hands are kept for the line
        std::optional<Link> hold;
        double nearest = link_reach * link_reach;
        for (std::size_t i = 0; i < crowd.scene.crowd->ropes.size(); ++i) {
            const RopeNear rope = rope_near(crowd, id, i);
            const double square = rope.nearest().squaredNorm();
            if (square > nearest || wants_away(people, id, rope.nearest(), link_length)) continue;
            nearest = square;
            hold = hold_of_rope(crowd, id, i, rope);
        }
        if (hold) crowd.links.push_back(*hold);
    }
}

// The linked agents of a step, then the points that ropes are tied to; `of_link` has the two indices that each link
// joins.
struct Linked {
    std::vector<LinkedPerson> people;
    std::vector<std::size_t> place;  // index of each agent in crowd.active
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
    const WaterProperties water{crowd.scene.fluid->rest_density, crowd.scene.world->gravity};
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
        if (link.kind != LinkKind::rope) {
            const Vector2d way = way_to(crowd, link.a, agents.position[link.b]);
            linked.of_link.push_back({place_of(link.a), place_of(link.b), way});
            continue;
        }
        linked.of_link.push_back({place_of(link.a), linked.people.size(), way_to(crowd, link.a, link.tie)});
        linked.people.emplace_back().is_fixed = true;
    }
    return linked;
}

// Updates the grips for fatigue and cold of the hands.
void weaken(const People& people, std::vector<Link>& links) {
    if (people.wear.empty()) return;
    for (Link& link : links) {
        link.grip = hands_on(link) * std::min(grip_of(people, link.a), grip_of(people, link.b));
    }
}

// Tires both hands of an agent by the load of the hand that holds more [A].
void tire_all_hands(CrowdWorld& crowd) {
    People& people = crowd.agents.people;
    if (!people.tires) return;
    std::vector<double> load(people.size(), 0);
    for (const Link& link : crowd.links) {
        for (const std::uint32_t id : {link.a, link.b}) {
            load[id] = std::max(load[id], std::abs(link.pull) / (hands_on(link) * grip_of(people.sex[id])));
        }
    }
    for (const std::uint32_t id : crowd.active) tire_hands(people, id, load[id], crowd.part_time);
}

void note_holds(CrowdWorld& crowd) {
    People& people = crowd.agents.people;
    std::fill(people.hold.begin(), people.hold.end(), 0.0);
    const auto steady = [&](std::uint32_t id, double grip) {
        people.hold[id] += moment_of_hold(people.height[id], grip);
    };
    for (const Link& link : crowd.links) {
        const bool is_rope = link.kind == LinkKind::rope;
        if (is_rope || (link.kind == LinkKind::hands && stands(people, link.b))) steady(link.a, link.grip);
        if (!is_rope && stands(people, link.a)) steady(link.b, link.grip);
    }
    // Along a chain of agents without ground each passes the hold on to the next.
    for (bool is_passed_on = true; is_passed_on;) {
        is_passed_on = false;
        for (const Link& link : crowd.links) {
            const bool a = people.hold[link.a] > 0, b = people.hold[link.b] > 0;
            if (a == b || stands(people, link.a) || stands(people, link.b)) continue;
            steady(a ? link.b : link.a, link.grip);
            is_passed_on = true;
        }
    }
}

// Returns true if one of the two agents walks behind the other.
bool is_in_file(const CrowdWorld& crowd, const Link& link) {
    const auto walks = [&](std::uint32_t id) {
        return crowd.agents.outcome[id] == Outcome::active && crowd.agents.people.by_body[id] != 0 &&
               is_firm(crowd.agents.people, id);
    };
    return link.leads != Lead::nobody && walks(link.a) && walks(link.b);
}

void follow(CrowdWorld& crowd, std::uint32_t id, std::uint32_t leader) {
    const double most = crowd.agents.desired_speed[id];
    const Vector2d way = way_to(crowd, id, crowd.agents.position[leader]);
    const double distance = std::sqrt(way.squaredNorm());
    if (!(most > 0) || !(distance > 0)) return;
    const auto place_of = [&](std::uint32_t one) {
        return static_cast<std::size_t>(std::lower_bound(crowd.active.begin(), crowd.active.end(), one) -
                                        crowd.active.begin());
    };
    const Vector2d along = way / distance;
    const double wanted = crowd.walking[place_of(leader)].dot(along) + (distance - link_length) / closing_time;
    const std::size_t k = place_of(id);
    crowd.walking[k] =
        keep_in_world(crowd.scene.world, crowd.positions[k], std::clamp(wanted, 0.0, most) * along, crowd.part_time);
}

// Returns the leader of two agents at their starts: nearer to its goal by half a link or more, if any.
Lead lead_of(const Agents& agents, double period, std::uint32_t a, std::uint32_t b) {
    const auto way_left = [&](std::uint32_t id) { return std::sqrt(goal_offset(agents, id, period).squaredNorm()); };
    const double ahead = way_left(a) - way_left(b);
    if (std::abs(ahead) < 0.5 * link_length) return Lead::nobody;
    return ahead > 0 ? Lead::b : Lead::a;
}

}  // namespace

void share_speeds_of_files(CrowdWorld& crowd) {
    std::vector<double>& speed = crowd.agents.desired_speed;
    std::vector<std::uint32_t> file(speed.size());
    std::iota(file.begin(), file.end(), 0U);
    const auto file_of = [&](std::uint32_t id) {
        while (file[id] != id) id = file[id];
        return id;
    };
    for (const Link& link : crowd.links) {
        if (is_in_file(crowd, link)) file[file_of(link.b)] = file_of(link.a);
    }
    std::vector<double> sum(speed.size(), 0), count(speed.size(), 0);
    for (const std::uint32_t id : crowd.active) {
        sum[file_of(id)] += speed[id];
        count[file_of(id)] += 1;
    }
    for (const std::uint32_t id : crowd.active) {
        const std::uint32_t of = file_of(id);
        if (count[of] > 1) speed[id] = sum[of] / count[of];
    }
}

// Each leader is updated before its follower, as links of a chain are in the order of ids.
void walk_in_files(CrowdWorld& crowd) {
    for (const Link& link : crowd.links) {
        if (link.leads == Lead::a && is_in_file(crowd, link)) follow(crowd, link.b, link.a);
    }
    for (auto link = crowd.links.rbegin(); link != crowd.links.rend(); ++link) {
        if (link->leads == Lead::b && is_in_file(crowd, *link)) follow(crowd, link->a, link->b);
    }
}

Link link_between(const People& people, std::uint32_t a, std::uint32_t b, bool pushes) {
    return {a, b, pushes, std::min(grip_of(people, a), grip_of(people, b))};
}

Vector2d way_to(const CrowdWorld& crowd, std::uint32_t id, const Vector2d& place) {
    Vector2d way = place - crowd.agents.position[id];
    if (const double period = crowd.scene.world->period(); period > 0) way.x() -= period * std::round(way.x() / period);
    return way;
}

std::vector<std::uint8_t> hands_in_use(const CrowdWorld& crowd) {
    std::vector<std::uint8_t> used(crowd.agents.size(), 0);
    for (const Link& link : crowd.links) {
        for (const std::uint32_t id : {link.a, link.b}) {  // the same id for a rope
            ++used[id];
            if (link.kind == LinkKind::line) ++used[id];
        }
    }
    return used;
}

std::vector<Link> links_of_scene(const Scene& scene, const Agents& agents) {
    std::vector<Link> links;
    std::uint32_t first = 0;
    for (const AgentGroup& group : scene.crowd->groups) {
        const auto count = static_cast<std::uint32_t>(group.count);
        const auto columns = static_cast<std::uint32_t>(group.columns);
        for (std::uint32_t k = 0; k < count && group.hand_in_hand != HandInHand::none; ++k) {
            const bool along_x = group.hand_in_hand == HandInHand::along_x;
            const std::uint32_t next = along_x ? k + 1 : k + columns;
            if (next >= count || (along_x && next % columns == 0)) continue;
            Link link = link_between(agents.people, first + k, first + next, group.hold == Hold::arms);
            link.leads = lead_of(agents, scene.world->period(), link.a, link.b);
            links.push_back(link);
        }
        first += count;
    }
    return links;
}

void hold_hands(CrowdWorld& crowd) {
    const Crowd& settings = crowd.scene.crowd;
    if (crowd.links.empty() && !settings.helping && settings.ropes.empty()) return;
    let_go_of_who_ended(crowd);
    if (settings.helping) take_hold(crowd);
    if (!settings.ropes.empty()) {
        follow_ropes(crowd);
        take_ropes(crowd);
    }
    if (!crowd.links.empty()) {
        weaken(crowd.agents.people, crowd.links);
        Linked linked = linked_people(crowd);
        pull_links(linked.people, crowd.links, linked.of_link, crowd.part_time);
        for (std::size_t i = 0; i < linked.place.size(); ++i) {
            const LinkedPerson& one = linked.people[i];
            crowd.next.at_end[linked.place[i]] = one.next;
            crowd.next.push[linked.place[i]] = step_in_water(one.person, one.velocity, one.pulls, crowd.part_time).drag;
            crowd.next.mean[linked.place[i]] =
                one.person.has_ground ? one.next : Vector2d(0.5 * (one.velocity + one.next));
        }
        std::erase_if(crowd.links, [&](const Link& link) {
            if (!lets_go(link, crowd.part_time)) return false;
            if (link.kind == LinkKind::rope) crowd.hands_spent[link.a] = time_of(crowd) + rest_of_hands;
            return true;
        });
    }
    tire_all_hands(crowd);
    note_holds(crowd);
}

}  // namespace wade::crowd
