#include "configs/scene_loader.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "configs/scene_checks.hpp"
#include "configs/scene_file.hpp"
#include "configs/scene_json.hpp"
#include "configs/scene_override.hpp"
#include "configs/scene_schema.hpp"

namespace wade {

namespace {

// 64-bit FNV-1a (Fowler, Noll, Vo).
std::uint64_t fnv1a(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 0x100000001b3u;
    }
    return hash;
}

// The last of the layers, and behind them the overrides as one, that has a value of the crowd, or of any group; -1: none.
struct LastSet {
    int crowd = -1, groups = -1;
};

LastSet last_set(const std::vector<nlohmann::json>& layers, const std::vector<SceneOverride>& overrides,
                 const std::string& key) {
    LastSet last;
    for (int k = 0; k < static_cast<int>(layers.size()); ++k) {
        const nlohmann::json& layer = layers[static_cast<std::size_t>(k)];
        if (!layer.contains("crowd")) continue;
        const nlohmann::json& crowd = layer["crowd"];
        if (crowd.contains(key)) last.crowd = k;
        const nlohmann::json groups = crowd.value("groups", nlohmann::json::array());
        if (std::any_of(groups.begin(), groups.end(), [&](const auto& group) { return group.contains(key); })) {
            last.groups = k;
        }
    }
    for (const SceneOverride& change : overrides) {
        if (change.pointer.starts_with("/crowd/" + key)) last.crowd = static_cast<int>(layers.size());
        if (change.pointer.starts_with("/crowd/groups/")) last.groups = static_cast<int>(layers.size());
    }
    return last;
}

// A value of the crowd that every group has itself is an oversight where it was written with the groups' or over them. A
// group that was given its own over an extended scene, or by an override, is none.
std::vector<std::string> values_that_must_be_used(const std::vector<nlohmann::json>& layers,
                                                  const std::vector<SceneOverride>& overrides) {
    std::vector<std::string> keys;
    for (const std::string& key : inherited_by_groups()) {
        const LastSet last = last_set(layers, overrides, key);
        if (last.crowd >= 0 && last.crowd >= last.groups) keys.push_back(key);
    }
    return keys;
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
    complete_with_defaults(document, scene_schema(), "", source);
    resolve_shorthands(document, values_that_must_be_used(layers, overrides), source);

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
