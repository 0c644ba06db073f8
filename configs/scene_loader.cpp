#include "configs/scene_loader.hpp"

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
    nlohmann::json document = resolve_scene_text(text, file);
    for (const SceneOverride& change : overrides) apply_override(document, change);
    if (!document.contains("name")) {
        document["name"] = file.stem().string();
        check_against_schema(document["name"], scene_schema()["properties"]["name"], "/name", source);
    }
    const nlohmann::json as_written = document;
    complete_with_defaults(document, scene_schema(), "", source);
    resolve_shorthands(document, as_written, source);

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
