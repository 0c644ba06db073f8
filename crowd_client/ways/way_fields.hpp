#pragma once
// Fields of the travel time to goals (navigation.hpp), and the direction in which they fall.

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "crowd_client/ways/sight.hpp"
#include "crowd_client/ways/travel_time.hpp"

namespace wade::crowd {

// The way to one goal.
struct WayField {
    Vector2d goal = Vector2d::Zero();  // in a periodic world its image with x in [0, period), m
    std::vector<std::pair<std::uint32_t, double>> starts;
    std::vector<double> travel;  // L by node, m
    std::vector<View> views;     // by cell, numbered like the node at its lower corner; empty in a periodic world
    MarchMemory memory;
};

// The ways to all goals.
struct Navigation {
    double crowding = 0;
    std::uint64_t steps_between = 0;  // two solutions; 0: solved once
    double period = 0;                // World::period()
    double start_radius = 0;          // of the disc round a goal whose times are exact, m
    int reach = 2;                    // of the look for nodes round a cell, in cells

    Sight sight;
    TravelGrid grid;
    std::vector<double> slowness;  // v / f by node; empty without crowding
    std::vector<double> density;   // people per m2, by node of one lap
    std::vector<WayField> fields;
    std::vector<std::uint32_t> field_of;  // by agent
};

// The way from p, with the length that is left of it, m; nothing where none is in sight.
// p: in the world, or in the lap of a periodic one in which `rest` leads to the goal's image. rest: goal - p, m.
[[nodiscard]] std::optional<Vector2d> way_from(const Navigation& navigation, const WayField& field, const Vector2d& p,
                                               const Vector2d& rest);

}  // namespace wade::crowd
