#pragma once
// A key of a scene is declared once: name, unit, range, meaning and the member that it fills, in the list of its struct.
//
//   void fields(World& world, Fields& f) {
//       f.number("length_m", world.length, "m", above(0).to(1e5), "Extent along x.");
//       f.choice("ends", world.ends, "open: ... periodic: ...");
//   }
//
// The default is what the member holds in a new struct (scene.hpp). Visitors of the lists are the reader and the
// writer (scene_json), the table of keys with its checks and messages (keys), the schema and the documents
// (scene_documents). Lists of the scene's structs: fields/.

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "configs/scene/choices.hpp"
#include "configs/scene/scene.hpp"

namespace wade {

enum class KeyKind { number, whole, flag, text, choice, spread, estimate, points, object, list };

// Points of as many coordinates each, one after the other.
struct PointList {
    std::size_t size = 2;  // of a point; 1: numbers
    std::vector<double> numbers;
};

// A value of any key that is no object and no list of objects; monostate: none.
using KeyValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, Spread, PointList>;

// Allowed numbers: from(0).to(1), above(0).below(1); `from` and `to` include the limit.
struct Range {
    double lo = -std::numeric_limits<double>::infinity();
    double hi = std::numeric_limits<double>::infinity();
    bool without_lo = false;
    bool without_hi = false;

    [[nodiscard]] constexpr Range to(double limit) const { return {lo, limit, without_lo, false}; }
    [[nodiscard]] constexpr Range below(double limit) const { return {lo, limit, without_lo, true}; }
    [[nodiscard]] constexpr bool contains(double v) const {
        return (without_lo ? lo < v : lo <= v) && (without_hi ? v < hi : v <= hi);
    }
};
[[nodiscard]] constexpr Range from(double limit) {
    return {limit, std::numeric_limits<double>::infinity(), false, false};
}
[[nodiscard]] constexpr Range above(double limit) {
    return {limit, std::numeric_limits<double>::infinity(), true, false};
}

// Allowed texts. `characters`: as between the brackets of a regular expression, a '-' at the end stands for itself.
struct TextRule {
    std::size_t shortest = 0;
    std::size_t longest = std::string::npos;
    std::string_view characters = {};  // empty: any
};

// What holds where a scene does not set the key.
struct Presence {
    enum class Rule {
        preset,    // the value of a new struct
        required,  // it must be set
        otherwise  // nothing
    } rule = Rule::preset;
    std::string_view words = {};             // what `derived` does
    std::function<KeyValue()> derived = {};  // the value, from what was read before; "none": as the rule says
    std::string_view unless = {};            // of what is required: not where this key of the same object is set
};
inline const Presence preset{};
inline const Presence required{Presence::Rule::required, {}, {}};
[[nodiscard]] inline Presence required_unless(std::string_view key) {
    return {Presence::Rule::required, {}, {}, key};
}
// The value of a new struct but where `derived` gives another, as `words` say.
[[nodiscard]] inline Presence preset_but(std::string_view words, std::function<KeyValue()> derived) {
    return {Presence::Rule::preset, words, std::move(derived)};
}
// What `words` say: what `derived` gives, or nothing.
[[nodiscard]] inline Presence otherwise(std::string_view words, std::function<KeyValue()> derived = {}) {
    return {Presence::Rule::otherwise, words, std::move(derived)};
}

// Condition for a key to act: `here` returns true for the scene. Elsewhere a value other than the default is refused if
// no other value of the same scene could make the key act (for_good). Otherwise it causes a warning: a switch turned
// the key off.
struct Acting {
    std::string_view words;  // after "acts only"
    std::function<bool(const Scene&)> here;
    bool for_good = false;
};

// Where a key's value goes.
enum class Storage {
    member,     // of the scene, and into what is printed
    shorthand,  // other members of the scene are set from it; never printed
    file        // nowhere: it tells how to read the file
};

// All that is said of a key but its member.
struct Key {
    std::string_view name;
    KeyKind kind = KeyKind::number;
    std::string_view meaning;
    std::string_view unit = {};
    Range range = {};
    TextRule text = {};
    std::vector<std::string> choices = {};
    Presence presence = {};
    Storage storage = Storage::member;
    bool is_path = false;             // a text that names a file, relative to the one that it stands in
    std::size_t point_size = 2;       // coordinates of one of the points
    std::vector<Acting> acting = {};  // all must hold; those of the objects around it come first
};

// The member of a key, whatever its type. Setting "none" empties what may be empty and changes nothing else. Most types have
// their constructor in fields.cpp, as a list of fields names hundreds of members.
struct Member {
    Member(std::function<KeyValue()> its_get, std::function<void(const KeyValue&)> its_set)
        : get(std::move(its_get)), set(std::move(its_set)) {}
    Member(double& m);
    Member(bool& m);
    Member(int& m);
    Member(std::uint64_t& m);
    Member(std::string& m);
    Member(Spread& m);
    Member(DriftHazard& m);
    Member(std::vector<MapPoint>& m);
    Member(std::vector<std::array<double, 3>>& m);
    template <typename Choice>
    requires std::is_enum_v<Choice> Member(Choice& m)
        : get([&m] { return KeyValue(name_of(m)); }), set([&m](const KeyValue& v) {
              if (const auto* word = std::get_if<std::string>(&v)) m = choice_named<Choice>(*word).value_or(m);
          }) {}
    template <typename T>
    Member(std::optional<T>& m)
        : get([&m] { return m ? Member(*m).get() : KeyValue(); }), set([&m](const KeyValue& v) {
              m.reset();
              if (!std::holds_alternative<std::monostate>(v)) Member(m.emplace()).set(v);
          }) {}

