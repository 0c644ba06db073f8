#include "configs/scene/scene_documents.hpp"

#include <cmath>

namespace wade {

namespace {

// 5 for 5.0, as people write it.
Json number(double value) {
    const bool whole = std::trunc(value) == value && std::abs(value) < 1e15 * 10;
    return whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

Json preset_of(const KeyNode& node) {
    if (node.key.kind == KeyKind::list) return Json::array();
    if (const auto* value = std::get_if<double>(&node.preset)) return number(*value);
    if (const auto* spread = std::get_if<Spread>(&node.preset)) return number(spread->lo);
    return json_of(node.preset);
}

bool is_required(const KeyNode& node) {
    return node.key.presence.rule == Presence::Rule::required && node.key.presence.unless.empty();
}

Json names_of_required(const KeyNode& node) {
    Json names = Json::array();
    for (const KeyNode& inner : node.inside) {
        if (is_required(inner)) names.push_back(inner.key.name);
    }
    return names;
}

const char* type_of(KeyKind kind) {
    switch (kind) {
        case KeyKind::number:
        case KeyKind::spread:
        case KeyKind::estimate:
            return "number";
        case KeyKind::whole:
            return "integer";
        case KeyKind::flag:
            return "boolean";
        case KeyKind::text:
        case KeyKind::choice:
            return "string";
        case KeyKind::object:
            return "object";
        case KeyKind::points:
        case KeyKind::list:
            return "array";
    }
    return "";
}

// The meaning of a key, and where it acts if the object around it acts elsewhere, too: under `known` conditions.
std::string meaning_of(const Key& key, std::size_t known) {
    std::string text(key.meaning);
    for (std::size_t k = known; k < key.acting.size(); ++k)
        text.append(" Acts only ").append(key.acting[k].words) += '.';
    return text;
}

Json schema_of(const KeyNode& node, bool whole, std::size_t known);

// `whole`: the object is never merged with another, so that it must have what is required.
void add_properties(Json& schema, const KeyNode& node, bool whole) {
    schema["additionalProperties"] = false;
    if (const Json names = names_of_required(node); whole && !names.empty()) schema["required"] = names;
    Json& properties = schema["properties"] = Json::object();
    for (const KeyNode& inner : node.inside) {
        properties[std::string(inner.key.name)] = schema_of(inner, whole, node.key.acting.size());
    }
}

void add_limits(Json& schema, const Key& key) {
    if (!key.unit.empty()) schema["x-unit"] = key.unit;
    if (key.kind == KeyKind::points) {
        Key number = key;
        number.kind = KeyKind::number;
        number.unit = {};
        Json& point = schema["items"] = {{"type", "array"}};
        add_limits(point["items"] = {{"type", "number"}}, number);
        point["maxItems"] = key.point_size;
        point["minItems"] = key.point_size;
        return;
    }
    if (key.kind == KeyKind::estimate) {
        Key number = key;
        number.kind = KeyKind::number;
        number.unit = {};
        add_limits(schema["items"] = {{"type", "number"}}, number);
        schema["maxItems"] = 3;
        schema["minItems"] = 3;
        schema["pattern"] = "^" + key.choices.at(0) + "$";
    }
    if (key.kind == KeyKind::choice) schema["enum"] = key.choices;
    if (std::isfinite(key.range.lo))
        schema[key.range.without_lo ? "exclusiveMinimum" : "minimum"] = number(key.range.lo);
    if (std::isfinite(key.range.hi))
        schema[key.range.without_hi ? "exclusiveMaximum" : "maximum"] = number(key.range.hi);
    if (key.text.shortest > 0) schema["minLength"] = key.text.shortest;
    if (key.text.longest != std::string::npos) schema["maxLength"] = key.text.longest;
    if (!key.text.characters.empty())
        schema["pattern"] = std::string("^[").append(key.text.characters).append(key.text.shortest > 0 ? "]+$" : "]*$");
}

Json schema_of(const KeyNode& node, bool whole, std::size_t known) {
    const Key& key = node.key;
    Json schema;
    if (key.kind == KeyKind::spread) {
        schema["type"] = {"number", "object"};
    } else if (key.kind == KeyKind::estimate) {
        schema["type"] = {"number", "array", "string"};
    } else {
        schema["type"] = type_of(key.kind);
    }
    add_limits(schema, key);
    const Presence& presence = key.presence;
    if (presence.rule == Presence::Rule::preset && key.kind != KeyKind::object) schema["default"] = preset_of(node);
    if (!presence.words.empty()) schema["x-default"] = presence.words;
    schema["description"] = meaning_of(key, known);
    if (key.kind == KeyKind::list) {
        Json& items = schema["items"] = {{"type", "object"}};
        add_properties(items, node, true);
    } else if (key.kind == KeyKind::object) {
        add_properties(schema, node, whole);
    } else if (key.kind == KeyKind::spread) {
        add_properties(schema, node, true);
    }
    return schema;
}

// Returns the schema of the keys that a whole scene must set in this object and in the objects below it.
Json required_of_whole(const KeyNode& node) {
    Json schema = Json::object();
    for (const KeyNode& inner : node.inside) {
        const Presence& presence = inner.key.presence;
        if (presence.unless.empty()) continue;
        schema["anyOf"] = {Json{{"required", {inner.key.name}}}, Json{{"required", {presence.unless}}}};
    }
    if (const Json names = names_of_required(node); !names.empty()) schema["required"] = names;
    for (const KeyNode& inner : node.inside) {
        if (inner.key.kind != KeyKind::object) continue;
        const Json its = required_of_whole(inner);
        if (!its.empty()) schema["properties"][std::string(inner.key.name)] = its;
    }
    return schema;
}

std::string code(const std::string& text) {
    return std::string("`").append(text).append("`");
}

std::string interval(const Range& range) {
    const auto limit = [](double v) { return std::isfinite(v) ? number(v).dump() : v < 0 ? "-inf" : "inf"; };
    std::string text = range.without_lo ? "(" : "[";
    return text.append(limit(range.lo)).append(", ").append(limit(range.hi)).append(range.without_hi ? ")" : "]");
}

std::string range_of(const Key& key) {
    std::string words;
    switch (key.kind) {
        case KeyKind::choice:
            for (const std::string& name : key.choices) words += (words.empty() ? "" : ", ") + code(name);
            return words;
        case KeyKind::number:
            return interval(key.range);
        case KeyKind::spread:
            return interval(key.range) + ", or `min` and `max`, or these with `mean` and `sd`";
        case KeyKind::estimate:
            return interval(key.range) + ", `[low, best, high]` or " + code(key.choices.at(0));
        case KeyKind::whole:
            return "whole, " + interval(key.range);
        case KeyKind::flag:
            return "`true`, `false`";
        case KeyKind::text:
            return "text";
        case KeyKind::points:
            return std::string(key.point_size == 2 ? "`[[x, z], ...]`, " : "`[[x, y, z], ...]`, ") +
                   interval(key.range);
        case KeyKind::list:
            return "list";
        case KeyKind::object:
            return "object";
    }
    return "";
}

std::string default_of(const KeyNode& node) {
    if (is_required(node)) return "**required**";
    if (!node.key.presence.unless.empty()) return "**required**, or " + code(std::string(node.key.presence.unless));
    const std::string words(node.key.presence.words);
    if (node.key.presence.rule == Presence::Rule::otherwise) return words;
    if (node.key.kind == KeyKind::object) return "";
    return words.empty() ? code(preset_of(node).dump()) : code(preset_of(node).dump()) + "; " + words;
}

std::string cell(std::string_view text) {
    std::string escaped(" ");
    for (const char c : text) {
        if (c == '|') escaped += '\\';
        escaped += c;
    }
    return escaped.append(" |");
}

void add_rows(std::string& table, const KeyNode& node, const std::string& before) {
    for (const KeyNode& inner : node.inside) {
        const Key& key = inner.key;
        const std::string name = before + std::string(key.name);
        table += "|";
        table += cell(code(name)) + cell(key.unit) + cell(range_of(key)) + cell(default_of(inner)) +
                 cell(meaning_of(key, node.key.acting.size())) + "\n";
        if (key.kind == KeyKind::object) add_rows(table, inner, name + ".");
        if (key.kind == KeyKind::list) add_rows(table, inner, name + "[].");
    }
}

}  // namespace

std::string schema_text(const KeyNode& keys) {
    Json schema;
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
    schema["title"] = "Wade scene";
    schema["description"] =
        "All that describes a run. x runs along the stream's axis, z across it, y up; the bed is y = 0; the stream "
        "flows "
        "towards -x.";
    schema["type"] = "object";
    schema["if"] = {{"required", {"extends"}}};
    schema["else"] = required_of_whole(keys);
    add_properties(schema, keys, false);
    return schema.dump({.indent = 2}) + "\n";
}

std::string keys_table(const KeyNode& keys) {
    std::string table = "| key | unit | range | default | meaning |\n|---|---|---|---|---|\n";
    add_rows(table, keys, "");
    return table;
}

std::vector<SceneDocument> scene_documents() {
    const std::string page =
        "# All keys of a scene\n\n"
        "Written from the lists in `configs/scene/fields`; how to write a scene: [scenes](scenes.md). Round brackets "
        "exclude "
        "the\nlimit, square brackets include it. `[]` marks the elements of a list. The JSON pointer of `fluid.cfl` is "
        "`/fluid/cfl`.\n\n";
    return {{"configs/scene.schema.json", schema_text(scene_keys())},
            {"docs/scene_keys.md", page + keys_table(scene_keys())}};
}

}  // namespace wade
