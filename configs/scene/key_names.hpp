#pragma once
// Which key may have been meant by one that is not known.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "configs/errors/nearest_name.hpp"
#include "configs/scene/key_node.hpp"

namespace wade {

// "the nearest known key is "z_m"", for `name` in the object `present`, whose keys are `node`'s; or the full pointer of a
// key that stands elsewhere in `all`, if that is what was written and nothing here is near it:
//   here       a name that differs by a third of its characters or lacks words; of equals one that is not set yet
//   elsewhere  the same name, or one that differs by a quarter of it; up to three places, the least deep first
[[nodiscard]] std::string nearest_key(const nlohmann::json& present, const KeyNode& node, const std::string& name,
                                      const KeyNode& all);

}  // namespace wade
