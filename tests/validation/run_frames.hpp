#pragma once
// Runs a shipped scene without a crowd.

#include <filesystem>
#include <string>

#include "configs/scene_loader.hpp"
#include "fluid_server/fluid_world.hpp"

namespace wade::fluid::test {

inline Scene shipped_scene(const std::string& name) {
    return load_scene(std::filesystem::path(WADE_CONFIGS) / name).scene;
}

// Advances to the next frame and calls on_step(report) after each sub-step.
template <typename OnStep>
void advance_one_frame(FluidWorld& world, OnStep&& on_step) {
    const double frame = 1 / world.scene().frame_rate;
    double remaining = frame;
    while (remaining > 1e-9 * frame) {
        const StepReport report = world.step(remaining);
        remaining -= report.dt;
        on_step(report);
    }
}

}  // namespace wade::fluid::test
