#include "scene_texts.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "configs/errors/exit_code.hpp"
#include "configs/loading/scene_file.hpp"

namespace wade::test {

namespace {

template <typename Load>
std::string refusal_from(const Load& load) {
    try {
        load();
    } catch (const ConfigurationError& error) {
        REQUIRE(error.code() == ExitCode::bad_configuration);
        return error.what();
    }
    FAIL("the scene was accepted");
    return "";
}

}  // namespace

LoadedScene load_patched(const std::string& patch, const std::vector<std::string>& assignments) {
    Json document = parse_scene_text(dry_scene, "dry_scene");
    merge_over(document, parse_scene_text(patch, "patch"));
    std::vector<SceneOverride> overrides;
    for (const std::string& assignment : assignments) overrides.push_back(parse_override(assignment));
    return load_scene_text(document.dump(), "scene.json", overrides);
}

std::string refusal(const std::string& patch, const std::vector<std::string>& assignments) {
    return refusal_from([&] { static_cast<void>(load_patched(patch, assignments)); });
}

std::string refusal_of_text(const std::string& text) {
    return refusal_from([&] { static_cast<void>(load_scene_text(text, "scene.json")); });
}

std::string refusal_of_file(const std::filesystem::path& file) {
    return refusal_from([&] { static_cast<void>(load_scene(file)); });
}

std::string group(const std::string& name, double x, double z, const std::string& more) {
    return R"({"name": ")" + name + R"(", "start": {"x_m": )" + std::to_string(x) + R"(, "z_m": )" + std::to_string(z) +
           R"(}, "goal": {"x_m": 75, "z_m": 50})" + more + "}";
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "wade-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder " + name);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;  // a destructor may not throw, and a folder left in /tmp harms nothing
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
}

}  // namespace wade::test
