#pragma once
// The keys of a scene as a tree: what the lists of fields declare, to check documents and to speak of keys in messages.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "configs/errors/problems.hpp"
#include "configs/json/json.hpp"
#include "configs/scene/fields.hpp"
#include "configs/scene/key_node.hpp"

namespace wade {

// A list of fields of any struct, such as [&](Fields& f) { fields(scene, f); }.
using FieldList = std::function<void(Fields&)>;

// What a list declares for a new struct, as a nameless object. `skipped`: see Fields.
[[nodiscard]] KeyNode declared_keys(const FieldList& list, const std::string& skipped = "");

// The keys of a scene.
[[nodiscard]] const KeyNode& scene_keys();

// Where a document comes from and where its mistakes go.
struct Reading {
    std::string source;  // named in messages: the file or the option
    Problems& problems;
    const KeyNode& keys = scene_keys();  // all of them, for names that belong elsewhere
};

// Notes all unknown keys, wrong types and values out of range of `value`, which is at `pointer` and is to be as `node`
// says. Required keys may be missing: a file that another extends, or that extends another, is only a part of a scene.
void check_keys(const Json& value, const KeyNode& node, const std::string& pointer, const Reading& reading);

// Returns what is wrong with the type or the value of a key that is no object and no list; empty if nothing is.
[[nodiscard]] std::string fault_of_value(const Json& value, const Key& key);

// Returns the same for a value of a foreign file: a table (csv) or a property of GeoJSON. For a text instead of a
// number it adds the remedy.
[[nodiscard]] std::string fault_in_file(const Json& value, const Key& key);

// Returns a cell of a table as the value that it would be in a scene, for fault_in_file.
[[nodiscard]] Json value_of_cell(const std::string& cell, const Key& key);

// Notes that `key` is not known in the object at `pointer`, and what may have been meant: a key of this object, first
// those that `present` has not set, or else one that stands elsewhere.
void note_unknown_key(const Json& present, const KeyNode& node, const std::string& key, const std::string& pointer,
                      const Reading& reading);

// Returns "the nearest known key is "z_m"", for `name` in the object `present` with the keys of `node`. If no key here
// is near, it returns full pointers of matching keys elsewhere in `all` (key_names.cpp):
//   here       a name that differs by a third of its characters or lacks words; of equals one that is not set yet
//   elsewhere  the same name, or one that differs by a quarter of it; up to three pointers, the least deep first
[[nodiscard]] std::string nearest_key(const Json& present, const KeyNode& node, const std::string& name,
                                      const KeyNode& all);

// Notes that the key at `pointer` is required and missing.
void note_missing_key(const KeyNode& node, const std::string& pointer, const Reading& reading);

// The allowed values as words with unit, for example "> 0 and <= 2 s".
[[nodiscard]] std::string allowed_values(const Key& key);

// What a value must be, with its article: "a number or an object {"min": ..., "max": ...}".
[[nodiscard]] std::string type_words(const Key& key);

// Returns a JSON value as a value of the key; it must have the key's type. -0 becomes 0, so that equal scenes have
// equal texts.
[[nodiscard]] KeyValue key_value(const Json& value, const Key& key);

// The value as JSON; null: none.
[[nodiscard]] Json json_of(const KeyValue& value);

}  // namespace wade
