#include "crowd_client/session/crowd_list.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "configs/errors/exit_code.hpp"
#include "configs/errors/nearest_name.hpp"
#include "configs/json/json.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/key_node.hpp"

namespace wade::crowd {
namespace {

constexpr std::size_t longest_name = 100;
constexpr std::array<std::string_view, 6> own_keys{"/seed", "/name", "/description", "/crowd", "/coupling", "/events"};
constexpr const char* allowed_keys = "/seed, /name, /description, /events and what lies below /crowd and /coupling";

std::string shown(const Json& value) {
    constexpr std::size_t longest = 60;
    std::string text = value.dump({.sorted = true, .lossy_text = true});
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    return text;
}

// Endings of the files beside the folders of the crowds: files of the programs, of scripts, and parts of them.
constexpr std::array<std::string_view, 10> file_endings{".csv", ".json", ".jsonl", ".log",   ".part",
                                                        ".png", ".bin",  ".wrec",  ".state", ".sqlite"};

std::string lower_case(std::string text) {
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

// Letters, digits, '_', '-' and '.', but neither '.' nor '-' in front: the name of a folder that is not hidden, not
// elsewhere and no option.
bool is_safe(const std::string& name) {
    constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    return !name.empty() && name.size() <= longest_name && name.front() != '.' && name.front() != '-' &&
           name.find_first_not_of(allowed) == std::string::npos;
}

bool ends_like_a_file(const std::string& name) {
    return std::any_of(file_endings.begin(), file_endings.end(),
                       [low = lower_case(name)](std::string_view ending) { return low.ends_with(ending); });
}

void check_keys(const Json& entry, const std::string& where) {
    for (const JsonMember* const member : entry.sorted_items()) {
        const std::string& key = member->first;
        if (key == "name" || key == "set" || key == "pictures") continue;
        throw ConfigurationError(where + ": unknown key \"" + key + "\"; the nearest known key is \"" +
                                 nearest_name(key, {"name", "set", "pictures"}) + "\".");
    }
}

std::string name_of(const Json& entry, const std::string& where, std::set<std::string>& taken) {
    if (!entry.is_object()) {
        throw ConfigurationError(where + ": expected an object with \"name\" and \"set\", found " + shown(entry) + ".");
    }
    check_keys(entry, where);
    if (!entry.contains("name")) throw ConfigurationError(where + "/name: required key \"name\" is missing.");
    const Json& name = entry["name"];
    if (!name.is_string() || !is_safe(name.get<std::string>())) {
        throw ConfigurationError(where + "/name: " + shown(name) + " is not allowed; allowed: 1 to " +
                                 std::to_string(longest_name) +
                                 " letters, digits, '_', '-' and '.', the first of them a letter, a digit or '_'.");
    }
    if (ends_like_a_file(name.get<std::string>())) {
        throw ConfigurationError(where + "/name: " + shown(name) +
                                 " could be a file beside the folders of the crowds; allowed: any that does not end "
                                 "like one, such as .csv, .json, .log or .part.");
    }
    // Some file systems do not tell "A" from "a".
    if (!taken.insert(lower_case(name.get<std::string>())).second) {
        throw ConfigurationError(where + "/name: " + shown(name) +
                                 " is the name of an earlier crowd, where 'A' and 'a' count as one; allowed: any "
                                 "other.");
    }
    return name.get<std::string>();
}

bool pictures_of(const Json& entry, const std::string& who) {
    if (!entry.contains("pictures")) return true;
    const Json& pictures = entry["pictures"];
    if (!pictures.is_boolean()) {
        throw ConfigurationError(who + ": /pictures: " + shown(pictures) + " is not allowed; allowed: true or false.");
    }
    return pictures.get<bool>();
}

bool is_own(const std::string& pointer) {
    return std::any_of(own_keys.begin(), own_keys.end(), [&](std::string_view key) {
        return pointer == key || (pointer.starts_with(key) && pointer[key.size()] == '/');
    });
}

// A value that differs between two scenes; a null pointer stands for a missing value.
struct Difference {
    std::string pointer;
    const Json* water;
    const Json* crowd;
};

// Returns all differences in order of keys and elements.
std::vector<Difference> differences(const Json& water, const Json& crowd, const std::string& pointer = "") {
    std::vector<Difference> all;
    const auto add = [&](const std::string& key, const Json* a, const Json* b) {
        if (a == nullptr || b == nullptr) return all.push_back({pointer_to(pointer, key), a, b});
        const std::vector<Difference> inside = differences(*a, *b, pointer_to(pointer, key));
        all.insert(all.end(), inside.begin(), inside.end());
    };
    if (water.is_object() && crowd.is_object()) {
        for (const JsonMember* const item : water.sorted_items())
            add(item->first, &item->second, crowd.find(item->first));
        for (const JsonMember* const item : crowd.sorted_items()) {
            if (!water.contains(item->first)) add(item->first, nullptr, &item->second);
        }
    } else if (water.is_array() && crowd.is_array()) {
        for (std::size_t i = 0; i < std::max(water.size(), crowd.size()); ++i)
            add(std::to_string(i), i < water.size() ? &water[i] : nullptr, i < crowd.size() ? &crowd[i] : nullptr);
    } else if (!(water == crowd)) {
        all.push_back({pointer, &water, &crowd});
    }
    return all;
}

// Throws if a crowd changes what belongs to the water; the agents stream belongs to it, too.
// has_columns: the water is published in another form for each response.
void demand_same_water(const Json& water, const Json& crowd, bool has_columns, const std::string& who) {
    for (const auto& [pointer, base, value] : differences(water, crowd)) {
        const bool chooses_water =
            pointer == "/coupling/agents_stream" || (has_columns && pointer == "/crowd/response");
        if (is_own(pointer) && !chooses_water) continue;
        throw ConfigurationError(who + ": " + pointer + ": " + (value == nullptr ? "nothing" : shown(*value)) +
                                 " is not the scene's " + (base == nullptr ? "nothing" : shown(*base)) +
                                 ", but all crowds share one water; allowed to differ: " + allowed_keys + ".");
    }
}

// Applies "set" in its written order: a later key may need an earlier one, as /events/1 needs /events/0.
LoadedScene load_one(const Json& entry, const std::string& who, const std::filesystem::path& scene_file,
                     std::vector<SceneOverride> overrides) {
    static const Json nothing = Json::object();
    const Json& set = entry.contains("set") ? entry["set"] : nothing;
    if (!set.is_object()) {
        throw ConfigurationError(who + ": /set: expected an object of JSON pointers and values, found " + shown(set) +
                                 ".");
    }
    for (const auto& [pointer, value] : set.items()) overrides.push_back({pointer, value.dump(), who});
    try {
        return load_scene(scene_file, overrides);
    } catch (const ConfigurationError& error) {
        const std::string text = error.what();
        throw ConfigurationError(text.starts_with(who) ? text : who + ": " + text);
    }
}

}  // namespace

std::vector<ListedCrowd> load_crowds_text(std::string_view text, const std::filesystem::path& list,
                                          const std::filesystem::path& scene_file,
                                          const std::vector<SceneOverride>& overrides, const LoadedScene& water) {
    const std::string source = list.string();
    const Json document = parse_scene_text(text, source);
    if (!document.is_array() || document.empty()) {
        throw ConfigurationError(source +
                                 ": expected a list of at least one crowd, each { \"name\": ..., \"set\": ... }, " +
                                 "found " + shown(document) + ".");
    }
    if (water.scene.coupling->two_way) {
        throw ConfigurationError(
            scene_file.string() +
            ": /coupling/two_way: many crowds share a water, and what one does to it the others would "
            "feel; allowed with --crowds: false.");
    }
    if (water.scene.coupling->agents_stream != AgentsStream::off) {
        throw ConfigurationError(scene_file.string() +
                                 ": /coupling/agents_stream: many crowds share a water that none of them moves; " +
                                 "allowed with --crowds: \"off\".");
    }
    const Json water_document = parse_scene_text(water.canonical_json, source);
    const ModelKind model = water.scene.fluid->model;
    const bool has_columns = model != ModelKind::dfsph && model != ModelKind::kinematic && model != ModelKind::steering;
    std::vector<ListedCrowd> crowds;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < document.size(); ++i) {
        const std::string name = name_of(document[i], source + ": /" + std::to_string(i), taken);
        const std::string who = source + ": crowd \"" + name + "\"";
        const bool pictures = pictures_of(document[i], who);
        crowds.push_back({name, load_one(document[i], who, scene_file, overrides), pictures});
        demand_same_water(water_document, parse_scene_text(crowds.back().loaded.canonical_json, source), has_columns,
                          who);
    }
    return crowds;
}

std::vector<ListedCrowd> load_crowds(const std::filesystem::path& list, const std::filesystem::path& scene_file,
                                     const std::vector<SceneOverride>& overrides, const LoadedScene& water) {
    return load_crowds_text(read_text_file(list, "--crowds: " + list.string()), list, scene_file, overrides, water);
}

}  // namespace wade::crowd
