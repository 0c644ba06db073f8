#pragma once
// Help for misspelt names.

#include <string>
#include <string_view>
#include <vector>

namespace wade {

// Edit distance of two names: insertions, deletions, replacements and swaps of neighbouring characters, each counted as
// one (optimal string alignment).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate with the smallest edit distance, the first of equals; empty if there are no candidates.
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace wade
