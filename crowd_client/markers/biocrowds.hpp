#pragma once
// BioCrowds: agents compete for the markers of the ground and walk towards the mean of their own markers.

#include <memory>

#include "crowd_client/markers/markers.hpp"
#include "crowd_client/markers/walkers.hpp"

namespace wade::crowd {

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
// sums up Eq. 1-3 over the markers of each walker. Fixed markers are summed in double precision, cell by cell; drawn
// ones in single precision.
// period: World::period(); if above 0, walkers perceive the markers beyond the periodic boundary. Needs markers placed
// for it.
void find_motion(Motion& motion, MarkerMemory& memory, const Markers& markers, const Walkers& walkers,
                 double perception_radius, double period = 0, int threads = 1);

}  // namespace wade::crowd
