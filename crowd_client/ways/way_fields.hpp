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
    std::vector<double> travel;  // L by node, m; empty until it is solved
    std::vector<View> views;     // by cell, numbered like the node at its lower corner; empty in a periodic world
    std::vector<std::uint32_t> hiding_start, hiding;  // boxes that can hide the goal from a cell of unknown view
    MarchMemory memory;

    [[nodiscard]] bool is_solved() const { return !travel.empty(); }
};

// The ways to all goals.
struct Navigation {
    double crowding = 0;
    std::uint64_t looks_between = 1;  // decisions from one look for the way to the next
    std::uint64_t steps_between = 0;  // two solutions, or looks whether fields are needed; 0: solved once
    bool only_where_needed = false;   // solved once somebody does not see its goal
    std::size_t solved = 0;           // fields
    double period = 0;                // World::period()
    double goal_radius = 0;           // within which an agent has arrived, m
    double start_radius = 0;          // of the disc round a goal whose times are exact, m
    int reach = 2;                    // of the look for nodes round a cell, in cells

    Sight sight;
    TravelGrid grid;
    std::vector<double> slowness;  // v / f by node; empty without crowding
    std::vector<double> density;   // people per m2, by node of one lap
    std::vector<WayField> fields;
    std::vector<std::uint32_t> field_of;  // by agent
    std::vector<Vector2d> way;            // by agent, as last seen, m; zero: straight
};

// Whether nothing stands in the way from p along `way`, m.
[[nodiscard]] bool sees_along(const Navigation& navigation, const Vector2d& p, const Vector2d& way);

// The way from p, with the length that is left of it, m; nothing where none is in sight.
// p: in the world, or in the lap of a periodic one in which `rest` leads to the goal's image. rest: goal - p, m.
[[nodiscard]] std::optional<Vector2d> way_from(const Navigation& navigation, const WayField& field, const Vector2d& p,
                                               const Vector2d& rest);

// Places on the way from somewhere to the goal of a field, `step` apart, m, the last at most that far from it; nothing where no way is
// found. Not in periodic worlds.
[[nodiscard]] std::vector<Vector2d> places_on_way(const Navigation& navigation, const WayField& field,
                                                  const Vector2d& from, double step);

}  // namespace wade::crowd
