#include "configs/scene/scene_schema.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/errors/nearest_name.hpp"

namespace wade {

namespace {

using nlohmann::json;

// A value as errors show it; long ones are cut.
std::string shown(const json& value) {
    constexpr std::size_t longest = 60;
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    return text;
}

std::string with_article(const std::string& type) {
    if (type == "integer") return "a whole number";
    if (type == "boolean") return "true or false";
    return (type == "array" || type == "object" ? "an " : "a ") + type;
}

bool is_whole(const json& value) {
    if (value.is_number_integer()) return true;
    constexpr double exact_up_to = 9007199254740992.0;  // 2^53: above, a double no longer holds every whole number
    return value.is_number_float() && std::trunc(value.get<double>()) == value.get<double>() &&
           std::abs(value.get<double>()) <= exact_up_to;
}

bool has_type(const json& value, const std::string& type) {
    if (type == "integer") return is_whole(value);
    if (type == "number") return value.is_number();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "array") return value.is_array();
    return value.is_object();
}

std::string types_with_article(const json& type) {
    if (type.is_string()) return with_article(type.get<std::string>());
    std::string text;
    for (const json& one : type) text += (text.empty() ? "" : " or ") + with_article(one.get<std::string>());
    return text;
}

std::string location(const std::string& source, const std::string& pointer) {
    return source + ": " + (pointer.empty() ? "the scene" : pointer);
}

bool in_range(const json& value, const json& schema) {
    const double number = value.get<double>();
    return !((schema.contains("minimum") && number < schema["minimum"].get<double>()) ||
             (schema.contains("maximum") && number > schema["maximum"].get<double>()) ||
             (schema.contains("exclusiveMinimum") && number <= schema["exclusiveMinimum"].get<double>()) ||
             (schema.contains("exclusiveMaximum") && number >= schema["exclusiveMaximum"].get<double>()));
}

// The characters of a pattern of the one form that the schema uses, "^[...]+$": single ones and ranges like a-z,
// without escapes; a '-' at the end stands for itself.
std::string_view character_class(const json& schema) {
    const std::string_view pattern = schema["pattern"].get_ref<const std::string&>();
    if (pattern.size() < 6 || !pattern.starts_with("^[") || !pattern.ends_with("]+$")) {
        throw std::logic_error("a pattern of the schema is not of the form ^[...]+$: " + std::string(pattern));
    }
    return pattern.substr(2, pattern.size() - 5);
}

bool consists_of(const std::string& text, std::string_view allowed) {
    const auto is_allowed = [allowed](char c) {
        for (std::size_t i = 0; i < allowed.size(); ++i) {
            const bool range = i + 2 < allowed.size() && allowed[i + 1] == '-';
            if (range ? allowed[i] <= c && c <= allowed[i + 2] : allowed[i] == c) return true;
            if (range) i += 2;
        }
        return false;
    };
    return std::all_of(text.begin(), text.end(), is_allowed);
}

void check_string(const json& value, const json& schema, const std::string& pointer, const std::string& source) {
    const auto& text = value.get_ref<const std::string&>();
    if (schema.contains("enum")) {
        std::vector<std::string> names;
        for (const json& name : schema["enum"]) names.push_back(name.get<std::string>());
        for (const std::string& name : names) {
            if (name == text) return;
        }
        throw ConfigurationError(location(source, pointer) + ": " + shown(value) + " is not allowed; allowed: " +
                                 allowed_values(schema) + "; the nearest is \"" + nearest_name(text, names) + "\".");
    }
    const bool right_length = text.size() >= schema.value("minLength", std::size_t{0}) &&
                              text.size() <= schema.value("maxLength", std::string::npos);
    if (!right_length || (schema.contains("pattern") && !consists_of(text, character_class(schema)))) {
        throw ConfigurationError(location(source, pointer) + ": " + shown(value) +
                                 " is not allowed; allowed: " + allowed_values(schema) + ".");
    }
}

// What a file must have that extends no other one, the schema's "else", every merged scene must have.
json schema_of_merged_scenes() {
    json schema = json::parse(scene_schema_text());
    schema.merge_patch(json(schema["else"]));
    schema.erase("if");
    schema.erase("else");
    return schema;
}

}  // namespace

const json& scene_schema() {
    static const json schema = schema_of_merged_scenes();
    return schema;
}

std::string type_for(const json& value, const json& schema) {
    const json& type = schema["type"];
    if (type.is_string()) return type.get<std::string>();
    for (const json& one : type) {
        if (has_type(value, one.get<std::string>())) return one.get<std::string>();
    }
    return type.front().get<std::string>();
}

