#pragma once
// The shallow-water equations as a model of the server.

#include <optional>

#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"
#include "fluid_server/maps/flood_maps.hpp"
#include "fluid_server/shallow_water/column_particles.hpp"
#include "fluid_server/shallow_water/step.hpp"

namespace wade::fluid::shallow_water {

class ShallowWaterModel final : public FluidModel {
 public:
    explicit ShallowWaterModel(const Scene& scene) : world_(scene), particles_(world_) { begin_maps(); }

    [[nodiscard]] static Estimate estimate(const Scene& scene);

    [[nodiscard]] std::string_view name() const override { return "shallow_water"; }
    [[nodiscard]] std::uint32_t capacity() const override { return particles_.capacity(); }
    [[nodiscard]] std::array<double, 2> column_width() const override { return particles_.width(); }
    void spread_over(Ranks& ranks) override;
    void take_agents(const AgentsView& agents) override {
        take_pushes(agents, people_);
        particles_.show_near(agents);
    }
    shm::Diagnostics advance_frame(const FrameInterval& interval) override;
    std::uint32_t write_frame(const shm::FrameFields& slot) const override { return particles_.write(world_, slot); }
    [[nodiscard]] std::string remarks() const override;
    void write_results(const std::filesystem::path& folder) const override;

    [[nodiscard]] const ShallowWater& world() const { return world_; }

 private:
    void begin_maps();
    void add_to_maps();

    ShallowWater world_;
    ColumnParticles particles_;
    PeopleInWater people_;
    std::optional<FloodMaps> maps_;    // of a site
    double at_first_ = 0;              // m^3 at t = 0
    double inflow_ = 0, outflow_ = 0;  // m^3 since then
    double cell_steps_ = 0;
};

// Measures of all water, see shm::Diagnostics; NaN where there is none.
struct Measures {
    double mean_depth = 0;        // m, twice the mean height of the mass above the bed
    double mean_speed = 0;        // m/s, towards -x
    double kinetic_energy = 0;    // J
    double potential_energy = 0;  // J, above y = 0
    double volume = 0;            // m^3
};
[[nodiscard]] Measures measure(const ShallowWater& world);

// Writes them into the diagnostics of a frame, with its mean driving acceleration, m/s^2, where the channel has one, and the
// outflow since t = 0, m^3, in particles.
void note_water(const ShallowWater& world, double driving_acceleration, double outflow, shm::Diagnostics& d);

}  // namespace wade::fluid::shallow_water
