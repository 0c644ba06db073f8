#pragma once
// Input and result of the marker rule: the walkers that claim markers, and their motion.

#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/equations.hpp"

namespace wade::crowd {

// The active agents in the order of their ids; only they claim markers. One value a walker in each list.
struct Walkers {
    std::span<const Vector2d> position;     // in the world, m
    std::span<const Vector2d> goal_offset;  // goal - position, m

    // Empty, or for walkers with bodies (see bodies.hpp):
    std::span<const Vector2d> site;         // where they claim markers, less than 2 m - R from their position, m
    std::span<const Vector2d> velocity;     // displacement of the last step / dt, m/s
    std::span<const double> desired_speed;  // m/s
    std::span<const double> discount;       // delta: a contested marker counts 1 - delta
    double contest_distance = 0;            // D, m
};

// Result of Eq. 1-3, by walker.
struct Motion {
    std::vector<Vector2d> vector;          // m of Eq. 1, m; zero without markers
    std::vector<std::uint32_t> owned;      // markers
    std::vector<std::uint32_t> contested;  // of them; only with bodies
    std::uint64_t pair_tests = 0;          // tested distances of a marker and a walker
};

}  // namespace wade::crowd
