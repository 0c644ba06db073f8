#include "configs/loading/scene_loader.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <utility>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/problems.hpp"
#include "configs/json/json.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/loading/scene_override.hpp"
#include "configs/loading/site_reader.hpp"
#include "configs/numbers/fnv1a.hpp"
#include "configs/scene/idle_keys.hpp"
#include "configs/scene/kernel_choice.hpp"
#include "configs/scene/scene_json.hpp"

namespace wade {

namespace {

// Whether a value of the crowd, if every group has it itself, is an oversight: it is where it was written with the groups'
// or over them, not where groups were given their own over an extended scene or by an override.
bool must_be_used(const std::string& key, const std::vector<Json>& layers, const std::vector<SceneOverride>& overrides,
                  const Json& merged) {
    if (!merged["crowd"].contains(key)) return false;
    std::ptrdiff_t crowd = -1, groups = -1;  // the last layer that sets it; the overrides are one behind the others
    const auto last = static_cast<std::ptrdiff_t>(layers.size());
    for (std::ptrdiff_t k = 0; k < last; ++k) {
        const Json& its = layers[static_cast<std::size_t>(k)]["crowd"];
        if (its.contains(key)) crowd = k;
        for (const auto& group : its["groups"]) {
            if (group.contains(key)) groups = k;
        }
    }
    for (const SceneOverride& change : overrides) {
        if (change.pointer == "/crowd" || change.pointer.starts_with("/crowd/" + key)) crowd = last;
        if (change.pointer == "/crowd" || change.pointer.starts_with("/crowd/groups")) groups = last;
    }
    return crowd >= groups;
}

// The keys of the crowd that groups take over which set none.
std::vector<std::string> inherited_by_groups() {
    std::vector<std::string> names;
    for (const KeyNode& node : scene_keys().find("crowd")->inside) {
        if (node.key.storage == Storage::shorthand) names.emplace_back(node.key.name);
    }
    return names;
}

void note_if_unused(const std::string& key, const Json& crowd, const std::string& source, Problems& problems) {
    const Json& groups = crowd["groups"];
    const bool used =
        std::any_of(groups.begin(), groups.end(), [&](const auto& group) { return !group.contains(key); });
    if (groups.empty() || used) return;
    problems.note(source + ": /crowd/" + key + ": " + crowd[key].dump({.sorted = true}) +
                  " has no effect, as every group sets its own; set /crowd/groups/0/" + key + " instead.");
}

// A site stands for the channel and what is in it. A scene that was printed holds the channel that its site makes, a closed
// one; of any other nothing more needs to be said.
void note_beside_site(const std::string& key, const std::string& source, Problems& problems) {
    problems.note(source + ": /" + key +
                  ": a site stands instead of the channel and its obstacles; allowed: none beside /site, also in the "
                  "scenes that it extends. Houses are /site/houses.");
}
void drop_channel_beside_site(Json& document, const std::string& source, Problems& problems) {
    if (!document.contains("site") || !document.contains("channel")) return;
    if (std::as_const(document)["channel"]["flow"] == "closed") return;
    note_beside_site("channel", source, problems);
    document.erase("channel");
}

SetByScene set_by(const Json& document) {
    const auto sets = [&](const char* object, const char* key) { return document[object].contains(key); };
    const bool ways = document["crowd"]["navigation"].contains("cell_m");
    return {sets("world", "length_m"), sets("world", "width_m"), sets("fluid", "model"), ways};
}

void site_instead_of_channel(const Json& document, Scene& scene, const std::string& source, Problems& problems) {
    const std::string as_written = written_scene(scene)["channel"].dump();
    read_site(scene, set_by(document), source, problems);
    if (!scene.obstacles.empty()) note_beside_site("obstacles", source, problems);
    if (document.contains("channel") && written_scene(scene)["channel"].dump() != as_written)
        note_beside_site("channel", source, problems);
}

// A name for folders and titles that is as near to the file's as its characters allow: "my scene.json" is "my_scene". A
// character of several bytes (UTF-8) becomes one '_', and so do dots and dashes in front, which would hide a folder, lead out of it
// or look like an option.
std::string name_from(const std::filesystem::path& file) {
    std::string name;
    for (const char c : file.stem().string()) {
        const bool continues = (static_cast<unsigned char>(c) & 0xC0u) == 0x80u;
        const bool allowed = ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || c == '_' ||
                             c == '-' || c == '.';
        if (!continues) name += allowed ? c : '_';
    }
    const std::size_t front = std::min(name.find_first_not_of(".-"), name.size());
    name.replace(0, front, front, '_');
    const std::size_t longest = scene_keys().find("name")->key.text.longest;
    if (name.size() > longest) name.resize(longest);
    return name.empty() ? "scene" : name;
}

// What a scene is called does not change what happens in it.
std::uint64_t scene_hash(Json document) {
    document.erase("name");
    document.erase("description");
    put_contents_for_paths(document);
    return fnv1a(document.dump({.sorted = true}));
}

}  // namespace

LoadedScene load_scene_text(std::string_view text, const std::filesystem::path& file,
                            const std::vector<SceneOverride>& overrides) {
    const std::string source = file.string();
    const std::vector<Json> layers = scene_layers(text, file);
    Json document = merge_layers(layers);
    Problems problems;
    for (const SceneOverride& change : overrides) problems.attempt([&] { apply_override(document, change); });
    problems.throw_if_any();
    make_paths_absolute(document, "");  // those of overrides
    for (const std::string& key : inherited_by_groups()) {
        if (must_be_used(key, layers, overrides, document)) note_if_unused(key, document["crowd"], source, problems);
    }

    LoadedScene loaded;
    loaded.scene.name = name_from(file);
    drop_channel_beside_site(document, source, problems);
    read_scene(document, loaded.scene, {source, problems});
    problems.throw_if_any();
    if (loaded.scene.site_keys) site_instead_of_channel(document, loaded.scene, source, problems);
    problems.throw_if_any();
    const std::vector<IdleKey> idle = idle_keys(document, loaded.scene);
    for (const IdleKey& key : idle) {
        if (key.for_good) problems.note(source + ": " + refusal_of(key));
    }
    problems.throw_if_any();
    loaded.warnings = warnings_of(idle);
    choose_kernel(loaded.scene);
    check_scene(loaded.scene, source);
    const Json resolved = written_scene(loaded.scene);
    loaded.scene.hash = scene_hash(resolved);
    loaded.canonical_json = resolved.dump({.indent = 2, .sorted = true}) + "\n";
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
