#pragma once
// The world of a scene: walkable ground, gravity, ends.

namespace wade {

enum class Ends {
    open,     // the world ends at x = 0, the fall, and at x = length
    periodic  // x = length is x = 0 again
};

// Walkable ground, [0, length] x [0, width].
struct World {
    double length = 100;
    double width = 50;
    double gravity = 9.81;
    Ends ends = Ends::open;

    // Length after which the world repeats along x, m; 0 where it does not.
    [[nodiscard]] double period() const { return ends == Ends::periodic ? length : 0; }
};

}  // namespace wade
