#include "configs/loading/scene_override.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/scene_schema.hpp"

namespace wade {

namespace {

using nlohmann::json;

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
    return keys;
}

std::size_t index_of(const std::string& key, const json& array, const std::string& pointer,
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
        return !json(text).dump().empty();
    } catch (const json::type_error&) {
        return false;
    }
}

// The value as JSON, or discarded if it is none; a scene needs no deeper nesting than the limit.
json parsed(const std::string& text) {
    constexpr int deepest_allowed = 50;
    bool too_deep = false;
    const auto watch = [&too_deep](int depth, json::parse_event_t, const json&) {
        too_deep = too_deep || depth > deepest_allowed;
        return !too_deep;
    };
    json value = json::parse(text, watch, /*allow_exceptions=*/false);
    return too_deep ? json(json::value_t::discarded) : value;
}

// JSON if it is, else the text itself; a key that takes a string takes any text as it stands, quoted or not.
json value_of(const SceneOverride& change, const json& schema) {
    if (!is_utf8(change.value)) {
        throw ConfigurationError(change.source + ": the value is not valid UTF-8 text.");
    }
    json value = parsed(change.value);
    if (value.is_discarded() || (schema["type"] == "string" && !value.is_string())) return change.value;
    return value;
}

// What to write for a value that may be an object and is none.
std::string object_form(const json& schema, const std::string& pointer) {
    if (!schema["type"].is_array() || !schema.contains("required")) return "";
    std::string members;
    for (const json& key : schema["required"]) {
        if (!members.empty()) members += ',';
        members += key.dump();
        members += ":...";
    }
    return "; it may be an object: " + pointer + "={" + members + "}";
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

void apply_override(json& document, const SceneOverride& change) {
    const json* schema = &scene_schema();
    json* place = &document;
    std::string pointer;
    for (const std::string& key : keys_of(change)) {
        const std::string type = type_for(*place, *schema);
        if (type == "array") {
            const std::size_t index = index_of(key, *place, pointer, change);
            schema = &(*schema)["items"];
            if (index == place->size()) place->push_back((*schema)["type"] == "object" ? json::object() : json());
            place = &(*place)[index];
        } else if (type == "object") {
            if (!(*schema)["properties"].contains(key)) throw_unknown_key(*schema, key, pointer, change.source);
            schema = &(*schema)["properties"][key];
            place = &(*place)[key];
            if (place->is_null() && (*schema)["type"] == "object") *place = json::object();
            if (place->is_null() && (*schema)["type"] == "array") *place = json::array();
        } else {
            throw ConfigurationError(change.source + ": " + pointer +
                                     " is no object and no array, so that nothing lies below it" +
                                     object_form(*schema, pointer) + ".");
        }
        pointer = pointer_to(pointer, key);
    }
    if (pointer == "/extends" || pointer == "/$schema") {
        throw ConfigurationError(change.source + ": " + pointer + " can only be set in a scene file.");
    }
    *place = value_of(change, *schema);
    check_against_schema(*place, *schema, pointer, change.source);
}

}  // namespace wade
