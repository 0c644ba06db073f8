#include "configs/loading/short_names.hpp"

#include <cstdlib>
#include <system_error>
#include <vector>

namespace wade {

std::optional<std::filesystem::path> scenes_folder() {
    std::error_code ignored;
    std::vector<std::filesystem::path> candidates;
    if (const char* named = std::getenv("WADE_CONFIGS")) candidates.emplace_back(named);
    const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
    candidates.push_back(programs / "../share/wade/configs");
    candidates.push_back(programs / "../../configs");
    for (const std::filesystem::path& candidate : candidates) {
        if (std::filesystem::is_directory(candidate / "paper", ignored)) return candidate.lexically_normal();
    }
    return {};
}

std::optional<std::filesystem::path> scene_of_short_name(const std::string& name, const std::filesystem::path& folder) {
    std::filesystem::path below(name);
    if (below.extension() != ".json") below += ".json";
    // A short name leads nowhere else.
    if (below.is_absolute() || below != below.lexically_normal() || *below.begin() == "..") return {};
    std::error_code ignored;
    for (const std::filesystem::path& file : {folder / below, folder / "paper" / below}) {
        if (std::filesystem::is_regular_file(file, ignored)) return file;
    }
    std::string ending = "/";
    ending += below.string();
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, ignored)) {
        if (entry.path().string().ends_with(ending) && entry.is_regular_file(ignored)) {
            found.push_back(entry.path());
        }
    }
    if (found.size() != 1) return {};
    return found.front();
}

}  // namespace wade
