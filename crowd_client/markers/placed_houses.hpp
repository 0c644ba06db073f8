#pragma once
// Houses of any ground plan, with a spatial index.
//
// The sides of the ground plans are listed in the cells of an index (placed_boxes.hpp), long ones in pieces, so that a
// query near a house finds the sides there and no others. Obstacles of a scene with a site are houses, too.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/placed_boxes.hpp"

namespace wade::crowd {

// A side of a ground plan, the house on its left as seen along it.
struct HouseSide {
    Vector2d from = Vector2d::Zero(), to = Vector2d::Zero();  // m
    Vector2d along = Vector2d::Zero();                        // unit vectors: from `from` to `to`,
    Vector2d outward = Vector2d::Zero();                      // and away from the house
    double length = 0;                                        // m
    std::uint32_t before = 0, after = 0;                      // sides that end at `from` and begin at `to`
    bool juts_before = false, juts_after = false;  // whether the house's corner there is less than 180 degrees
    bool is_of_court = false;                      // of a ring within another one of the house

    // Returns the distance of p in front of the line of the side, m; below 0 behind it.
    [[nodiscard]] double distance_before(const Vector2d& p) const { return outward.dot(p - from); }
    // Returns the point of the side nearest to p, as a length from `from`, m.
    [[nodiscard]] double nearest(const Vector2d& p) const { return std::clamp(along.dot(p - from), 0.0, length); }
    [[nodiscard]] Vector2d at(double s) const { return s >= length ? to : Vector2d(from + s * along); }
};

struct PlacedHouses {
    std::vector<MapPolygon> plans;
    std::vector<HouseSide> sides;           // of all plans, those of a ring one after the other
    std::vector<std::uint32_t> first_side;  // of each plan, and the end

    PlacedBoxes grounds;                 // the rectangle round each plan
    PlacedBoxes pieces;                  // rectangles round pieces of sides
    std::vector<std::uint32_t> side_of;  // by piece

    [[nodiscard]] bool empty() const { return plans.empty(); }
    [[nodiscard]] const MapPolygon& plan_on(const Obstacle& ground) const {
        return plans[static_cast<std::size_t>(&ground - grounds.all.data())];
    }
};

[[nodiscard]] PlacedHouses place_houses(std::vector<MapPolygon> plans);

// Returns the houses of the scene's site, then its obstacles and flood walls; none without a site.
[[nodiscard]] PlacedHouses houses_of(const Scene& scene);

[[nodiscard]] bool is_in_a_house(const PlacedHouses& houses, const Vector2d& p);

// Returns whether `test(side)` is true for a side with a piece in the rectangle x, z, m. Tests the sides in their order
// until one is found; tests some sides that are only near, too.
template <typename Test>
bool any_side_near(const PlacedHouses& houses, const Interval& x, const Interval& z, Test&& test) {
    std::size_t last = houses.sides.size();
    return any_near(houses.pieces, x, z, [&](const Obstacle& piece) {
        const std::size_t side = houses.side_of[static_cast<std::size_t>(&piece - houses.pieces.all.data())];
        return side != last && test(houses.sides[last = side]);
    });
}

// Calls visit(side) for each of these sides.
template <typename Visit>
void for_each_side_near(const PlacedHouses& houses, const Interval& x, const Interval& z, Visit&& visit) {
    any_side_near(houses, x, z, [&](const HouseSide& side) {
        visit(side);
        return false;
    });
}

// Returns whether the segment from p to q meets a side, also at its ends.
[[nodiscard]] bool meets(const HouseSide& side, const Vector2d& p, const Vector2d& q);

// Returns the distance of the segment from p to q to a side, m; 0 if they meet.
[[nodiscard]] double distance_between(const HouseSide& side, const Vector2d& p, const Vector2d& q);

// Returns whether the segment from p to q meets a house.
[[nodiscard]] bool meets_a_house(const PlacedHouses& houses, const Vector2d& p, const Vector2d& q);

// Residents of the houses of a site: where they start, by which door they leave, and when.
//
// People of the site's table with a position in a house, and as many of each house as its `residents` says, start
// indoors. They are not in the water until they leave. Then they appear in front of their door, as soon as there is
// room.

inline constexpr double never = std::numeric_limits<double>::infinity();

// A resident of a group that starts in houses.
struct Lodger {
    const Resident* row = nullptr;  // of the table; none: counted by the `residents` of the house
    std::int32_t house = -1;        // number; -1: outdoors
    std::uint32_t in_house = 0;     // number among the counted residents of the house
};

// Returns the residents of a group that starts in houses: first its rows of the table in their order, then the counted
// residents of the houses, which belong to the first such group.
[[nodiscard]] std::vector<Lodger> lodgers_of(const Scene& scene, const PlacedHouses& houses, std::size_t group);

// Positions before the doors of houses, `room` from all walls, m.
class Doors {
 public:
    Doors(const Scene& scene, const PlacedHouses& houses, double room);
    // Returns the position before the door of a person: the nearest door for a person of the table, else the doors in
    // turn by its number. A house without free ground before any of its walls gives the middle of a wall. Throws
    // ConfigurationError for a door that opens into a wall.
    [[nodiscard]] Vector2d place_before(const Lodger& lodger);
    // Returns all positions before doors of the house, the usual one first: of the doors that the scene states; else of
    // points on its walls with free ground, middles of walls first, from the lowest ground up. Walls of courts come
    // last.
    [[nodiscard]] const std::vector<Vector2d>& doors_of(std::size_t house);

 private:
    [[nodiscard]] bool is_free(const Vector2d& p) const;
    [[nodiscard]] double away() const { return room_ + 1e-3; }
    [[nodiscard]] Vector2d before_stated_door(std::size_t house, const MapPoint& door) const;

    const Scene& scene_;
    const PlacedHouses& houses_;
    double room_;
    std::vector<std::vector<Vector2d>> known_;  // by house, positions before its doors; empty: not computed yet
};

// Returns the time of leaving, s; `never` for a resident that stays. u: its own number in [0, 1).
[[nodiscard]] double leaving_time(const Leaving& leaving, double u);

}  // namespace wade::crowd
