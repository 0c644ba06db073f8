#pragma once
// A key of a scene is declared once: name, unit, range, meaning and the member that it fills, in the list of its struct.
//
//   void fields(World& world, Fields& f) {
//       f.number("length_m", world.length, "m", above(0).to(1e5), "Extent along x.");
//       f.choice("ends", world.ends, "open: ... periodic: ...");
//   }
//
// The default is what the member holds in a new struct (scene.hpp). Who visits the lists makes of them the reader and the
// writer (scene_json), the table of keys with its checks and messages (keys), the schema and the documents
// (scene_documents). Lists of the scene's structs: fields/.

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

enum class KeyKind { number, whole, flag, text, choice, spread, points, object, list };

// Points of as many coordinates each, one after the other.
struct PointList {
    std::size_t size = 2;  // of a point
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
    bool is_path = false;        // a text that names a file, relative to the one that it stands in
    std::size_t point_size = 2;  // coordinates of one of the points
};

// The member of a key, whatever its type. Setting "none" empties what may be empty and changes nothing else.
struct Member {
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

    template <typename T>
    void number(std::string_view name, T& member, std::string_view unit, Range range, std::string_view meaning,
                Presence presence = preset) {
        leaf({name, KeyKind::number, meaning, unit, range, {}, {}, std::move(presence)}, member_of(member));
    }
    template <typename T>
    void whole(std::string_view name, T& member, std::string_view unit, Range range, std::string_view meaning,
               Presence presence = preset) {
        leaf({name, KeyKind::whole, meaning, unit, range, {}, {}, std::move(presence)}, member_of(member));
    }
    template <typename T>
    void flag(std::string_view name, T& member, std::string_view meaning, Presence presence = preset) {
        leaf({name, KeyKind::flag, meaning, {}, {}, {}, {}, std::move(presence)}, member_of(member));
    }
    template <typename T>
    void text(std::string_view name, T& member, TextRule rule, std::string_view meaning, Presence presence = preset) {
        leaf({name, KeyKind::text, meaning, {}, {}, rule, {}, std::move(presence)}, member_of(member));
    }
    // The name of a file, relative to the one that it stands in.
    void path(std::string_view name, std::optional<std::string>& member, std::string_view meaning) {
        Key key{name, KeyKind::text, meaning, {}, {}, {.shortest = 1}, {}, otherwise("none")};
        key.is_path = true;
        leaf(std::move(key), member_of(member));
    }
    // [[x, z], ...] or [[x, y, z], ...], as the member's points have two or three coordinates.
    template <typename Point>
    void points(std::string_view name, std::vector<Point>& member, std::string_view unit, Range range,
                std::string_view meaning) {
        Key key{name, KeyKind::points, meaning, unit, range};
        key.point_size = sizeof(Point) / sizeof(double);
        leaf(std::move(key), member_of(member));
    }
    template <typename Choice>
    void choice(std::string_view name, Choice& member, std::string_view meaning, Presence presence = preset) {
        leaf({name, KeyKind::choice, meaning, {}, {}, {}, names_of<Choice>(), std::move(presence)}, member_of(member));
    }
    template <typename Choice>
    void choice(std::string_view name, std::optional<Choice>& member, std::string_view meaning,
                Presence presence = preset) {
        leaf({name, KeyKind::choice, meaning, {}, {}, {}, names_of<Choice>(), std::move(presence)}, member_of(member));
    }
    // A number, or {"min": ..., "max": ...}, with "mean" and "sd" if its values are to be normal.
    template <typename T>
    void spread(std::string_view name, T& member, std::string_view unit, Range range, std::string_view meaning,
                Presence presence = preset) {
        leaf({name, KeyKind::spread, meaning, unit, range, {}, {}, std::move(presence)}, member_of(member));
    }

