#include "configs/loading/scene_override.hpp"

#include <charconv>
#include <optional>

#include "configs/errors/exit_code.hpp"
#include "configs/errors/problems.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

// The keys of a JSON pointer (RFC 6901), unescaped.
std::vector<std::string> keys_of(const SceneOverride& change) {
    if (change.pointer.empty() || change.pointer.front() != '/') {
        throw ConfigurationError(change.source + ": \"" + change.pointer +
                                 "\" is not a JSON pointer; one begins with '/'," + " for example /fluid/cfl.");
    }
    std::vector<std::string> keys;
    for (std::size_t i = 0; i < change.pointer.size(); ++i) {
        const char c = change.pointer[i];
        if (c == '/') {
            keys.emplace_back();
        } else if (c == '~' && i + 1 < change.pointer.size() &&
                   (change.pointer[i + 1] == '0' || change.pointer[i + 1] == '1')) {
            keys.back() += change.pointer[++i] == '0' ? '~' : '/';
        } else {
            keys.back() += c;
        }
    }
    if (keys.front() == "place") keys.front() = "site";  // its name until version 1.0
    return keys;
}

std::size_t index_of(const std::string& key, const Json& array, const std::string& pointer,
                     const SceneOverride& change) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error != std::errc() || end != key.data() + key.size() || index > array.size()) {
        throw ConfigurationError(change.source + ": " + pointer_to(pointer, key) + ": \"" + key +
                                 "\" is not an index of " + pointer + "; allowed: 0 to " +
                                 std::to_string(array.size()) + (array.empty() ? "" : ", the last of which appends") +
                                 ".");
    }
    return index;
}

bool is_utf8(const std::string& text) {
    try {
        return !Json(text).dump().empty();
    } catch (const JsonError&) {
        return false;
    }
}

// JSON if it is, else the text itself; a key that takes a string takes any text as it stands, quoted or not.
Json value_of(const SceneOverride& change, const Key& key) {
    if (!is_utf8(change.value)) {
        throw ConfigurationError(change.source + ": the value is not valid UTF-8 text.");
    }
    const bool takes_words = key.kind == KeyKind::text || key.kind == KeyKind::choice;
    const std::optional<Json> value = Json::try_parse(change.value);
    if (!value || (takes_words && !value->is_string())) return change.value;
    return *value;
}

// What to write for a value that may be an object and is none.
std::string object_form(const KeyNode& node, const std::string& pointer) {
    if (node.key.kind != KeyKind::spread) return "";
    return "; it may be an object: " + pointer + R"(={"min":...,"max":...})";
}

bool holds_keys(const KeyNode& node, const Json& place) {
    return node.key.kind == KeyKind::object || (node.key.kind == KeyKind::spread && place.is_object());
}

}  // namespace

SceneOverride parse_override(const std::string& assignment) {
    const std::size_t equals = assignment.find('=');
    constexpr std::size_t longest_shown = 100;
    const std::string source =
        "--set " + (assignment.size() <= longest_shown ? assignment : assignment.substr(0, longest_shown) + "...");
    if (equals == std::string::npos) {
        throw ConfigurationError(source + ": expected /json/pointer=value, for example /fluid/cfl=0.3.");
    }
    return {assignment.substr(0, equals), assignment.substr(equals + 1), source};
}

void apply_override(Json& document, const SceneOverride& change) {
    Problems problems;
    const Reading reading{change.source, problems};
    KeyNode element;  // of a list that was entered: a nameless object
    const KeyNode* node = &scene_keys();
    Json* place = &document;
    std::string pointer;
    for (const std::string& key : keys_of(change)) {
        if (node->key.kind == KeyKind::list) {
            const std::size_t index = index_of(key, *place, pointer, change);
            element = element_of(*node);
            node = &element;
            if (index == place->size()) place->push_back(Json::object());
            place = &(*place)[index];
        } else if (holds_keys(*node, *place)) {
            const KeyNode* const inner = node->find(key);
            if (inner == nullptr) {
                note_unknown_key(*place, *node, key, pointer, reading);
                problems.throw_if_any();
            }
            node = inner;
            place = &(*place)[key];
            if (place->is_null() && node->key.kind == KeyKind::object) *place = Json::object();
            if (place->is_null() && node->key.kind == KeyKind::list) *place = Json::array();
        } else {
            throw ConfigurationError(change.source + ": " + pointer +
                                     " is no object and no array, so that nothing lies below it" +
                                     object_form(*node, pointer) + ".");
        }
        pointer = pointer_to(pointer, key);
    }
    if (node->key.storage == Storage::file) {
        throw ConfigurationError(change.source + ": " + pointer + " can only be set in a scene file.");
    }
    *place = value_of(change, node->key);
    check_keys(*place, *node, pointer, reading);
    problems.throw_if_any();
}

}  // namespace wade
