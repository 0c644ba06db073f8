#pragma once
// Travel-time fields to goals (navigation.hpp), and their direction of steepest descent.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/markers/ground_cells.hpp"
#include "crowd_client/navigation/sight.hpp"
#include "crowd_client/navigation/travel_time.hpp"
#include "crowd_client/people/people.hpp"

namespace wade::crowd {

// Largest number of nodes of all fields together.
inline constexpr double max_field_nodes = 5e7;

// The travel-time field of one goal.
struct TravelTimeField {
    Vector2d goal = Vector2d::Zero();  // in a periodic world its image with x in [0, period), m
    bool has_point = true;             // else the field leads to shelters, and `goal` is unused
    std::vector<std::pair<std::uint32_t, double>> starts;
    std::vector<double> travel;  // L by node, m; empty until it is solved
    std::vector<View> views;     // by cell, numbered like the node at its lower corner; empty in a periodic world
    std::vector<std::uint32_t> hiding_start, hiding;  // boxes that can hide the goal from a cell of unknown view
    MarchMemory memory;

    [[nodiscard]] bool is_solved() const { return !travel.empty(); }
};

// Routes of a group in a site (site_routes.hpp). Field 2 g of group g knows the water, field 2 g + 1 does not.
struct GroupRoutes {
    bool to_shelters = false;
    bool has_unwarned = false;
    People person;                   // the mean person of the group
    double mass = 0;                 // of the mean person, kg
    double men = 0;                  // fraction of men
    std::vector<double> slowness;    // by node, in the latest water; empty before
    std::vector<std::uint8_t> shut;  // by cell of the water: 1 where the group does not go; empty before
};

// State of the routes in a site, beside the fields.
struct SiteRoutes {
    GroundCells cells;                // of the water
    std::vector<double> free;         // by cell, fraction without houses
    std::vector<float> depth, speed;  // by cell, m, m/s
    bool is_wet = false;              // whether there is any water

    Ground ground;
    double ground_step = 1;  // length over which slopes are measured, m
    SlopeRule slope = SlopeRule::level;
    double sight = 20;                               // m
    std::optional<double> enters_up_to, safe_above;  // m
    std::vector<double> dry;                         // slowness by node without water; empty: 1 everywhere

    PlacedHouses shelters;
    std::vector<std::size_t> capacity, taken;  // by shelter; the last of `taken` is high ground
    bool is_stale = false;                     // a shelter has become full
    bool are_fields_due = false;               // the fields are of an older water than the slowness
    bool have_shelters_changed = false;        // since the fields were solved
    std::vector<std::vector<std::pair<std::uint32_t, double>>> starts;  // by shelter, nodes round it
    std::vector<std::pair<std::uint32_t, double>> high_ground;

    std::vector<GroupRoutes> groups;
    std::vector<std::uint8_t> knows;  // by agent: 1 if it knows the water

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

// The routes to all goals.
struct Navigation {
    double crowding = 0;
    std::uint64_t looks_between = 1;  // decisions from one update of the routes to the next
    std::uint64_t steps_between = 0;  // between two solutions, or two checks for needed fields; 0: solved once
    bool by_fields_alone = false;     // agents follow the field also to visible goals, unless close to them
    bool only_where_needed = false;   // a field is solved once its goal is hidden from an agent
    std::size_t solved = 0;           // fields
    double period = 0;                // World::period()
    double goal_radius = 0;           // distance to the goal at which an agent has arrived, m
    double start_radius = 0;          // of the disc around a goal with exact times, m
    int reach = 2;                    // of the search for nodes around a cell, in cells

    Sight sight;
    TravelGrid grid;
    std::vector<double> slowness;  // v / f by node; empty without crowding
    std::vector<double> density;   // people per m2, by node of one period
    std::vector<TravelTimeField> fields;
    std::vector<std::uint32_t> field_of;  // by agent
    std::vector<Vector2d> way;            // by agent, of the latest update, m; zero: straight, in a site: it waits
    std::optional<SiteRoutes> site;
};

// Returns whether no obstacle blocks the segment from p along `way`, m.
[[nodiscard]] bool sees_along(const Navigation& navigation, const Vector2d& p, const Vector2d& way);

// Returns the offset along the route from p, as long as the remaining route, m; nothing if no route is visible.
// p: in the world, or in the period of a periodic one where `rest` leads to the goal's image. rest: goal - p, m.
[[nodiscard]] std::optional<Vector2d> way_from(const Navigation& navigation, const TravelTimeField& field,
                                               const Vector2d& p, const Vector2d& rest);

// Returns positions on the route from `from` to the goal of a field, `step` apart, m, the last at most that far from
// it. Returns an empty list if no route is found. Not for periodic worlds.
[[nodiscard]] std::vector<Vector2d> places_on_way(const Navigation& navigation, const TravelTimeField& field,
                                                  const Vector2d& from, double step);

}  // namespace wade::crowd
