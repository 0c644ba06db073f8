#pragma once
// What every model of the water has to keep, whoever wrote it.

#include <string>
#include <vector>

#include "fluid_server/make_model.hpp"

namespace wade::fluid::test {

// Runs the model over some frames of the scene, with one thread and with two. Returns the rules that it broke, a sentence
// each; none: it conforms.
[[nodiscard]] std::vector<std::string> broken_rules(const ModelRow& row, const Scene& scene);

}  // namespace wade::fluid::test