    std::function<KeyValue()> get;
    std::function<void(const KeyValue&)> set;
};
struct ListMember {
    std::function<std::size_t()> size;
    std::function<void(std::size_t)> resize;
    std::function<void(std::size_t)> visit;  // the element's fields
    std::function<void()> visit_new;         // the fields of a new element
};
struct OptionalMember {
    std::function<bool()> has;
    std::function<void()> make;
    std::function<void()> visit;      // the fields of what there is
    std::function<void()> visit_new;  // the fields of a new one
};

// Visits the lists. `skipped`: the pattern of a key that is left out as if it were not declared, such as
// "/crowd/groups/*/tau", so that a test can see that nothing else knows of the key.
class Fields {
 public:
    explicit Fields(std::string skipped = "") : skipped_(std::move(skipped)) {}
    virtual ~Fields() = default;
    Fields(const Fields&) = delete;
    Fields& operator=(const Fields&) = delete;

    void number(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                std::string_view meaning, const Presence& presence = preset);
    void whole(std::string_view name, const Member& member, std::string_view unit, const Range& range,
               std::string_view meaning, const Presence& presence = preset);
    void flag(std::string_view name, const Member& member, std::string_view meaning, const Presence& presence = preset);
    void text(std::string_view name, const Member& member, const TextRule& rule, std::string_view meaning,
              const Presence& presence = preset);
    // The name of a file, relative to the one that it stands in.
    void path(std::string_view name, std::optional<std::string>& member, std::string_view meaning);
    // [[x, z], ...] or [[x, y, z], ...], as the member's points have two or three coordinates.
    template <typename Point>
    void points(std::string_view name, std::vector<Point>& member, std::string_view unit, const Range& range,
                std::string_view meaning) {
        points_of(name, member, sizeof(Point) / sizeof(double), unit, range, meaning);
    }
    template <typename Choice>
    void choice(std::string_view name, Choice& member, std::string_view meaning, const Presence& presence = preset) {
        choice_of(name, member, names_of<Choice>(), meaning, presence);
    }
    template <typename Choice>
    void choice(std::string_view name, std::optional<Choice>& member, std::string_view meaning,
                const Presence& presence = preset) {
        choice_of(name, member, names_of<Choice>(), meaning, presence);
    }
    // A number, or {"min": ..., "max": ...}, with "mean" and "sd" if its values are to be normal.
    void spread(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                std::string_view meaning, const Presence& presence = preset);

