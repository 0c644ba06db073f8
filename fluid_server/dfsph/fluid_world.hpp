#pragma once
// The whole state of the fluid and the step that advances it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/dfsph/bed_friction.hpp"
#include "fluid_server/dfsph/dfsph.hpp"
#include "fluid_server/dfsph/midpoint.hpp"
#include "fluid_server/dfsph/step_measures.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/channel_ends.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/particles/site/site_solids.hpp"
#include "fluid_server/particles/solids.hpp"
#include "fluid_server/particles/water_depth.hpp"
#include "fluid_server/stage_clock.hpp"
#include "fluid_server/states/fluid_state.hpp"

namespace wade::fluid {

enum class Stage : std::size_t {
    sort,        // by cell
    people,      // take their impulses
    neighbours,  // neighbour lists of the clusters
    density,     // kernel, density, diagonal, sums of viscosity
    forces,      // viscosity, gravity, friction
    divergence_solve,
    density_solve,
    contact,  // with solids, at the end of either solve
    advance   // new positions, emitter
};
inline constexpr std::array<std::string_view, 9> stage_names{
    "sort", "people", "neighbours", "density", "forces", "divergence_solve", "density_solve", "contact", "advance"};
using StepStages = StageClock<Stage, stage_names.size()>;

struct StepReport {
    double dt = 0;  // s
    SolveResult divergence;
    SolveResult density;
    double mean_density_error = 0;  // of max(0, rho / rho_0 - 1) over particles, at the start of the step
    double max_density_error = 0;
    double driving_acceleration = 0;  // m/s^2, towards -x; recirculating channels
    double contact_force = 0;         // N, vertical force of contact on bed and obstacles, positive downwards
    double max_displacement = 0;      // m, the longest way of a particle in the step
    int sweeps = 0;                   // over all pairs
    StepStages::Seconds stages{};     // wall time, s
};

// Of the particles of a block that touched an obstacle: the sum of the velocities that it took, divided by dt, m/s^2.
struct ContactSum {
    std::uint32_t obstacle = 0;
    std::array<double, 3> change{};
};

class FluidWorld {
 public:
    // Builds the fluid of the scene at t = 0.
    explicit FluidWorld(const Scene& scene) : FluidWorld(scene, nullptr) {}

    // ends: replace the channel ends of the scene and must outlive the world. The world is empty at first and its
    // channel must not be periodic along x.
    FluidWorld(const Scene& scene, ChannelEnds& ends) : FluidWorld(scene, &ends) {}

    // Lets `body` add, remove and change particles; between steps.
    template <typename Body>
    void change_particles(Body&& body) {
        body(particles_);
    }

    // Gives every particle the velocity, m/s, of a field at its place; before the first step.
    void set_velocity(const std::function<std::array<double, 3>(const std::array<double, 3>& place)>& field);

    // Lets others change velocities in each step, before forces do. grid: of the particles, sorted; duration: how long this lasts,
    // s; gain: how many times a change made now counts at the end of the step (midpoint.hpp).
    using Pushers = std::function<void(const CellGrid& grid, Particles& particles, double duration, double gain)>;
    void push_with(Pushers pushers) { pushers_ = std::move(pushers); }

    // Advances by at most `remaining` seconds; the time step is a whole fraction of it, so that repeated calls end
    // exactly on the frame. Throws RunError (numerical_failure) if a velocity runs away or is no longer finite.
    StepReport step(double remaining);

    // Copies the state into one made by a former call or into a fresh FluidState; `frame` is left as it is. Allocates in
    // the first call only. Between steps.
    void capture(FluidState& state) const;

    // Goes on from a state. Throws ConfigurationError, beginning with `source`, if it does not fit (check_state_fits).
    void restore(const FluidState& state, const std::string& source);

