#pragma once
// A node of the tree of keys, and the pointer to it.

#include <string>
#include <string_view>
#include <vector>

#include "configs/scene/fields.hpp"

namespace wade {

// A key with its child keys: of an object, of the objects of a list, or "min" and "max" of a spread.
struct KeyNode {
    Key key;
    KeyValue preset;  // of a new struct
    std::vector<KeyNode> inside;

    [[nodiscard]] const KeyNode* find(std::string_view name) const;
};

// The declaration of an element of a list: a nameless object with its keys.
[[nodiscard]] inline KeyNode element_of(const KeyNode& list) {
    KeyNode element;
    element.key.kind = KeyKind::object;
    element.inside = list.inside;
    return element;
}

// `pointer` extended by one key, escaped as RFC 6901 demands.
[[nodiscard]] inline std::string pointer_to(const std::string& pointer, const std::string& key) {
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

}  // namespace wade
