#include "fluid_server/fluid_model.hpp"

#include "configs/errors/exit_code.hpp"

namespace wade::fluid {

void FluidModel::restore(const FluidState&, const std::string& source) {
    throw ConfigurationError(source + ": /fluid/model is " + std::string(name()) +
                             "; allowed: dfsph, the only model that has a state");
}

}  // namespace wade::fluid
