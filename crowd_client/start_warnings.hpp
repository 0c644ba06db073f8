#pragma once
// Warnings about a scene's markers and routes before the first step.

#include <string>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/navigation/navigation.hpp"

namespace wade::crowd {

// Returns the fewest markers per cell for a lone agent to walk at nine tenths of its desired speed. Measured with the
// speed rule `pi`: 100 walks of 20 s each, 1 to 100 markers per cell; see the test.
[[nodiscard]] int least_markers_per_cell(const Crowd& crowd);

[[nodiscard]] inline bool has_too_few_markers(const Crowd& crowd) {
    return crowd.markers_per_cell < least_markers_per_cell(crowd);
}

// Returns sentences for the user, each with the key: too few markers, agents without a route to their goal. Throws
// ConfigurationError for bodies that fit through no route to their goal, unless the scene states the navigation
// `straight`.
[[nodiscard]] std::vector<std::string> start_warnings(const Scene& scene, const Agents& agents,
                                                      const Navigation& navigation);

}  // namespace wade::crowd
