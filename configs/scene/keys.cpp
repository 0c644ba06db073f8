#include "configs/scene/keys.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "configs/errors/nearest_name.hpp"
#include "configs/scene/fields/lists.hpp"

namespace wade {

namespace {

class Declaring : public Fields {
 public:
    Declaring(KeyNode& node, const std::string& skipped) : Fields(skipped), node_(&node) {}

 private:
    void visit(const Key& key, const Member& member) override {
        KeyNode& node = node_->inside.emplace_back(KeyNode{key, member.get(), {}});
        if (key.kind != KeyKind::spread) return;
        Key limit{"min", KeyKind::number, "Smallest value.", key.unit, key.range, {}, {}, required, key.storage};
        node.inside.push_back({limit, {}, {}});
        limit.name = "max";
        limit.meaning = "Largest value, at least min.";
        node.inside.push_back({limit, {}, {}});
        const Presence uniform = otherwise("values are uniform");
        node.inside.push_back({{"mean",
                                KeyKind::number,
                                "Of the normal values before those beyond min and max are left out.",
                                key.unit,
                                key.range,
                                {},
                                {},
                                uniform,
                                key.storage},
                               {},
                               {}});
        node.inside.push_back({{"sd",
                                KeyKind::number,
                                "Standard deviation of the normal values.",
                                key.unit,
                                above(0).to(1e5),
                                {},
                                {},
                                uniform,
                                key.storage},
                               {},
                               {}});
    }
    void visit_object(const Key& key, const std::function<void()>& inside) override {
        KeyNode* const outer = node_;
        node_ = &outer->inside.emplace_back(KeyNode{key, {}, {}});
        inside();
        node_ = outer;
    }
    void visit_optional(const Key& key, const OptionalMember& member) override { visit_object(key, member.visit_new); }
    void visit_list(const Key& key, const ListMember& member) override { visit_object(key, member.visit_new); }

