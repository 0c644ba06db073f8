#include <algorithm>
#include <cmath>
#include <sstream>
#include <unordered_map>

#include "configs/scene/crowd.hpp"
#include "crowd_client/crowd_motion.hpp"

namespace wade::crowd {
namespace {

// Positions near doors, in squares as wide as two bodies need.
class PlacesNear {
 public:
    explicit PlacesNear(double apart) : apart_(apart) {}

    void watch(const Vector2d& door) { places_[key_of(door, 0, 0)]; }
    // Keeps the position if it may be near a door.
    void add(const Vector2d& p) {
        for_each_square(p, [&](std::vector<Vector2d>& places) { places.push_back(p); });
    }
    [[nodiscard]] bool is_free(const Vector2d& door) const {
        const std::vector<Vector2d>& places = places_.at(key_of(door, 0, 0));
        return std::none_of(places.begin(), places.end(),
                            [&](const Vector2d& p) { return (p - door).squaredNorm() < apart_ * apart_; });
    }

 private:
    [[nodiscard]] std::uint64_t key_of(const Vector2d& p, int right, int up) const {
        const auto column = static_cast<std::int64_t>(std::floor(p.x() / apart_)) + right;
        const auto row = static_cast<std::int64_t>(std::floor(p.y() / apart_)) + up;
        return static_cast<std::uint64_t>(row) << 32 ^ (static_cast<std::uint64_t>(column) & 0xffffffffU);
    }
    template <typename Visit>
    void for_each_square(const Vector2d& p, Visit&& visit) {
        for (int up = -1; up <= 1; ++up) {
            for (int right = -1; right <= 1; ++right) {
                if (const auto found = places_.find(key_of(p, right, up)); found != places_.end()) visit(found->second);
            }
        }
    }

    double apart_;
    std::unordered_map<std::uint64_t, std::vector<Vector2d>> places_;
};

// Moves agents past their departure time to their doors or upstairs.
void take_due(CrowdWorld& crowd, std::uint64_t step) {
    Indoors& indoors = crowd.indoors;
    for (; indoors.next < indoors.due.size() && indoors.due[indoors.next].step <= step; ++indoors.next) {
        const std::uint32_t id = indoors.due[indoors.next].id;
        if (crowd.agents.goes_up[id] == 0) {
            indoors.at_door.push_back(id);
            continue;
        }
        crowd.agents.outcome[id] = Outcome::upper_floor;
        --indoors.inside;
        ++indoors.upstairs;
    }
}

void step_out(CrowdWorld& crowd, std::uint32_t id) {
    Agents& agents = crowd.agents;
    agents.outcome[id] = Outcome::active;
    agents.stay[id] = agents.position[id];
    agents.stay_step[id] = crowd.steps;
    crowd.active.push_back(id);
    --crowd.indoors.inside;
}

}  // namespace

Indoors indoors_of(const Agents& agents, double dt) {
    Indoors indoors;
    for (std::uint32_t id = 0; id < agents.leaves.size(); ++id) {
        if (agents.outcome[id] != Outcome::indoors) continue;
        ++indoors.inside;
        if (!std::isfinite(agents.leaves[id])) continue;
        // The first step that starts at that time or later.
        const auto step = static_cast<std::uint64_t>(std::ceil(std::max(0.0, agents.leaves[id] / dt - 1e-6))) + 1;
        indoors.due.push_back({step, id});
    }
    std::sort(indoors.due.begin(), indoors.due.end(),
              [](const Departure& a, const Departure& b) { return a.step != b.step ? a.step < b.step : a.id < b.id; });
    return indoors;
}

void let_out(CrowdWorld& crowd) {
    Indoors& indoors = crowd.indoors;
    const std::uint64_t step = crowd.steps + 1;
    if (indoors.inside == 0 || indoors.let_out_before == step) return;
    indoors.let_out_before = step;
    take_due(crowd, step);
    if (indoors.at_door.empty()) return;
    PlacesNear near(2 * crowd.scene.crowd->body_radius + 1e-3);
    for (const std::uint32_t id : indoors.at_door) near.watch(crowd.agents.position[id]);
    for (const std::uint32_t id : crowd.active) near.add(crowd.agents.position[id]);
    const std::size_t before = crowd.active.size();
    std::erase_if(indoors.at_door, [&](std::uint32_t id) {
        const Vector2d& door = crowd.agents.position[id];
        if (!near.is_free(door)) return false;
        near.add(door);
        step_out(crowd, id);
        return true;
    });
    if (crowd.active.size() > before) std::sort(crowd.active.begin(), crowd.active.end());
}

void note_depth_at_doors(CrowdWorld& crowd) {
    const SiteRoutes& site = *crowd.navigation.site;
    if (!site.is_wet) return;
    Agents& agents = crowd.agents;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (agents.outcome[id] != Outcome::indoors && agents.outcome[id] != Outcome::upper_floor) continue;
        const auto depth = static_cast<double>(site.depth[site.cell_at(agents.position[id])]);
        agents.door_depth[id] = std::max(agents.door_depth[id], depth);
    }
}

namespace {

template <typename Visit>
void for_each_behind_deep_water(const Agents& agents, Visit&& visit) {
    for (std::size_t id = 0; id < agents.door_depth.size(); ++id) {
        if (agents.outcome[id] == Outcome::indoors && agents.door_depth[id] > deep_at_door) visit(id);
    }
}

}  // namespace

std::size_t count_behind_deep_water(const CrowdWorld& crowd) {
    std::size_t count = 0;
    for_each_behind_deep_water(crowd.agents, [&](std::size_t) { ++count; });
    return count;
}

std::string warning_of_deep_water(const CrowdWorld& crowd) {
    double largest = 0;
    for_each_behind_deep_water(crowd.agents,
                               [&](std::size_t id) { largest = std::max(largest, crowd.agents.door_depth[id]); });
    if (largest == 0) return "";
    std::ostringstream text;
    text << count_behind_deep_water(crowd) << " people are indoors behind " << deep_at_door << " to "
         << std::ceil(10 * largest) / 10 << " m of water; houses are not modelled, so they are neither safe nor lost";
    return text.str();
}

bool goes_to_shelters(const CrowdWorld& crowd, std::uint32_t id) {
    return crowd.navigation.site && crowd.navigation.site->groups[crowd.agents.group[id]].to_shelters;
}

Outcome come_to_shelter(CrowdWorld& crowd, std::uint32_t id) {
    if (!has_ground(crowd.agents.people.condition[id].state)) return Outcome::active;
    const auto shelter = shelter_at(crowd.navigation, crowd.agents.position[id]);
    if (!shelter) return Outcome::active;
    take_in(crowd.navigation, *shelter);
    const std::vector<SiteShelter>& shelters = crowd.scene.site->shelters;
    return *shelter < shelters.size() && shelters[*shelter].is_exit ? Outcome::arrived : Outcome::sheltered;
}

bool may_come_out(const CrowdWorld& crowd) {
    const Indoors& indoors = crowd.indoors;
    if (!indoors.at_door.empty()) return true;
    return std::any_of(indoors.due.begin() + static_cast<std::ptrdiff_t>(indoors.next), indoors.due.end(),
                       [&](const Departure& one) { return crowd.agents.goes_up[one.id] == 0; });
}

}  // namespace wade::crowd
