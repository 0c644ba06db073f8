#include "configs/scene/idle_keys.hpp"

#include <algorithm>
#include <utility>

#include "configs/scene/fields/lists.hpp"
#include "configs/scene/key_node.hpp"
#include "configs/scene/keys.hpp"

namespace wade {

namespace {

// Returns the key's first condition that does not hold; null if the key acts.
const Acting* missing_condition(const Key& key, const Scene& scene) {
    const auto found =
        std::find_if(key.acting.begin(), key.acting.end(), [&](const Acting& acting) { return !acting.here(scene); });
    return found == key.acting.end() ? nullptr : &*found;
}

// As people write it: 0 for 0.0.
std::string shown_default(const Json& value) {
    if (value.is_null()) return "none";
    std::string text = value.dump({.sorted = true});
    if (value.is_number_float() && text.ends_with(".0")) text.resize(text.size() - 2);
    return text;
}

// Visits the scene and its source document side by side.
class Finder : public Fields {
 public:
    Finder(const Json& document, const Scene& scene) : scene_(scene), here_(&document) {}

    std::vector<IdleKey> found;

 private:
    void visit(const Key& key, const Member& member) override {
        const std::string name(key.name);
        if (key.storage == Storage::file || !here_->contains(name)) return;
        const Json& value = (*here_)[name];
        const KeyValue as_read = key_value(value, key);
        if (key.storage == Storage::shorthand) member.set(as_read);  // no member of the scene holds it
        const Acting* const missing = missing_condition(key, scene_);
        if (missing == nullptr) return;
        const Json given = json_of(as_read), preset = json_of(node_->find(name)->preset);
        const Json derived = key.presence.derived ? json_of(key.presence.derived()) : Json();
        if (given != preset && given != derived)
            note(name, value.dump({.sorted = true, .lossy_text = true}), derived.is_null() ? preset : derived,
                 *missing);
    }

    void visit_object(const Key& key, const std::function<void()>& inside) override {
        const std::string name(key.name);
        if (here_->contains(name)) enter((*here_)[name], name, name, node_->find(name), inside);
    }

    void visit_optional(const Key& key, const OptionalMember& member) override {
        if (member.has()) visit_object(key, member.visit);
    }

    void visit_list(const Key& key, const ListMember& member) override {
        const std::string name(key.name);
        if (!here_->contains(name)) return;
        const Json& list = (*here_)[name];
        const Acting* const missing = missing_condition(key, scene_);
        if (missing != nullptr && !list.empty()) {
            note(name, "a list of " + std::to_string(list.size()), Json(), *missing);
            return;
        }
        const KeyNode* const node = node_->find(name);
        enter(list, name, name, node, [&] {
            for (std::size_t i = 0; i < list.size(); ++i) {
                enter(list[i], std::to_string(i), "*", node, [&] { member.visit(i); });
            }
        });
    }

    void enter(const Json& value, const std::string& name, const std::string& in_pattern, const KeyNode* node,
               const std::function<void()>& inside) {
        const Json* const outer = std::exchange(here_, &value);
        const KeyNode* const outer_node = std::exchange(node_, node);
        const std::string outer_pointer = std::exchange(pointer_, pointer_to(pointer_, name));
        const std::string outer_pattern = std::exchange(pattern_, pointer_to(pattern_, in_pattern));
        inside();
        here_ = outer;
        node_ = outer_node;
        pointer_ = outer_pointer;
        pattern_ = outer_pattern;
    }

    void note(const std::string& name, const std::string& value, const Json& preset, const Acting& missing) {
        const std::string pattern = pointer_to(pattern_, name);
        const auto same = std::find_if(found.begin(), found.end(), [&](const IdleKey& k) {
            return k.pattern == pattern && k.words == missing.words;
        });
        if (same != found.end()) {
            ++same->count;
            return;
        }
        found.push_back({pattern, pointer_to(pointer_, name), 1, value, shown_default(preset),
                         std::string(missing.words), missing.for_good});
    }

    const Scene& scene_;
    const Json* here_;  // the visited object, with its declaration and its position
    const KeyNode* node_ = &scene_keys();
    std::string pointer_, pattern_;
};

std::string with_count(const IdleKey& key) {
    return key.count == 1 ? key.pointer : key.pointer + " (and " + std::to_string(key.count - 1) + " more)";
}

}  // namespace

std::vector<IdleKey> idle_keys(const Json& document, const Scene& scene) {
    Scene copy = scene;  // the lists take members that can be set
    Finder finder(document, scene);
    fields(copy, finder);
    return std::move(finder.found);
}

std::string refusal_of(const IdleKey& key) {
    return with_count(key) + ": " + key.value + " has no effect, as it acts only " + key.words +
           "; allowed: " + key.allowed + ".";
}

std::vector<std::string> warnings_of(const std::vector<IdleKey>& keys) {
    std::vector<std::pair<std::string, std::string>> by_reason;  // words, keys
    for (const IdleKey& key : keys) {
        if (key.for_good) continue;
        const auto same = std::find_if(by_reason.begin(), by_reason.end(),
                                       [&](const auto& reason) { return reason.first == key.words; });
        if (same == by_reason.end()) {
            by_reason.emplace_back(key.words, with_count(key));
        } else {
            same->second += ", " + with_count(key);
        }
    }
    std::vector<std::string> sentences;
    for (const auto& [words, names] : by_reason) sentences.push_back(names + ": no effect; acts only " + words + ".");
    return sentences;
}

}  // namespace wade
