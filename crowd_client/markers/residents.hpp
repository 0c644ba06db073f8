#pragma once
// Who lives in the houses of a place: where they start, by which door they leave, and when.
//
// People of the place's table who stand in a house, and as many of each house as its `residents` says, start indoors. They are not in
// the water until they leave; then they stand before their door, as soon as there is room.

#include <cstdint>
#include <limits>
#include <vector>

#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/markers/placed_houses.hpp"

namespace wade::crowd {

inline constexpr double never = std::numeric_limits<double>::infinity();

// Somebody of a group that starts in houses.
struct Lodger {
    const Resident* row = nullptr;  // of the table; none: one of those whom the house counts
    std::int32_t house = -1;        // number; -1: outdoors
    std::uint32_t in_house = 0;     // which of those of the house
};

// Of a group that starts in houses, first the table's in its order, then those of the houses, which are the first such group's.
[[nodiscard]] std::vector<Lodger> lodgers_of(const Scene& scene, const PlacedHouses& houses, std::size_t group);

// Where one stands who has left by a door of the house, `room` from all walls, m. Throws ConfigurationError for a door that opens into
// a wall, and for a house that nobody can leave.
class Doors {
 public:
    Doors(const Scene& scene, const PlacedHouses& houses, double room);
    // The door is the nearest of a table's person, else that of its number in turn.
    [[nodiscard]] Vector2d place_before(const Lodger& lodger);

 private:
    [[nodiscard]] const std::vector<Vector2d>& doors_of(std::size_t house);

    const Scene& scene_;
    const PlacedHouses& houses_;
    double room_;
    std::vector<std::vector<Vector2d>> known_;  // by house, places before its doors; empty: not looked for
};

// When one leaves, s; `never` of who stays. u: a number of [0, 1) that is its own.
[[nodiscard]] double leaving_time(const Leaving& leaving, double u);

}  // namespace wade::crowd
