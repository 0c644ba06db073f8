#include "configs/scene/fields/residents.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/normal.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/place.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {
namespace {

std::int32_t house_at(const PlacedHouses& houses, std::size_t count, const Vector2d& p) {
    std::int32_t house = -1;
    any_near(houses.grounds, {p.x(), p.x()}, {p.y(), p.y()}, [&](const Obstacle& ground) {
        const auto number = static_cast<std::size_t>(&ground - houses.grounds.all.data());
        if (number >= count || !contains(houses.plans[number], {p.x(), p.y()})) return false;
        house = static_cast<std::int32_t>(number);
        return true;
    });
    return house;
}

std::string words_of(const Scene& scene, std::size_t house) {
    const std::string& name = scene.place->houses[house].name;
    return "/place/houses/" + std::to_string(house) + (name.empty() ? "" : " (\"" + name + "\")");
}

}  // namespace

std::vector<Lodger> lodgers_of(const Scene& scene, const PlacedHouses& houses, std::size_t group) {
    std::vector<Lodger> lodgers;
    const std::size_t count = scene.place->houses.size();
    for_each_resident(scene, group, [&](const Resident& row) {
        lodgers.push_back({&row, house_at(houses, count, {row.x, row.z}), 0});
    });
    if (first_group_in_houses(scene.crowd) != group) return lodgers;
    for (std::size_t house = 0; house < count; ++house) {
        for (int k = 0; k < scene.place->houses[house].residents; ++k) {
            lodgers.push_back({nullptr, static_cast<std::int32_t>(house), static_cast<std::uint32_t>(k)});
        }
    }
    return lodgers;
}

Doors::Doors(const Scene& scene, const PlacedHouses& houses, double room)
    : scene_(scene), houses_(houses), room_(room), known_(scene.place->houses.size()) {}

const std::vector<Vector2d>& Doors::doors_of(std::size_t house) {
    std::vector<Vector2d>& places = known_[house];
    if (!places.empty()) return places;
    constexpr double on_a_wall = 1;  // m; how far a door may be off
    const double away = room_ + 1e-3;
    const std::span sides =
        std::span(houses_.sides)
            .subspan(houses_.first_side[house], houses_.first_side[house + 1] - houses_.first_side[house]);
    const auto is_free = [&](const Vector2d& p) {
        const bool in_world = p.x() >= 0 && p.x() <= scene_.world->length && p.y() >= 0 && p.y() <= scene_.world->width;
        return in_world && !is_in_a_house(houses_, p) &&
               !any_side_near(houses_, {p.x() - room_, p.x() + room_}, {p.y() - room_, p.y() + room_},
                              [&](const HouseSide& side) { return (p - side.at(side.nearest(p))).norm() < room_; });
    };
    for (const MapPoint& door : scene_.place->houses[house].doors) {
        const Vector2d p(door.x, door.z);
        const auto nearest = std::min_element(sides.begin(), sides.end(), [&](const HouseSide& a, const HouseSide& b) {
            return (p - a.at(a.nearest(p))).squaredNorm() < (p - b.at(b.nearest(p))).squaredNorm();
        });
        const Vector2d on_wall = nearest->at(nearest->nearest(p)), before = on_wall + away * nearest->outward;
        std::ostringstream message;
        message << words_of(scene_, house) << ": the door at (" << p.x() << ", " << p.y() << ") m ";
        if ((p - on_wall).norm() > on_a_wall) {
            message << "is " << (p - on_wall).norm() << " m from the walls; allowed: " << on_a_wall << " m at most";
            throw ConfigurationError(message.str());
        }
        if (!is_free(before)) {
            message << "opens into a wall or out of the world; allowed: " << 2 * room_ << " m of free ground before it";
            throw ConfigurationError(message.str());
        }
        places.push_back(before);
    }
    if (!places.empty()) return places;
    // Without doors one at the lowest of the middles of its walls that is free; the first of equal ones.
    double lowest = never;
    for (const HouseSide& side : sides) {
        const Vector2d before = side.at(0.5 * side.length) + away * side.outward;
        const double height = ground_height(scene_.place->ground, {before.x(), before.y()});
        if (!(height < lowest) || !is_free(before)) continue;
        lowest = height;
        places.assign(1, before);
    }
    if (places.empty()) {
        throw ConfigurationError(words_of(scene_, house) +
                                 ": none of its walls has free ground before its middle for a door; allowed: "
                                 "doors_m where there is some, or residents 0");
    }
    return places;
}

Vector2d Doors::place_before(const Lodger& lodger) {
    const std::vector<Vector2d>& places = doors_of(static_cast<std::size_t>(lodger.house));
    if (lodger.row == nullptr) return places[lodger.in_house % places.size()];
    const Vector2d p(lodger.row->x, lodger.row->z);
    return *std::min_element(places.begin(), places.end(), [&](const Vector2d& a, const Vector2d& b) {
        return (a - p).squaredNorm() < (b - p).squaredNorm();
    });
}

double leaving_time(const Leaving& leaving, double u) {
    switch (leaving.rule) {
        case LeavingRule::at_once:
            return leaving.after;
        case LeavingRule::normal:
            return leaving.after + Spread(0, leaving.mean + 10 * leaving.sd, leaving.mean, leaving.sd).at(u);
        case LeavingRule::weibull:
            return leaving.after + leaving.scale * std::pow(-std::log1p(-u), 1 / leaving.shape);
        case LeavingRule::table: {
            const LeavingPoint* before = nullptr;
            for (const LeavingPoint& point : leaving.table) {
                if (u >= point.share) {
                    before = &point;
                    continue;
                }
                if (before == nullptr) return point.time;
                return before->time + (point.time - before->time) * (u - before->share) / (point.share - before->share);
            }
            return never;
        }
        case LeavingRule::never:
            break;
    }
    return never;
}

}  // namespace wade::crowd