    [[nodiscard]] double time() const { return time_; }  // s, since the water's t = 0
    [[nodiscard]] const Particles& particles() const { return particles_; }
    [[nodiscard]] const std::optional<SiteSolids>& site() const { return site_; }
    [[nodiscard]] const ParticleFields& fields() const { return fields_; }
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] float particle_mass() const { return particle_mass_; }  // rho_0 d^3, kg
    [[nodiscard]] const ChannelEnds& ends() const { return *ends_; }
    [[nodiscard]] EmitterState emitter() const { return ends_->state().value_or(EmitterState{}); }
    // Vertical pressure force on the bed in the last step, N; costs a sweep, valid until the next step.
    [[nodiscard]] double bed_pressure_force() const;
    // Force of the water on the faces of an obstacle, on a site of a house, in the last step, N: pressure, viscosity,
    // contact. Costs a sweep, valid until the next step.
    [[nodiscard]] std::array<double, 3> obstacle_force(std::size_t obstacle) const;
    // Pairs of a particle and a neighbour or image nearer than the support radius in the last step, both directions counted,
    // and the bytes of its lists. Cost a sweep.
    [[nodiscard]] std::uint64_t pairs() const;
    [[nodiscard]] std::uint64_t list_bytes() const;
    [[nodiscard]] std::uint64_t position_clamps() const { return position_clamps_; }

 private:
    FluidWorld(const Scene& scene, ChannelEnds* ends);  // null: those of the scene

    // Of the step at hand.
    struct Plan {
        float dt = 0;        // s
        float share = 1;     // of a step of CFL 0.5, see PressureSolver::solve_divergence
        bool split = false;  // two solves: the second moves positions only
        float theta = 0;     // of velocities centred in time (midpoint.hpp)

        // How long forces act until velocities are made free of divergence, s.
        [[nodiscard]] float to_midpoint() const { return dt / (1 + theta); }
        // Contact changes velocities before the density solve, unless that still changes them.
        [[nodiscard]] bool contact_comes_first() const { return split && theta == 0; }
    };
    [[nodiscard]] Plan plan_step(double remaining, StepReport& report);

    // The stages of a step.
    void sort(double dt);
    void find_densities(StepReport& report);
    void push(const Plan& plan);
    void apply_forces(const Plan& plan, StepReport& report);
    void solve_divergence(const Plan& plan, StepReport& report);
    void solve_density(const Plan& plan, StepReport& report);
    void apply_contact(const Plan& plan, StepReport& report);
    void advance(const Plan& plan, StepReport& report);

    // Moves the particles by dt (v + shift_time a), a the accelerations of the last solve.
    void move(float dt, float shift_time, StepReport& report);
    void touch_solids(float dt, StepReport& report);
    [[nodiscard]] PressureSystem system();
    void find_neighbours();
    void relax();                                          // the water of a site at t = 0
    [[nodiscard]] Places places(std::size_t begin) const;  // from a particle on

    Scene scene_;
    float support_radius_;
    float volume_;
    float particle_mass_;
    Kernel kernel_;
    double viscosity_;  // nu over the kernel's second moment on the lattice, m^2/s
    bool confined_;     // the water has no free surface
    Particles particles_;
    CellGrid grid_;
    NeighbourLists lists_;
    ParticleFields fields_;
    GradientCorrection correction_;  // of confined water
    StartVelocities start_;          // of confined water
    Solids solids_;
    std::optional<SiteSolids> site_;  // instead of these, on a site
    std::optional<PressureSolver> solver_;
    std::unique_ptr<ChannelEnds> own_ends_;  // none where others stand in for them
    ChannelEnds* ends_;
    std::optional<BedFriction> friction_;
    Pushers pushers_;
    double gravity_x_, gravity_y_;  // m/s^2: gravity tilted by the slope of the bed
    WaterDepth depth_;
    double lowest_ground_;      // m, of a site
    bool relaxes_ = false;      // still has to
    double initial_speed_ = 0;  // of the fastest particle, m/s
    std::uint64_t position_clamps_ = 0;
    double time_ = 0;

    struct Guards {
        std::uint64_t clamps = 0, not_finite = 0;
        float longest_squared = 0;  // m^2
    };
    StepMeasures measures_;
    BlockSums<double> sums_;
    BlockSums<Guards> guards_;
    BlockSums<std::vector<ContactSum>> contact_sums_;
    // Momentum that contact with each obstacle took in the last step, divided by dt, N.
    std::vector<std::array<double, 3>> contact_forces_;
};

}  // namespace wade::fluid
