#pragma once
// Particles near people and obstacles, shallow water elsewhere, as a model of the server.

#include <optional>

#include "configs/scene/interval.hpp"
#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"
#include "fluid_server/mixed/mixed_world.hpp"

namespace wade::fluid::mixed {

// How well the two waters agreed on what passed between them.
struct Closure {
    double volume = 0;    // |owed at the end| over what passed through the ends of the window, by the grid
    double most = 0;      // largest |owed| of an end, m^3
    double momentum = 0;  // |carried by grid - by particles| over what the grid carried
    double passed = 0;    // m^3
};
[[nodiscard]] Closure closure_of(const MixedWorld& world);

class MixedModel final : public FluidModel {
 public:
    explicit MixedModel(const Scene& scene) : world_(scene) { world_.columns().count(world_.grid_water()); }

    [[nodiscard]] static Estimate estimate(const Scene& scene);

    [[nodiscard]] std::string_view name() const override { return "mixed"; }
    [[nodiscard]] std::uint32_t capacity() const override;
    [[nodiscard]] std::array<double, 2> column_width() const override { return world_.columns().width(); }
    void take_agents(const AgentsView& agents) override {
        needed_ = world_.rule().needed_by(agents);
        take_pushes(agents, world_.people());
    }
    shm::Diagnostics advance_frame(const FrameInterval& interval) override;

    // Columns of the grid outside the window; in it the particles, those round its ends with the share of their mass that
    // counts to it (account.hpp).
    std::uint32_t write_frame(const shm::FrameFields& slot) const override;
    [[nodiscard]] std::string remarks() const override;

    [[nodiscard]] const MixedWorld& world() const { return world_; }
    [[nodiscard]] MixedWorld& world() { return world_; }

 private:
    void add(const MixedStep& step, shm::Diagnostics& d);

    MixedWorld world_;
    std::optional<Interval> needed_;  // by the agents taken last
    double time_ = 0;                 // s
    double awake_ = 0;                // integral of the window's length, m s
    std::uint64_t most_particles_ = 0;
};

}  // namespace wade::fluid::mixed
