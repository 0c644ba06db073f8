#pragma once
// BioCrowds: agents compete for the markers of the ground and walk towards the mean of those they own.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "crowd_client/equations.hpp"
#include "crowd_client/markers/markers.hpp"

namespace wade::crowd {

// The active agents in the order of their ids; nobody else claims markers. One value a walker in each list.
struct Walkers {
    std::span<const Vector2d> position;     // in the world, m
    std::span<const Vector2d> goal_offset;  // goal - position, m

    // Empty, or for walkers with bodies (see bodies.hpp):
    std::span<const Vector2d> site;         // where they claim markers, less than 2 m - R away from them, m
    std::span<const Vector2d> velocity;     // displacement of the last step / dt, m/s
    std::span<const double> desired_speed;  // m/s
    std::span<const double> discount;       // delta: a contested marker counts 1 - delta
    double contest_distance = 0;            // D, m
};

// What the markers say, by walker.
struct Motion {
    std::vector<Vector2d> vector;          // m of Eq. 1, m; zero without markers
    std::vector<std::uint32_t> owned;      // markers
    std::vector<std::uint32_t> contested;  // of them; only with bodies
    std::uint64_t pair_tests = 0;          // distances of a marker and a walker that were looked at
};

// Working memory that is kept from step to step; a copy starts with memory of its own.
struct MarkerWork;
class MarkerMemory {
 public:
    MarkerMemory();
    ~MarkerMemory();
    MarkerMemory(const MarkerMemory&) : MarkerMemory() {}
    MarkerMemory(MarkerMemory&&) noexcept;
    MarkerMemory& operator=(const MarkerMemory&) { return *this; }
    MarkerMemory& operator=(MarkerMemory&&) noexcept;
    [[nodiscard]] MarkerWork& operator*() { return *work_; }

 private:
    std::unique_ptr<MarkerWork> work_;
};

// Gives each marker to the nearest walker within `perception_radius`, ties to the one that comes first in the list, and
// sums up Eq. 1-3 over the markers that each one owns.
// Fixed markers are summed in double precision, cell by cell; drawn ones in single precision.
// period: World::period(); where it is above 0, walkers see the markers beyond the joint. Needs markers placed for it.
void find_motion(Motion& motion, MarkerMemory& memory, const Markers& markers, const Walkers& walkers,
                 double perception_radius, double period = 0, int threads = 1);

}  // namespace wade::crowd
