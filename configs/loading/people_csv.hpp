#pragma once
// Tables of people: a line a person, the first line names the columns, as keys of /crowd/people are named.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "configs/errors/problems.hpp"

namespace wade {

// Puts the people of each file that `people_csv` names, of the crowd or of a group, in its place. Paths are relative to the
// folder of `scene_file`. Notes what is wrong with file, line, column, value and what is allowed.
void take_people(nlohmann::json& document, const std::filesystem::path& scene_file, Problems& problems);

}  // namespace wade
