#include "configs/scene/fields/residents.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/normal.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/site.hpp"
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

std::string words_of_house(const Scene& scene, std::size_t house) {
    const std::string& name = scene.site->houses[house].name;
    return "/site/houses/" + std::to_string(house) + (name.empty() ? "" : " (\"" + name + "\")");
}

std::span<const HouseSide> sides_of(const PlacedHouses& houses, std::size_t house) {
    return std::span(houses.sides)
        .subspan(houses.first_side[house], houses.first_side[house + 1] - houses.first_side[house]);
}

}  // namespace

std::vector<Lodger> lodgers_of(const Scene& scene, const PlacedHouses& houses, std::size_t group) {
    std::vector<Lodger> lodgers;
    const std::size_t count = scene.site->houses.size();
    for_each_resident(scene, group, [&](const Resident& row) {
        lodgers.push_back({&row, house_at(houses, count, {row.x, row.z}), 0});
    });
    if (first_group_in_houses(scene.crowd) != group) return lodgers;
    for (std::size_t house = 0; house < count; ++house) {
        for (int k = 0; k < scene.site->houses[house].residents; ++k) {
            lodgers.push_back({nullptr, static_cast<std::int32_t>(house), static_cast<std::uint32_t>(k)});
        }
    }
    return lodgers;
}

Doors::Doors(const Scene& scene, const PlacedHouses& houses, double room)
    : scene_(scene), houses_(houses), room_(room), known_(scene.site->houses.size()) {}

bool Doors::is_free(const Vector2d& p) const {
    const bool in_world = p.x() >= 0 && p.x() <= scene_.world->length && p.y() >= 0 && p.y() <= scene_.world->width;
    return in_world && !is_in_a_house(houses_, p) &&
           !any_side_near(houses_, {p.x() - room_, p.x() + room_}, {p.y() - room_, p.y() + room_},
                          [&](const HouseSide& side) { return (p - side.at(side.nearest(p))).norm() < room_; });
}

Vector2d Doors::before_stated_door(std::size_t house, const MapPoint& door) const {
    constexpr double on_a_wall = 1;  // m; largest distance of a door from the walls
    const std::span sides = sides_of(houses_, house);
    const Vector2d p(door.x, door.z);
    const auto nearest = std::min_element(sides.begin(), sides.end(), [&](const HouseSide& a, const HouseSide& b) {
        return (p - a.at(a.nearest(p))).squaredNorm() < (p - b.at(b.nearest(p))).squaredNorm();
    });
    const Vector2d on_wall = nearest->at(nearest->nearest(p)), before = on_wall + away() * nearest->outward;
    std::ostringstream message;
    message << words_of_house(scene_, house) << ": the door at (" << p.x() << ", " << p.y() << ") m ";
    if ((p - on_wall).norm() > on_a_wall) {
        message << "is " << (p - on_wall).norm() << " m from the walls; allowed: " << on_a_wall << " m at most";
        throw ConfigurationError(message.str());
    }
    if (!is_free(before)) {
        message << "opens into a wall or out of the world; allowed: " << 2 * room_ << " m of free ground before it";
        throw ConfigurationError(message.str());
    }
    return before;
}

const std::vector<Vector2d>& Doors::doors_of(std::size_t house) {
    std::vector<Vector2d>& places = known_[house];
    if (!places.empty()) return places;
    for (const MapPoint& door : scene_.site->houses[house].doors) places.push_back(before_stated_door(house, door));
    if (!places.empty()) return places;
    struct Possible {
        int rank;
        double height;
        Vector2d before;
    };
    std::vector<Possible> possible;
    const std::span sides = sides_of(houses_, house);
    for (const HouseSide& side : sides) {
        for (const double share : {0.5, 0.25, 0.75}) {
            const Vector2d before = side.at(share * side.length) + away() * side.outward;
            if (!is_free(before)) continue;
            const int rank = (share == 0.5 ? 0 : 1) + (side.is_of_court ? 2 : 0);
            possible.push_back({rank, ground_height(scene_.site->ground, {before.x(), before.y()}), before});
        }
    }
    std::stable_sort(possible.begin(), possible.end(), [](const Possible& a, const Possible& b) {
        return a.rank != b.rank ? a.rank < b.rank : a.height < b.height;
    });
    for (const Possible& one : possible) places.push_back(one.before);
    if (places.empty()) places.push_back(sides[0].at(0.5 * sides[0].length));
    return places;
}

Vector2d Doors::place_before(const Lodger& lodger) {
    const auto house = static_cast<std::size_t>(lodger.house);
    const std::vector<Vector2d>& places = doors_of(house);
    const std::size_t stated = scene_.site->houses[house].doors.size();
    if (stated == 0) return places[0];
    if (lodger.row == nullptr) return places[lodger.in_house % stated];
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
