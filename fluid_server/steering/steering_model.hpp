#pragma once
// The water of steering vehicles as a model of the server.

#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"
#include "fluid_server/steering/steering_world.hpp"

namespace wade::fluid {

class SteeringModel final : public FluidModel {
 public:
    explicit SteeringModel(const Scene& scene) : world_(scene), bed_(bed_facets(scene.channel)) {}

    [[nodiscard]] static Estimate estimate(const Scene& scene);

    [[nodiscard]] std::string_view name() const override { return "steering"; }
    [[nodiscard]] std::uint32_t capacity() const override;
    shm::Diagnostics advance_frame(const FrameInterval& interval) override;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override;
    [[nodiscard]] std::string remarks() const override;

    [[nodiscard]] const steering::SteeringWorld& world() const { return world_; }

 private:
    void measure(shm::Diagnostics& d) const;

    steering::SteeringWorld world_;
    std::vector<BedFacet> bed_;
    std::uint64_t frame_ = 0;
};

}  // namespace wade::fluid
