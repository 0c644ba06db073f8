#pragma once
// The groups of the residents of a site.

#include <algorithm>
#include <cstddef>

#include "configs/scene/crowd.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// Returns the index of the first group that starts in houses; residents without a group belong to it. Returns the
// number of groups if there is none.
[[nodiscard]] inline std::size_t first_group_in_houses(const Crowd& crowd) {
    const auto found = std::find_if(crowd.groups.begin(), crowd.groups.end(),
                                    [](const AgentGroup& group) { return group.starts == StartRule::houses; });
    return static_cast<std::size_t>(found - crowd.groups.begin());
}

// Calls visit(resident) for each resident of the table in `group`, which starts in houses.
template <typename Visit>
void for_each_resident(const Scene& scene, std::size_t group, Visit&& visit) {
    if (!scene.site || !scene.site->residents) return;
    const bool is_first = first_group_in_houses(scene.crowd) == group;
    for (const Resident& row : *scene.site->residents) {
        if (row.group.empty() ? is_first : row.group == scene.crowd->groups[group].name) visit(row);
    }
}

// Sets the size of each group that starts in houses to its residents in the table; the first group also gets the
// residents that the houses declare.
inline void count_lodgers(Scene& scene) {
    for (std::size_t g = 0; scene.site && g < scene.crowd->groups.size(); ++g) {
        AgentGroup& group = scene.crowd->groups[g];
        if (group.starts != StartRule::houses) continue;
        group.count = 0;
        for_each_resident(scene, g, [&](const Resident&) { ++group.count; });
        if (g != first_group_in_houses(scene.crowd)) continue;
        for (const House& house : scene.site->houses) group.count += house.residents;
    }
}

}  // namespace wade
