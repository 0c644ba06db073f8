#include "crowd_client/water/water_view.hpp"

#include <array>
#include <cstdlib>

namespace wade::crowd {

WaterView ground_view(const shm::Frame& frame, const shm::StreamInfo& info) {
    const std::array<std::span<const float>, 3> position{frame.px, frame.py, frame.pz};
    const std::array<std::span<const float>, 3> velocity{frame.vx, frame.vy, frame.vz};
    const auto stored_axis = [&](std::size_t world_axis) {
        return static_cast<std::size_t>(std::abs(info.axes[world_axis]) - 1);
    };
    const auto scale = [&](std::size_t world_axis) {
        return info.axes[world_axis] < 0 ? -info.metres_per_unit : info.metres_per_unit;
    };
    WaterView view;
    view.mass = frame.mass;
    view.px = position[stored_axis(0)];
    view.py = position[stored_axis(1)];
    view.pz = position[stored_axis(2)];
    view.vx = velocity[stored_axis(0)];
    view.vy = velocity[stored_axis(1)];
    view.vz = velocity[stored_axis(2)];
    view.scale_x = scale(0);
    view.scale_y = scale(1);
    view.scale_z = scale(2);
    view.origin_x = info.origin[0];
    view.origin_y = info.origin[1];
    view.origin_z = info.origin[2];
    view.column = {info.column_width[0], info.column_width[1]};
    return view;
}

}  // namespace wade::crowd
