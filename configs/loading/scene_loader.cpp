#include "configs/loading/scene_loader.hpp"

#include <cstddef>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "configs/checks/scene_checks.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/loading/scene_override.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/scene_json.hpp"
#include "configs/scene/scene_schema.hpp"

namespace wade {

namespace {

// Whether a value of the crowd, if every group has it itself, is an oversight: it is where it was written with the groups'
// or over them, not where groups were given their own over an extended scene or by an override.
bool must_be_used(const std::string& key, const std::vector<nlohmann::json>& layers,
                  const std::vector<SceneOverride>& overrides, const nlohmann::json& merged) {
    if (!merged.contains("crowd") || !merged["crowd"].contains(key)) return false;
    std::ptrdiff_t crowd = -1, groups = -1;  // the last layer that sets it; the overrides are one behind the others
    const auto last = static_cast<std::ptrdiff_t>(layers.size());
    for (std::ptrdiff_t k = 0; k < last; ++k) {
        const nlohmann::json its = layers[static_cast<std::size_t>(k)].value("crowd", nlohmann::json::object());
        if (its.contains(key)) crowd = k;
        for (const auto& group : its.value("groups", nlohmann::json::array())) {
            if (group.contains(key)) groups = k;
        }
    }
    for (const SceneOverride& change : overrides) {
        if (change.pointer == "/crowd" || change.pointer.starts_with("/crowd/" + key)) crowd = last;
        if (change.pointer == "/crowd" || change.pointer.starts_with("/crowd/groups")) groups = last;
    }
    return crowd >= groups;
}

// What a scene is called does not change what happens in it.
std::uint64_t scene_hash(nlohmann::json document) {
    document.erase("name");
    document.erase("description");
    return fnv1a(document.dump());
}

}  // namespace

LoadedScene load_scene_text(std::string_view text, const std::filesystem::path& file,
                            const std::vector<SceneOverride>& overrides) {
    const std::string source = file.string();
    const std::vector<nlohmann::json> layers = scene_layers(text, file);
    nlohmann::json document = merge_layers(layers);
    for (const SceneOverride& change : overrides) apply_override(document, change);
    if (!document.contains("name")) {
        document["name"] = file.stem().string();
        check_against_schema(document["name"], scene_schema()["properties"]["name"], "/name", source);
    }
    std::vector<std::string> to_be_used;
    for (const std::string& key : inherited_by_groups()) {
        if (must_be_used(key, layers, overrides, document)) to_be_used.push_back(key);
    }
    complete_with_defaults(document, scene_schema(), "", source);
    resolve_shorthands(document, to_be_used, source);

    LoadedScene loaded;
    loaded.scene = scene_from_json(document);
    check_scene(loaded.scene, source);
    loaded.scene.hash = scene_hash(document);
    loaded.canonical_json = document.dump(2) + "\n";
    return loaded;
}

LoadedScene load_scene(const std::filesystem::path& file, const std::vector<SceneOverride>& overrides) {
    return load_scene_text(read_text_file(file, file.string()), file, overrides);
}

std::string hash_text(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

}  // namespace wade
