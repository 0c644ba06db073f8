#include "crowd_client/session/crowd_list.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "configs/errors/exit_code.hpp"
#include "configs/errors/nearest_name.hpp"
#include "configs/loading/scene_file.hpp"
#include "configs/scene/coupling.hpp"

namespace wade::crowd {
namespace {

using nlohmann::json;

constexpr std::size_t longest_name = 100;
constexpr std::array<std::string_view, 6> own_keys{"/seed", "/name", "/description", "/crowd", "/coupling", "/events"};
constexpr const char* allowed_keys = "/seed, /name, /description, /events and what lies below /crowd and /coupling";

template <typename Json>
std::string shown(const Json& value) {
    constexpr std::size_t longest = 60;
    std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    return text;
}

// What the files beside the folders of the crowds end in: those of the programs, of scripts, and parts of them.
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

void check_keys(const json& entry, const std::string& where) {
    for (const auto& [key, value] : entry.items()) {
        if (key == "name" || key == "set" || key == "pictures") continue;
        throw ConfigurationError(where + ": unknown key \"" + key + "\"; the nearest known key is \"" +
                                 nearest_name(key, {"name", "set", "pictures"}) + "\".");
    }
}

std::string name_of(const json& entry, const std::string& where, std::set<std::string>& taken) {
    if (!entry.is_object()) {
        throw ConfigurationError(where + ": expected an object with \"name\" and \"set\", found " + shown(entry) + ".");
    }
    check_keys(entry, where);
    if (!entry.contains("name")) throw ConfigurationError(where + "/name: required key \"name\" is missing.");
    const json& name = entry["name"];
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

bool pictures_of(const json& entry, const std::string& who) {
    const json pictures = entry.value("pictures", json(true));
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

// What belongs to the water stays; the way back belongs to it, too.
void demand_same_water(const json& water, const json& crowd, const std::string& who) {
    for (const json& change : json::diff(water, crowd)) {
        const auto pointer = change["path"].get<std::string>();
        if (is_own(pointer) && pointer != "/coupling/agents_stream") continue;
        const json::json_pointer place(pointer);
        const std::string value = crowd.contains(place) ? shown(crowd[place]) : "nothing";
        const std::string base = water.contains(place) ? shown(water[place]) : "nothing";
        throw ConfigurationError(who + ": " + pointer + ": " + value + " is not the scene's " + base +
                                 ", but all crowds share one water; allowed to differ: " + allowed_keys + ".");
    }
}

// entry: in the order in which it is written, as a later key of "set" may need an earlier one: /events/1 that of
// /events/0.
LoadedScene load_one(const nlohmann::ordered_json& entry, const std::string& who,
                     const std::filesystem::path& scene_file, std::vector<SceneOverride> overrides) {
    const auto set = entry.value("set", nlohmann::ordered_json::object());
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
    const json document = parse_scene_text(text, source);
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
    const json water_document = parse_scene_text(water.canonical_json, source);
    const auto in_order = nlohmann::ordered_json::parse(text.begin(), text.end(), nullptr, true, true);
    std::vector<ListedCrowd> crowds;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < document.size(); ++i) {
        const std::string name = name_of(document[i], source + ": /" + std::to_string(i), taken);
        const std::string who = source + ": crowd \"" + name + "\"";
        const bool pictures = pictures_of(document[i], who);
        crowds.push_back({name, load_one(in_order[i], who, scene_file, overrides), pictures});
        demand_same_water(water_document, parse_scene_text(crowds.back().loaded.canonical_json, source), who);
    }
    return crowds;
}

std::vector<ListedCrowd> load_crowds(const std::filesystem::path& list, const std::filesystem::path& scene_file,
                                     const std::vector<SceneOverride>& overrides, const LoadedScene& water) {
    return load_crowds_text(read_text_file(list, "--crowds: " + list.string()), list, scene_file, overrides, water);
}

}  // namespace wade::crowd
