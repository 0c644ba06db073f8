#include "configs/scene/fields.hpp"

#include <array>

namespace wade {

namespace {

std::string below(const std::string& place, std::string_view name) {
    return place + "/" + std::string(name);
}

template <typename Held, typename T>
void take(const KeyValue& value, T& member) {
    if (const auto* held = std::get_if<Held>(&value)) member = static_cast<T>(*held);
}

// Returns a member with values of type Held.
template <typename Held, typename T>
Member member_of(T& m) {
    return {[&m] { return KeyValue(static_cast<Held>(m)); }, [&m](const KeyValue& v) { take<Held>(v, m); }};
}

// Points that to_numbers and to_point turn into `size` coordinates and back.
template <typename Point, typename ToNumbers, typename ToPoint>
Member member_of_points(std::vector<Point>& m, std::size_t size, ToNumbers to_numbers, ToPoint to_point) {
    return {[&m, size, to_numbers] {
                PointList list{size, {}};
                for (const Point& p : m) {
                    const auto numbers = to_numbers(p);
                    list.numbers.insert(list.numbers.end(), numbers.begin(), numbers.end());
                }
                return KeyValue(std::move(list));
            },
            [&m, size, to_point](const KeyValue& v) {
                const auto* list = std::get_if<PointList>(&v);
                if (!list) return;
                m.clear();
                for (std::size_t i = 0; i + size <= list->numbers.size(); i += size)
                    m.push_back(to_point(&list->numbers[i]));
            }};
}

}  // namespace

Member::Member(double& m) : Member(member_of<double>(m)) {}
Member::Member(bool& m) : Member(member_of<bool>(m)) {}
Member::Member(int& m) : Member(member_of<std::int64_t>(m)) {}
Member::Member(std::uint64_t& m) : Member(member_of<std::int64_t>(m)) {}
Member::Member(std::string& m) : Member(member_of<std::string>(m)) {}
Member::Member(Spread& m) : Member(member_of<Spread>(m)) {}
Member::Member(DriftHazard& m)
    : Member(
          [&m] {
              if (m.is_under) return KeyValue(std::string("under"));
              if (m.low == m.high) return KeyValue(m.best);
              return KeyValue(PointList{1, {m.low, m.best, m.high}});
          },
          [&m](const KeyValue& v) {
              if (std::holds_alternative<std::string>(v)) m = {.is_under = true};
              if (const auto* number = std::get_if<double>(&v)) m = {*number, *number, *number};
              const auto* list = std::get_if<PointList>(&v);
              if (list && list->numbers.size() == 3) m = {list->numbers[0], list->numbers[1], list->numbers[2]};
          }) {}
Member::Member(std::vector<MapPoint>& m)
    : Member(member_of_points(
          m, 2,
          [](const MapPoint& p) {
              return std::array{p.x, p.z};
          },
          [](const double* p) {
              return MapPoint{p[0], p[1]};
          })) {}
Member::Member(std::vector<std::array<double, 3>>& m)
    : Member(member_of_points(
          m, 3, [](const std::array<double, 3>& p) { return p; },
          [](const double* p) {
              return std::array<double, 3>{p[0], p[1], p[2]};
          })) {}

void Fields::number(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                    std::string_view meaning, const Presence& presence) {
    leaf({name, KeyKind::number, meaning, unit, range, {}, {}, presence}, member);
}

void Fields::whole(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                   std::string_view meaning, const Presence& presence) {
    leaf({name, KeyKind::whole, meaning, unit, range, {}, {}, presence}, member);
}

void Fields::flag(std::string_view name, const Member& member, std::string_view meaning, const Presence& presence) {
    leaf({name, KeyKind::flag, meaning, {}, {}, {}, {}, presence}, member);
}

void Fields::text(std::string_view name, const Member& member, const TextRule& rule, std::string_view meaning,
                  const Presence& presence) {
    leaf({name, KeyKind::text, meaning, {}, {}, rule, {}, presence}, member);
}

void Fields::path(std::string_view name, std::optional<std::string>& member, std::string_view meaning) {
    Key key{name, KeyKind::text, meaning, {}, {}, {.shortest = 1}, {}, otherwise("none")};
    key.is_path = true;
    leaf(std::move(key), member);
}

void Fields::points_of(std::string_view name, const Member& member, std::size_t point_size, std::string_view unit,
                       const Range& range, std::string_view meaning) {
    Key key{name, KeyKind::points, meaning, unit, range};
    key.point_size = point_size;
    leaf(std::move(key), member);
}

void Fields::choice_of(std::string_view name, const Member& member, std::vector<std::string> names,
                       std::string_view meaning, const Presence& presence) {
    leaf({name, KeyKind::choice, meaning, {}, {}, {}, std::move(names), presence}, member);
}

void Fields::spread(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                    std::string_view meaning, const Presence& presence) {
    leaf({name, KeyKind::spread, meaning, unit, range, {}, {}, presence}, member);
}

void Fields::estimate(std::string_view name, const Member& member, std::string_view unit, const Range& range,
                      std::string_view word, std::string_view meaning) {
    leaf({name, KeyKind::estimate, meaning, unit, range, {}, {std::string(word)}}, member);
}

void Fields::of_file(std::string_view name, const TextRule& rule, std::string_view meaning) {
    Key key{name, KeyKind::text, meaning, {}, {}, rule, {}, otherwise("")};
    key.storage = Storage::file;
    leaf(std::move(key), {[] { return KeyValue(); }, [](const KeyValue&) {}});
}

void Fields::object_of(std::string_view name, std::string_view meaning, const Presence& presence,
                       const std::function<void()>& inside) {
    branch({name, KeyKind::object, meaning, {}, {}, {}, {}, presence}, inside);
}

void Fields::optional_object(std::string_view name, std::string_view meaning, const OptionalMember& member) {
    branch({name, KeyKind::object, meaning, {}, {}, {}, {}, otherwise("none")}, member);
}

void Fields::list_of(std::string_view name, std::string_view meaning, const ListMember& member) {
    items({name, KeyKind::list, meaning}, member);
}

void Fields::leaf(Key key, const Member& member) {
    if (below(place_, key.name) == skipped_) return;
    if (key.storage == Storage::member) key.storage = storage_;
    key.acting = acting_;
    visit(key, member);
}

void Fields::branch(Key key, const std::function<void()>& inside) {
    key.acting = acting_;
    const std::string here = place_;
    place_ = below(here, key.name);
    if (place_ != skipped_) visit_object(key, inside);
    place_ = here;
}

void Fields::branch(Key key, const OptionalMember& member) {
    key.acting = acting_;
    const std::string here = place_;
    place_ = below(here, key.name);
    if (place_ != skipped_) visit_optional(key, member);
    place_ = here;
}

void Fields::items(Key key, const ListMember& member) {
    key.acting = acting_;
    const std::string here = place_;
    const std::string list = below(here, key.name);
    place_ = list + "/*";
    if (list != skipped_) visit_list(key, member);
    place_ = here;
}

}  // namespace wade
