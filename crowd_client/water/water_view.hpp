#pragma once
// A frame of the water in the coordinates of the scene: the ground plane and the heights.

#include <cstddef>
#include <span>

#include "crowd_client/equations.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::crowd {

// Arrays in the shared memory, not copied; world coordinate = origin + scale * stored value, velocity = scale * stored
// value.
struct WaterView {
    std::span<const float> mass;        // kg
    std::span<const float> px, py, pz;  // stored units
    std::span<const float> vx, vy, vz;  // stored units per second
    // m per stored unit, negative for a mirrored axis
    double scale_x = 1, scale_y = 1, scale_z = 1;
    double origin_x = 0, origin_y = 0, origin_z = 0;  // m
    Vector2d column = Vector2d::Zero();               // width of a particle's column along x and z, m; 0: a point

    [[nodiscard]] std::size_t size() const { return mass.size(); }
};

// Picks the stored axes for the world's x, y and z. The axes of `info` must be a permutation of 1, 2, 3 with signs.
[[nodiscard]] WaterView ground_view(const shm::Frame& frame, const shm::StreamInfo& info);

}  // namespace wade::crowd
