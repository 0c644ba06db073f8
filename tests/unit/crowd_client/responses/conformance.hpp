#pragma once
// The tests of a response that need no knowledge of it.

#include <string>
#include <vector>

#include "crowd_client/responses/registry.hpp"

namespace wade::crowd::testing {

// Scenes that differ in all that the coupling of the crowd and the water can be asked for.
[[nodiscard]] std::vector<Scene> coupled_scenes();
[[nodiscard]] std::string name_of(const Scene& scene);

// Fails the test at hand where the response of a scene
//   gives velocities that are not finite, or not one to each agent
//   differs from one call to the next
//   depends on where in the list an agent stands
//   moves an agent that the water cannot move (tau 0), or one without water, away from its walking velocity
//   leaves an agent unmoved that yields to all water (tau 1)
void check_response(const RegisteredResponse& entry, const Scene& scene);

}  // namespace wade::crowd::testing
