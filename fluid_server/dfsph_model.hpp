#pragma once
// The solved water (FluidWorld) as a model of the server.

#include "fluid_server/fluid_model.hpp"
#include "fluid_server/fluid_world.hpp"

namespace wade::fluid {

class DfsphModel final : public FluidModel {
 public:
    explicit DfsphModel(const Scene& scene) : world_(scene) {}

    [[nodiscard]] std::string_view name() const override { return "dfsph"; }
    [[nodiscard]] std::uint32_t capacity() const override;
    shm::Diagnostics advance_frame(const FrameInterval& interval) override;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override;
    [[nodiscard]] std::string remarks() const override;

    [[nodiscard]] const FluidWorld& world() const { return world_; }

 private:
    FluidWorld world_;
};

}  // namespace wade::fluid
