// Which key may have been meant by one that is not known.

#include <algorithm>
#include <limits>
#include <sstream>
#include <vector>

#include "configs/errors/nearest_name.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

// Whether all words of `name` are words of `key`, in their order: "length" and "x_m" are in "length_m" and "x_min_m".
bool words_are_in(const std::string& name, std::string_view key) {
    std::istringstream words(name), of_key{std::string(key)};
    std::string word, other;
    while (std::getline(words, word, '_')) {
        do {
            if (!std::getline(of_key, other, '_')) return false;
        } while (other != word);
    }
    return true;
}

// 0: equal; 1: words are missing, such as the unit, or one character differs.
std::size_t distance(const std::string& name, std::string_view key) {
    if (name == key) return 0;
    return words_are_in(name, key) ? 1 : edit_distance(name, key);
}

struct Found {
    std::size_t distance = std::numeric_limits<std::size_t>::max();
    std::vector<std::string> pointers;
};

void search(const KeyNode& node, const std::string& pointer, const std::string& name, Found& found) {
    for (const KeyNode& inner : node.inside) {
        const std::size_t its = distance(name, inner.key.name);
        const std::string here = pointer_to(pointer, std::string(inner.key.name));
        if (its < found.distance) found = {its, {}};
        if (its == found.distance) found.pointers.push_back(here);
        // "min" and "max" of a spread are of no use by themselves.
        if (inner.key.kind == KeyKind::object) search(inner, here, name, found);
        if (inner.key.kind == KeyKind::list) search(inner, here + "/0", name, found);
    }
}

std::string words(Found found) {
    constexpr std::size_t most = 3;
    const auto depth = [](const std::string& pointer) { return std::count(pointer.begin(), pointer.end(), '/'); };
    std::stable_sort(found.pointers.begin(), found.pointers.end(),
                     [&](const std::string& a, const std::string& b) { return depth(a) < depth(b); });
    std::string text = "the nearest known key is " + found.pointers.front();
    for (std::size_t i = 1; i < std::min(most, found.pointers.size()); ++i) {
        text += (i == 1 ? "; also " : ", ") + found.pointers[i];
    }
    return text;
}

}  // namespace

std::string nearest_key(const Json& present, const KeyNode& node, const std::string& whole_name, const KeyNode& all) {
    const std::string name = whole_name.substr(0, 100);  // longer than any key, so that the distances cost little
    std::string here;
    std::size_t nearest = std::numeric_limits<std::size_t>::max();
    bool is_set = true;
    for (const KeyNode& inner : node.inside) {
        const std::string key(inner.key.name);
        const std::size_t its = distance(name, key);
        const bool its_set = present.contains(key);
        if (its > nearest || (its == nearest && (its_set || !is_set))) continue;
        nearest = its;
        is_set = its_set;
        here = key;
    }
    if (nearest > 1) {
        Found elsewhere;
        search(all, "", name, elsewhere);
        const bool near_here = nearest <= name.size() / 3;
        const bool near_there = elsewhere.distance <= std::max<std::size_t>(1, name.size() / 4);
        if (elsewhere.distance == 0 || (!near_here && near_there)) return words(elsewhere);
    }
    return "the nearest known key is \"" + here + "\"";
}

}  // namespace wade