    KeyNode* node_;
};

// A value as errors show it; long ones are cut.
std::string shown(const Json& value) {
    constexpr std::size_t longest = 60;
    std::string text = value.dump({.sorted = true, .lossy_text = true});
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    return text;
}

bool is_whole(const Json& value) {
    if (value.is_number_integer()) return true;
    constexpr double exact_up_to = 9007199254740992.0;  // 2^53: above, a double no longer holds every whole number
    return value.is_number_float() && std::trunc(value.get<double>()) == value.get<double>() &&
           std::abs(value.get<double>()) <= exact_up_to;
}

bool has_type(const Json& value, KeyKind kind) {
    switch (kind) {
        case KeyKind::number:
            return value.is_number();
        case KeyKind::whole:
            return is_whole(value);
        case KeyKind::flag:
            return value.is_boolean();
        case KeyKind::text:
        case KeyKind::choice:
            return value.is_string();
        case KeyKind::spread:
            return value.is_number() || value.is_object();
        case KeyKind::estimate:
            return value.is_number() || value.is_array() || value.is_string();
        case KeyKind::object:
            return value.is_object();
        case KeyKind::points:
        case KeyKind::list:
            return value.is_array();
    }
    return false;
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
    return allowed.empty() || std::all_of(text.begin(), text.end(), is_allowed);
}

std::string location(const std::string& source, const std::string& pointer) {
    return source + ": " + (pointer.empty() ? "the scene" : pointer);
}

// As a document would write it: 5, 0.5, 1e+06.
std::string number_text(double value) {
    const bool whole = std::trunc(value) == value && std::abs(value) < 1e15;
    return whole ? Json(static_cast<std::int64_t>(value)).dump() : Json(value).dump();
}

std::string fault_of_point(const Json& point, const Key& key) {
    const bool has_size = point.is_array() && point.size() == key.point_size;
    if (!has_size || !std::all_of(point.begin(), point.end(), [](const Json& v) { return v.is_number(); })) {
        return shown(point) + " is not a point; allowed: " + (key.point_size == 2 ? "[x, z]" : "[x, y, z]") +
               ", numbers.";
    }
    for (const Json& number : point) {
        if (!key.range.contains(number.get<double>()))
            return shown(number) + " is out of range; allowed: " + allowed_values(key) + ".";
    }
    return "";
}

// [low, best, high].
std::string fault_of_estimate(const Json& limits, const Key& key) {
    const auto is_allowed = [&](const Json& v) { return v.is_number() && key.range.contains(v.get<double>()); };
    const bool are_allowed = limits.size() == 3 && std::all_of(limits.begin(), limits.end(), is_allowed);
    const auto number = [&](std::size_t i) { return limits[i].get<double>(); };
    if (are_allowed && number(0) <= number(1) && number(1) <= number(2)) return "";
    return shown(limits) + " is not allowed; allowed: [low, best, high], low <= best <= high, each " +
           allowed_values(key) + ".";
}

// What is wrong with a value of the right type; empty if nothing is.
std::string fault_of(const Json& value, const Key& key) {
    if (key.kind == KeyKind::estimate && value.is_array()) return fault_of_estimate(value, key);
    if (key.kind == KeyKind::choice || (key.kind == KeyKind::estimate && value.is_string())) {
        const auto text = value.get<std::string>();
        if (std::find(key.choices.begin(), key.choices.end(), text) != key.choices.end()) return "";
        return shown(value) + " is not allowed; allowed: " + allowed_values(key) + "; the nearest is \"" +
               nearest_name(text, key.choices) + "\".";
    }
    if (key.kind == KeyKind::text) {
        const auto text = value.get<std::string>();
        const TextRule& rule = key.text;
        if (rule.shortest <= text.size() && text.size() <= rule.longest && consists_of(text, rule.characters))
            return "";
        return shown(value) + " is not allowed; allowed: " + allowed_values(key) + ".";
    }
    if (key.kind == KeyKind::points) {
        for (std::size_t i = 0; i < value.size(); ++i) {
            if (const std::string fault = fault_of_point(value[i], key); !fault.empty())
                return "point " + std::to_string(i) + ": " + fault;
        }
        return "";
    }
    if (!value.is_number() || key.range.contains(value.get<double>())) return "";
    return shown(value) + " is out of range; allowed: " + allowed_values(key) + ".";
}

}  // namespace

const KeyNode* KeyNode::find(std::string_view name) const {
    const auto found = std::find_if(inside.begin(), inside.end(), [&](const KeyNode& n) { return n.key.name == name; });
    return found == inside.end() ? nullptr : &*found;
}

KeyNode declared_keys(const FieldList& list, const std::string& skipped) {
    KeyNode root;
    root.key.kind = KeyKind::object;
    Declaring declaring(root, skipped);
    list(declaring);
    return root;
}

const KeyNode& scene_keys() {
    static const KeyNode keys = declared_keys([scene = Scene()](Fields& f) mutable { fields(scene, f); });
    return keys;
}

std::string type_words(const Key& key) {
    switch (key.kind) {
        case KeyKind::number:
            return "a number";
        case KeyKind::whole:
            return "a whole number";
        case KeyKind::flag:
            return "true or false";
        case KeyKind::text:
        case KeyKind::choice:
            return "a string";
        case KeyKind::spread:
            return R"(a number or an object {"min": ..., "max": ...})";
        case KeyKind::estimate:
            return "a number, an array [low, best, high] or \"" + key.choices.at(0) + "\"";
        case KeyKind::points:
            return key.point_size == 2 ? "an array of points [x, z]" : "an array of points [x, y, z]";
        case KeyKind::object:
            return "an object";
        case KeyKind::list:
            return "an array";
    }
    return "";
}

std::string allowed_values(const Key& key) {
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : " and ") + part; };
    switch (key.kind) {
        case KeyKind::choice:
            for (const std::string& name : key.choices) text += (text.empty() ? "\"" : ", \"") + name + "\"";
            return text;
        case KeyKind::flag:
            return "any boolean";
        case KeyKind::object:
            return "any object";
        case KeyKind::list:
            return "any array";
        case KeyKind::text:
            if (key.text.shortest > 0) add("at least " + std::to_string(key.text.shortest) + " characters");
            if (key.text.longest != std::string::npos)
                add("at most " + std::to_string(key.text.longest) + " characters");
            if (!key.text.characters.empty()) add("only characters of [" + std::string(key.text.characters) + "]");
            return text.empty() ? "any string" : text;
        case KeyKind::number:
        case KeyKind::whole:
        case KeyKind::spread:
        case KeyKind::estimate:
        case KeyKind::points:
            break;
    }
    if (std::isfinite(key.range.lo)) add((key.range.without_lo ? "> " : ">= ") + number_text(key.range.lo));
    if (std::isfinite(key.range.hi)) add((key.range.without_hi ? "< " : "<= ") + number_text(key.range.hi));
    if (text.empty()) return key.kind == KeyKind::whole ? "any integer" : "any number";
    return key.unit.empty() ? text : text + " " + std::string(key.unit);
}

void note_unknown_key(const Json& present, const KeyNode& node, const std::string& key, const std::string& pointer,
                      const Reading& reading) {
    if (reading.problems.is_full()) return reading.problems.note(pointer_to(pointer, key));
    reading.problems.note(reading.source + ": " + pointer_to(pointer, key) + ": unknown key " + shown(Json(key)) +
                          "; " + nearest_key(present, node, key, reading.keys) + ".");
}

void note_missing_key(const KeyNode& node, const std::string& pointer, const Reading& reading) {
    const Key& key = node.key;
    reading.problems.note(reading.source + ": " + pointer_to(pointer, std::string(key.name)) + ": required key \"" +
                          std::string(key.name) + "\" is missing (" + type_words(key) +
                          "; allowed: " + allowed_values(key) + "). " + std::string(key.meaning));
}

