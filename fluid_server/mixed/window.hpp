#pragma once
// Where the water is particles: whole columns of cells over the whole width of the channel.
//
//   x.lo                 begin                         end                     x.hi
//    |~~~ shallow ~~~|guard|. . . . particles . . . . .|guard|~~~ shallow ~~~~~~|
//
// An end of the window stands at a wall of a closed channel or has a guard before it, which lies in the channel and meets no
// obstacle.

#include <cstddef>
#include <optional>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/fluid_model.hpp"
#include "fluid_server/shallow_water/grid.hpp"

namespace wade::fluid::mixed {

struct Window {
    std::size_t begin = 0, end = 0;  // cells along x; equal: there are no particles

    [[nodiscard]] bool empty() const { return begin == end; }
    [[nodiscard]] bool holds(std::size_t i) const { return i >= begin && i < end; }
    friend bool operator==(const Window&, const Window&) = default;
};

// Says where the window has to be.
class WindowRule {
 public:
    WindowRule(const Scene& scene, const shallow_water::Grid& grid);

    // What the keys of the scene and its obstacles need, in cells; empty if nothing.
    [[nodiscard]] Window lasting() const { return lasting_; }

    // The extent that walking agents in the channel or within the margin of it need, margin included, m.
    [[nodiscard]] std::optional<Interval> needed_by(const AgentsView& agents) const;

    // The window that follows `now`: it spans `lasting` and `agents` at once, and is drawn in once an end is two chunks too
    // far out.
    [[nodiscard]] Window next(const Window& now, const std::optional<Interval>& agents) const;

    [[nodiscard]] double guard() const { return guard_; }  // length, m
    [[nodiscard]] bool ends_are_walls() const { return ends_are_walls_; }

 private:
    // Returns the smallest window that spans [begin, end) and has room for its guards.
    [[nodiscard]] Window with_room(std::ptrdiff_t begin, std::ptrdiff_t end) const;
    [[nodiscard]] bool guard_meets_obstacle(double from, double to) const;

    Scene scene_;
    shallow_water::Grid grid_;
    double guard_;
    double margin_;
    std::ptrdiff_t chunk_;  // in cells
    bool ends_are_walls_;
    Window lasting_;
};

}  // namespace wade::fluid::mixed