std::string pointer_to(const std::string& pointer, const std::string& key) {
    std::string escaped = pointer + "/";
    for (const char c : key) {
        if (c == '~') {
            escaped += "~0";
        } else if (c == '/') {
            escaped += "~1";
        } else {
            escaped += c;
        }
    }
    return escaped;
}

std::string allowed_values(const json& schema) {
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : " and ") + part; };
    if (schema.contains("enum")) {
        for (const json& name : schema["enum"]) text += (text.empty() ? "" : ", ") + name.dump();
        return text;
    }
    if (schema.contains("exclusiveMinimum")) add("> " + schema["exclusiveMinimum"].dump());
    if (schema.contains("minimum")) add(">= " + schema["minimum"].dump());
    if (schema.contains("exclusiveMaximum")) add("< " + schema["exclusiveMaximum"].dump());
    if (schema.contains("maximum")) add("<= " + schema["maximum"].dump());
    if (schema.contains("minLength")) add("at least " + schema["minLength"].dump() + " characters");
    if (schema.contains("maxLength")) add("at most " + schema["maxLength"].dump() + " characters");
    if (schema.contains("pattern")) add("only characters of [" + std::string(character_class(schema)) + "]");
    if (text.empty()) return "any " + schema["type"].get<std::string>();
    if (schema.contains("x-unit")) text += " " + schema["x-unit"].get<std::string>();
    return text;
}

void throw_unknown_key(const json& object_schema, const std::string& key, const std::string& pointer,
                       const std::string& source) {
    std::vector<std::string> known;
    for (const auto& [name, unused] : object_schema["properties"].items()) known.push_back(name);
    throw ConfigurationError(source + ": " + pointer_to(pointer, key) + ": unknown key " + shown(json(key)) +
                             "; the nearest known key is \"" + nearest_name(key, known) + "\".");
}

void check_against_schema(const json& value, const json& schema, const std::string& pointer,
                          const std::string& source) {
    const std::string type = type_for(value, schema);
    if (!has_type(value, type)) {
        throw ConfigurationError(location(source, pointer) + ": expected " + types_with_article(schema["type"]) +
                                 ", found " + shown(value) + " (" + value.type_name() + ").");
    }
    if (type == "object") {
        for (const auto& [key, member] : value.items()) {
            if (!schema["properties"].contains(key)) throw_unknown_key(schema, key, pointer, source);
            check_against_schema(member, schema["properties"][key], pointer_to(pointer, key), source);
        }
    } else if (type == "array") {
        for (std::size_t i = 0; i < value.size(); ++i) {
            check_against_schema(value[i], schema["items"], pointer_to(pointer, std::to_string(i)), source);
        }
    } else if (type == "string") {
        check_string(value, schema, pointer, source);
    } else if (type != "boolean" && !in_range(value, schema)) {
        throw ConfigurationError(location(source, pointer) + ": " + shown(value) +
                                 " is out of range; allowed: " + allowed_values(schema) + ".");
    }
}

void complete_with_defaults(json& value, const json& schema, const std::string& pointer, const std::string& source) {
    const std::string type = type_for(value, schema);
    if (type == "object") {
        for (const json& key : schema.value("required", json::array())) {
            const auto name = key.get<std::string>();
            if (value.contains(name)) continue;
            const json& missing = schema["properties"][name];
            throw ConfigurationError(source + ": " + pointer_to(pointer, name) + ": required key \"" + name +
                                     "\" is missing (" + types_with_article(missing["type"]) + "; allowed: " +
                                     allowed_values(missing) + "). " + missing["description"].get<std::string>());
        }
        for (const auto& [key, member_schema] : schema["properties"].items()) {
            if (!value.contains(key)) {
                if (member_schema.contains("default")) {
                    value[key] = member_schema["default"];
                } else if (member_schema["type"] == "object") {
                    value[key] = json::object();
                } else {
                    continue;
                }
            }
            complete_with_defaults(value[key], member_schema, pointer_to(pointer, key), source);
        }
    } else if (type == "array") {
        for (std::size_t i = 0; i < value.size(); ++i) {
            complete_with_defaults(value[i], schema["items"], pointer_to(pointer, std::to_string(i)), source);
        }
    } else if (type == "number") {
        value = value.get<double>() + 0.0;  // + 0.0 turns -0 into 0, so that equal scenes have equal texts
    } else if (type == "integer" && value.is_number_float()) {
        value = static_cast<std::int64_t>(value.get<double>());
    }
}

}  // namespace wade
