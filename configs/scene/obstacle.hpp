#pragma once
// Boxes that stand in the channel.

#include "configs/scene/interval.hpp"

namespace wade {

// A solid box that stands on the bed, for the water and for the crowd.
struct Obstacle {
    Interval x, z;
    double height = 1;
};

}  // namespace wade
