#pragma once
// Fields of the travel time to goals (navigation.hpp), and the direction in which they fall.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/markers/ground_cells.hpp"
#include "crowd_client/people/people.hpp"
#include "crowd_client/ways/sight.hpp"
#include "crowd_client/ways/travel_time.hpp"

namespace wade::crowd {

// Largest number of nodes of all fields together.
inline constexpr double max_field_nodes = 5e7;

// The way to one goal.
struct WayField {
    Vector2d goal = Vector2d::Zero();  // in a periodic world its image with x in [0, period), m
    bool has_point = true;             // else it leads to shelters, and `goal` is none
    std::vector<std::pair<std::uint32_t, double>> starts;
    std::vector<double> travel;  // L by node, m; empty until it is solved
    std::vector<View> views;     // by cell, numbered like the node at its lower corner; empty in a periodic world
    std::vector<std::uint32_t> hiding_start, hiding;  // boxes that can hide the goal from a cell of unknown view
    MarchMemory memory;

    [[nodiscard]] bool is_solved() const { return !travel.empty(); }
};

// Those of a group, in a site (site_ways.hpp). Field 2 g of group g knows the water, field 2 g + 1 does not.
struct GroupWays {
    bool to_shelters = false;
    bool has_unwarned = false;
    People person;                   // one, the mean of them
    double mass = 0;                 // its, kg
    double men = 0;                  // share of them
    std::vector<double> slowness;    // by node, in the water as last seen; empty before
    std::vector<std::uint8_t> shut;  // by cell of the water, where the group does not go; empty before
};

// What ways in a site need beyond the fields.
struct SiteWays {
    GroundCells cells;                // of the water
    std::vector<double> free;         // of each, the part that no house stands on
    std::vector<float> depth, speed;  // by cell, m, m/s
    bool is_wet = false;              // whether there is any water

    Ground ground;
    double ground_step = 1;  // over which slopes are taken, m
    SlopeRule slope = SlopeRule::level;
    double sight = 20;                               // m
    std::optional<double> enters_up_to, safe_above;  // m
    std::vector<double> dry;                         // slowness by node without water; empty: 1 everywhere

    PlacedHouses shelters;
    std::vector<std::size_t> capacity, taken;  // by shelter; of `taken` the last is high ground
    bool is_stale = false;                     // a shelter has become full
    bool are_fields_due = false;               // the fields are of an older water than the slowness
    bool have_shelters_changed = false;        // since the fields were solved
    std::vector<std::vector<std::pair<std::uint32_t, double>>> starts;  // by shelter, nodes round it
    std::vector<std::pair<std::uint32_t, double>> high_ground;

    std::vector<GroupWays> groups;
    std::vector<std::uint8_t> knows;  // by agent, where the water is

    [[nodiscard]] bool is_full(std::size_t shelter) const {
        return capacity[shelter] > 0 && taken[shelter] >= capacity[shelter];
    }
    // Returns the water's column of cells at x, its row at z, its cell at p; the outermost one beyond the last.
    [[nodiscard]] std::size_t column_at(double x) const { return line(x - cells.x0, cells.step_x, cells.columns); }
    [[nodiscard]] std::size_t row_at(double z) const { return line(z - cells.z0, cells.step_z, cells.rows); }
    [[nodiscard]] std::size_t cell_at(const Vector2d& p) const {
        return row_at(p.y()) * cells.columns + column_at(p.x());
    }

 private:
    static std::size_t line(double at, double step, std::size_t count) {
        return static_cast<std::size_t>(std::clamp(at / step, 0.0, static_cast<double>(count - 1)));
    }
};

// The ways to all goals.
struct Navigation {
    double crowding = 0;
    std::uint64_t looks_between = 1;  // decisions from one look for the way to the next
    std::uint64_t steps_between = 0;  // two solutions, or looks whether fields are needed; 0: solved once
    bool by_fields_alone = false;     // goals in sight are no short cut, but next to them
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
    std::vector<Vector2d> way;            // by agent, as last seen, m; zero: straight, in a site: it waits
    std::optional<SiteWays> site;
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