void check_keys(const Json& value, const KeyNode& node, const std::string& pointer, const Reading& reading) {
    const Key& key = node.key;
    if (!has_type(value, key.kind)) {
        reading.problems.note(location(reading.source, pointer) + ": " + fault_of_value(value, key));
    } else if (value.is_object()) {
        for (const JsonMember* const item : value.sorted_items()) {
            const auto& [name, member] = *item;
            if (const KeyNode* const inner = node.find(name)) {
                check_keys(member, *inner, pointer_to(pointer, name), reading);
            } else {
                note_unknown_key(value, node, name, pointer, reading);
            }
        }
    } else if (value.is_array() && key.kind == KeyKind::list) {
        const KeyNode element = element_of(node);
        for (std::size_t i = 0; i < value.size(); ++i) {
            check_keys(value[i], element, pointer_to(pointer, std::to_string(i)), reading);
        }
    } else if (const std::string fault = fault_of(value, key); !fault.empty()) {
        reading.problems.note(location(reading.source, pointer) + ": " + fault);
    }
}

std::string fault_of_value(const Json& value, const Key& key) {
    if (has_type(value, key.kind)) return fault_of(value, key);
    return "expected " + type_words(key) + ", found " + shown(value) + " (" + value.type_name() + ").";
}

std::string fault_in_file(const Json& value, const Key& key) {
    const std::string fault = fault_of_value(value, key);
    const bool is_number = key.kind == KeyKind::number || key.kind == KeyKind::whole;
    if (fault.empty() || !is_number || !value.is_string()) return fault;
    return fault + " Remedy: the number alone, " + (key.unit.empty() ? "" : "in " + std::string(key.unit) + ", ") +
           "with a decimal point, without quotes and unit; allowed: " + allowed_values(key) + ".";
}

Json value_of_cell(const std::string& cell, const Key& key) {
    if (key.kind == KeyKind::text || key.kind == KeyKind::choice) return cell;
    if (cell == "true" || cell == "false") return cell == "true";
    double number = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    const bool is_number = error == std::errc() && end == cell.data() + cell.size() && std::isfinite(number);
    if (!is_number) return cell;
    const bool is_whole_number = std::trunc(number) == number && std::abs(number) < 1e15;
    return is_whole_number ? Json(static_cast<std::int64_t>(number)) : Json(number);
}

KeyValue key_value(const Json& value, const Key& key) {
    switch (key.kind) {
        case KeyKind::number:
            return value.get<double>() + 0.0;
        case KeyKind::whole:
            return value.is_number_float() ? static_cast<std::int64_t>(value.get<double>()) : value.get<std::int64_t>();
        case KeyKind::flag:
            return value.get<bool>();
        case KeyKind::text:
        case KeyKind::choice:
            return value.get<std::string>();
        case KeyKind::spread:
            if (value.is_number()) return Spread(value.get<double>() + 0.0);
            if (!value.contains("sd") || !value.contains("mean")) {
                return Spread(value.at("min").get<double>() + 0.0, value.at("max").get<double>() + 0.0);
            }
            return Spread(value.at("min").get<double>() + 0.0, value.at("max").get<double>() + 0.0,
                          value.at("mean").get<double>() + 0.0, value.at("sd").get<double>());
        case KeyKind::estimate: {
            if (value.is_string()) return value.get<std::string>();
            if (value.is_number()) return value.get<double>() + 0.0;
            PointList list{1, {}};
            for (const Json& number : value) list.numbers.push_back(number.get<double>() + 0.0);
            return list;
        }
        case KeyKind::points: {
            PointList list{key.point_size, {}};
            for (const Json& point : value)
                for (const Json& number : point) list.numbers.push_back(number.get<double>() + 0.0);
            return list;
        }
        case KeyKind::object:
        case KeyKind::list:
            break;
    }
    return {};
}

Json json_of(const KeyValue& value) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return *whole;
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* spread = std::get_if<Spread>(&value)) {
        if (spread->lo == spread->hi) return spread->lo;
        if (spread->sd > 0) {
            return {{"min", spread->lo}, {"max", spread->hi}, {"mean", spread->mean}, {"sd", spread->sd}};
        }
        return {{"min", spread->lo}, {"max", spread->hi}};
    }
    if (const auto* points = std::get_if<PointList>(&value)) {
        Json list = Json::array();
        if (points->size == 1) {
            for (const double number : points->numbers) list.push_back(number);
            return list;
        }
        for (std::size_t i = 0; i + points->size <= points->numbers.size(); i += points->size) {
            list.push_back(Json::array());
            for (std::size_t k = 0; k < points->size; ++k) list.back().push_back(points->numbers[i + k]);
        }
        return list;
    }
    return nullptr;
}

}  // namespace wade
