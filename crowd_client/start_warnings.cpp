#include "crowd_client/start_warnings.hpp"

#include <cmath>
#include <sstream>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/navigation/site_routes.hpp"

namespace wade::crowd {
namespace {

// Markers in a cell for perception radii of 1 and 2 m.
struct Needed {
    double at_1_m, at_2_m;
};

Needed needed_markers(const Crowd& crowd) {
    const bool bodies = crowd.bodies != BodyRule::none;  // agents claim markers ahead of themselves
    if (crowd.markers == MarkerRule::fixed) return bodies ? Needed{16, 5} : Needed{45, 6};
    return bodies ? Needed{6, 4} : Needed{16, 4};
}

std::string warning_of_markers(const Crowd& crowd) {
    std::ostringstream text;
    text << "/crowd/markers_per_cell: with " << crowd.markers_per_cell
         << " markers in a cell of 2 x 2 m people walk at less "
         << "than nine tenths of their desired speed, or not at all; " << least_markers_per_cell(crowd)
         << " or more let them walk";
    return text.str();
}

}  // namespace

int least_markers_per_cell(const Crowd& crowd) {
    const Needed needed = needed_markers(crowd);
    const double radius = crowd.perception_radius;
    // Below 1 m as many markers are needed within the radius as at 1 m; above, a power of the radius gives the number.
    const double count = radius < 1 ? needed.at_1_m / (radius * radius)
                                    : needed.at_1_m * std::pow(needed.at_2_m / needed.at_1_m, std::log2(radius));
    return static_cast<int>(std::ceil(count - 1e-9));
}

std::vector<std::string> start_warnings(const Scene& scene, const Agents& agents, const Navigation& navigation) {
    std::vector<std::string> warnings = rate_warnings(scene);
    if (agents.size() > 0 && has_too_few_markers(scene.crowd)) warnings.push_back(warning_of_markers(scene.crowd));
    const std::string no_way =
        scene.site ? people_cut_off(navigation, scene, agents) : people_without_route(navigation, scene, agents);
    if (no_way.empty()) return warnings;
    const bool may_stand = scene.crowd->navigation.rule == NavigationRule::straight;
    if (scene.crowd->bodies != BodyRule::none && !may_stand) throw ConfigurationError(no_way);
    warnings.push_back(no_way);
    return warnings;
}

}  // namespace wade::crowd
