#pragma once
// Keys that a document sets and that have no effect in its scene.

#include <cstddef>
#include <string>
#include <vector>

#include "configs/json/json.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

// A key with another value than its default, where it does not act (Acting of fields.hpp).
struct IdleKey {
    std::string pattern;    // "/crowd/groups/*/leaves/rule"
    std::string pointer;    // the first of this pattern
    std::size_t count = 1;  // of this pattern
    std::string value;      // of the first, as JSON; of a list the number of its elements
    std::string allowed;    // the default, as JSON, or "none"
    std::string words;      // where it acts
    bool for_good = false;
};

// Returns the idle keys of `document`, the merged source of `scene`, in the order of their declarations.
[[nodiscard]] std::vector<IdleKey> idle_keys(const Json& document, const Scene& scene);

// Returns what is wrong with a key that is idle for good: "POINTER: VALUE has no effect, ...".
[[nodiscard]] std::string refusal_of(const IdleKey& key);

// Returns a sentence for each reason, with its keys, of keys that are idle but not for good.
[[nodiscard]] std::vector<std::string> warnings_of(const std::vector<IdleKey>& keys);

}  // namespace wade