    // A number, [low, best, high] in this order, or `word`.
    void estimate(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                  std::string_view word, std::string_view meaning);

    // An object with the keys of the member's struct, or with the keys that the callable `member` declares.
    template <typename T>
    void object(std::string_view name, T&& member, std::string_view meaning, const Presence& presence = preset) {
        if constexpr (std::is_invocable_v<T>) {
            object_of(name, meaning, presence, member);
        } else {
            object_of(name, meaning, presence, [&] { fields(member, *this); });
        }
    }
    // An object that a scene has or has not.
    template <typename T>
    void object_or_none(std::string_view name, std::optional<T>& member, std::string_view meaning) {
        optional_object(name, meaning,
                        {[&] { return member.has_value(); }, [&] { member.emplace(); }, [&] { fields(*member, *this); },
                         [&] {
                             T fresh{};
                             fields(fresh, *this);
                         }});
    }
    // A list of such objects; `inside` declares the keys of one.
    template <typename T, typename Inside>
    void list(std::string_view name, std::vector<T>& members, std::string_view meaning, const Inside& inside) {
        list_of(name, meaning,
                {[&] { return members.size(); }, [&](std::size_t n) { members.resize(n); },
                 [&](std::size_t i) { inside(members[i], *this); },
                 [&] {
                     T element{};
                     inside(element, *this);
                 }});
    }
    template <typename T>
    void list(std::string_view name, std::vector<T>& members, std::string_view meaning) {
        list(name, members, meaning, [](T& member, Fields& f) { fields(member, f); });
    }

    // The keys that `inside` declares set members of others.
    template <typename Inside>
    void shorthands(const Inside& inside) {
        const Storage before = std::exchange(storage_, Storage::shorthand);
        inside();
        storage_ = before;
    }
    // The keys that `inside` declares act only there. May be nested.
    template <typename Inside>
    void acts_only(Acting acting, const Inside& inside) {
        acting_.push_back(std::move(acting));
        inside();
        acting_.pop_back();
    }
    // A text for the loader of the file; it sets no member.
    void of_file(std::string_view name, const TextRule& rule, std::string_view meaning);

    // What is to be done once the keys declared so far in this object were read; a sentence if that cannot be.
    virtual void once_read(const std::function<std::optional<std::string>()>&) {}

 protected:
    virtual void visit(const Key& key, const Member& member) = 0;
    virtual void visit_object(const Key& key, const std::function<void()>& inside) = 0;
    virtual void visit_optional(const Key& key, const OptionalMember& member) = 0;
    virtual void visit_list(const Key& key, const ListMember& member) = 0;

 private:
    void points_of(std::string_view name, const Member& member, std::size_t point_size, std::string_view unit,
                   const Range& range, std::string_view meaning);
    void choice_of(std::string_view name, const Member& member, std::vector<std::string> names,
                   std::string_view meaning, const Presence& presence);
    void object_of(std::string_view name, std::string_view meaning, const Presence& presence,
                   const std::function<void()>& inside);
    void optional_object(std::string_view name, std::string_view meaning, const OptionalMember& member);
    void list_of(std::string_view name, std::string_view meaning, const ListMember& member);

    void leaf(Key key, const Member& member);
    void branch(Key key, const std::function<void()>& inside);
    void branch(Key key, const OptionalMember& member);
    void items(Key key, const ListMember& member);

    std::string skipped_;
    std::string place_;  // pattern of the object that is visited
    Storage storage_ = Storage::member;
    std::vector<Acting> acting_;  // of the keys that are visited
};

}  // namespace wade