    // An object whose keys are those of the member's struct, or those that `inside` declares.
    template <typename T>
    void object(std::string_view name, T&& member, std::string_view meaning, Presence presence = preset) {
        if constexpr (std::is_invocable_v<T>) {
            branch({name, KeyKind::object, meaning, {}, {}, {}, {}, std::move(presence)}, member);
        } else {
            branch({name, KeyKind::object, meaning, {}, {}, {}, {}, std::move(presence)},
                   [&] { fields(member, *this); });
        }
    }
    // An object that a scene has or has not.
    template <typename T>
    void object_or_none(std::string_view name, std::optional<T>& member, std::string_view meaning) {
        const Key key{name, KeyKind::object, meaning, {}, {}, {}, {}, otherwise("none")};
        branch(key, OptionalMember{[&] { return member.has_value(); }, [&] { member.emplace(); },
                                   [&] { fields(*member, *this); },
                                   [&] {
                                       T fresh{};
                                       fields(fresh, *this);
                                   }});
    }
    // A list of such objects; `inside` declares the keys of one.
    template <typename T, typename Inside>
    void list(std::string_view name, std::vector<T>& members, std::string_view meaning, const Inside& inside) {
        items({name, KeyKind::list, meaning},
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
    // A text for those who read the file.
    void of_file(std::string_view name, TextRule rule, std::string_view meaning) {
        Key key{name, KeyKind::text, meaning, {}, {}, rule, {}, otherwise("")};
        key.storage = Storage::file;
        leaf(std::move(key), {[] { return KeyValue(); }, [](const KeyValue&) {}});
    }

    // What is to be done once the keys declared so far in this object were read; a sentence if that cannot be.
    virtual void once_read(const std::function<std::optional<std::string>()>&) {}

 protected:
    virtual void visit(const Key& key, const Member& member) = 0;
    virtual void visit_object(const Key& key, const std::function<void()>& inside) = 0;
    virtual void visit_optional(const Key& key, const OptionalMember& member) = 0;
    virtual void visit_list(const Key& key, const ListMember& member) = 0;

 private:
    void leaf(Key key, const Member& member);
    void branch(const Key& key, const std::function<void()>& inside);
    void branch(const Key& key, const OptionalMember& member);
    void items(const Key& key, const ListMember& member);

    static Member member_of(double& m) {
        return {[&m] { return KeyValue(m); }, [&m](const KeyValue& v) { take<double>(v, m); }};
    }
    static Member member_of(bool& m) {
        return {[&m] { return KeyValue(m); }, [&m](const KeyValue& v) { take<bool>(v, m); }};
    }
    static Member member_of(std::string& m) {
        return {[&m] { return KeyValue(m); }, [&m](const KeyValue& v) { take<std::string>(v, m); }};
    }
    static Member member_of(Spread& m) {
        return {[&m] { return KeyValue(m); }, [&m](const KeyValue& v) { take<Spread>(v, m); }};
    }
    static Member member_of(std::vector<MapPoint>& m) {
        return {[&m] {
                    PointList list{2, {}};
                    for (const MapPoint& p : m) list.numbers.insert(list.numbers.end(), {p.x, p.z});
                    return KeyValue(std::move(list));
                },
                [&m](const KeyValue& v) {
                    const auto* list = std::get_if<PointList>(&v);
                    if (!list) return;
                    m.clear();
                    for (std::size_t i = 0; i + 1 < list->numbers.size(); i += 2)
                        m.push_back({list->numbers[i], list->numbers[i + 1]});
                }};
    }
    static Member member_of(std::vector<std::array<double, 3>>& m) {
        return {[&m] {
                    PointList list{3, {}};
                    for (const auto& p : m) list.numbers.insert(list.numbers.end(), p.begin(), p.end());
                    return KeyValue(std::move(list));
                },
                [&m](const KeyValue& v) {
                    const auto* list = std::get_if<PointList>(&v);
                    if (!list) return;
                    m.clear();
                    for (std::size_t i = 0; i + 2 < list->numbers.size(); i += 3)
                        m.push_back({list->numbers[i], list->numbers[i + 1], list->numbers[i + 2]});
                }};
    }
    template <typename T>
    requires std::is_integral_v<T>
    static Member member_of(T& m) {
        return {[&m] { return KeyValue(static_cast<std::int64_t>(m)); },
                [&m](const KeyValue& v) { take<std::int64_t>(v, m); }};
    }
    template <typename T>
    requires std::is_enum_v<T>
    static Member member_of(T& m) {
        return {[&m] { return KeyValue(name_of(m)); },
                [&m](const KeyValue& v) {
                    if (const auto* word = std::get_if<std::string>(&v)) m = choice_named<T>(*word).value_or(m);
                }};
    }
    template <typename T>
    static Member member_of(std::optional<T>& m) {
        return {[&m] { return m ? member_of(*m).get() : KeyValue(); },
                [&m](const KeyValue& v) {
                    m.reset();
                    if (!std::holds_alternative<std::monostate>(v)) member_of(m.emplace()).set(v);
                }};
    }
    template <typename Held, typename T>
    static void take(const KeyValue& value, T& member) {
        if (const auto* held = std::get_if<Held>(&value)) member = static_cast<T>(*held);
    }

    std::string skipped_;
    std::string place_;  // pattern of the object that is visited
    Storage storage_ = Storage::member;
};

}  // namespace wade
