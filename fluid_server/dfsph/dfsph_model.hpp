#pragma once
// The solved water (FluidWorld) as a model of the server.

#include <optional>

#include "fluid_server/dfsph/bed_friction.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"
#include "fluid_server/maps/flood_maps.hpp"
#include "fluid_server/particles/river_measures.hpp"
#include "fluid_server/people/pushes.hpp"

namespace wade::fluid {

class DfsphModel final : public FluidModel {
 public:
    explicit DfsphModel(const Scene& scene);

    [[nodiscard]] static Estimate estimate(const Scene& scene);

    [[nodiscard]] std::string_view name() const override { return "dfsph"; }
    [[nodiscard]] std::uint32_t capacity() const override;
    void take_agents(const AgentsView& agents) override;
    shm::Diagnostics advance_frame(const FrameInterval& interval) override;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override;
    [[nodiscard]] std::string remarks() const override;
    [[nodiscard]] const FluidState* state() override;
    [[nodiscard]] FailureStates states_before_failure() const override;
    void restore(const FluidState& state, const std::string& source) override;
    void write_results(const std::filesystem::path& folder) const override;

    [[nodiscard]] const FluidWorld& world() const { return world_; }

 private:
    StepReport step(double remaining);
    void keep_state();
    [[nodiscard]] RiverMeasures measure() const;
    void add_to_maps();

    FluidWorld world_;
    std::vector<BedFacet> bed_;
    GroundAt ground_;
    // Of a site.
    std::optional<WaterColumns> columns_;
    std::optional<FloodMaps> maps_;
    PeopleInWater people_;
    // The state at the start of the frame, and the last sound one before it: a run can continue from it with better
    // settings. One copy a frame, 33 bytes a particle, 0.1 % of the CPU time of a frame; the second costs a swap.
    FluidState kept_;
    FluidState sound_;
    bool kept_is_sound_ = false;
    bool has_sound_ = false;
    std::uint64_t frame_ = 0;  // frames since the water's t = 0
    bool failed_ = false;
};

}  // namespace wade::fluid
