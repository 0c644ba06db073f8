#pragma once
// Scenes for the tests of this folder.

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "configs/loading/scene_loader.hpp"

namespace wade::test {

// A closed channel of 40 m x 20 m without water in a world of 100 m x 50 m; all else has its default.
inline const std::string dry_scene =
    R"({"channel": {"x_min_m": 0, "x_max_m": 40, "z_min_m": 10, "z_max_m": 30, "flow": "closed"}})";

// dry_scene with `patch` merged over it, loaded as "scene.json".
LoadedScene load_patched(const std::string& patch, const std::vector<std::string>& assignments = {});

// Returns the error text of that scene; fails the test if the scene is accepted.
std::string refusal(const std::string& patch, const std::vector<std::string>& assignments = {});

// Returns the error text of a refused file.
std::string refusal_of_text(const std::string& text);
std::string refusal_of_file(const std::filesystem::path& file);

// One group on a grid, as JSON; `more` is appended to its keys.
std::string group(const std::string& name, double x, double z, const std::string& more = "");

// A scene's patch with these groups, as JSON; `more` is appended to its keys.
inline std::string crowd(const std::string& groups, const std::string& more = "") {
    return R"({"crowd": {"groups": [)" + groups + "]}" + more + "}";
}

// A new folder that goes with its owner.
class TemporaryFolder {
 public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
    std::filesystem::path path_;
};

}  // namespace wade::test
