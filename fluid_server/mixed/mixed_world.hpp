#pragma once
// Particles where they are needed, shallow water elsewhere.
//
//   shallow water   over the whole channel, all the time: it is cheap
//   particles       in a window (window.hpp), between guards that move as the shallow water does (guard.hpp)
//   both ways       the guards bring the stream in and carry it away; the cells of the window are drawn to the means of
//                   the particles (restriction.hpp), so that waves pass both ways; what the two disagree on at the ends
//                   of the window is booked and paid (account.hpp)
//
// One step: the time step of the particles; the shallow water up to its end; guards; a step of the particles, which get the
// driving acceleration of a recirculating channel from the shallow water; people; account; restriction. The particles' own step calls
// what comes before and after theirs, as the ends of their channel.

#include <array>
#include <optional>
#include <string_view>

#include "configs/scene/interval.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"
#include "fluid_server/mixed/account.hpp"
#include "fluid_server/mixed/guard.hpp"
#include "fluid_server/mixed/restriction.hpp"
#include "fluid_server/mixed/window.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/channel_ends.hpp"
#include "fluid_server/people/pushes.hpp"
#include "fluid_server/shallow_water/column_particles.hpp"
#include "fluid_server/shallow_water/step.hpp"
#include "fluid_server/stage_clock.hpp"

namespace wade::fluid::mixed {

enum class MixedStage : std::size_t {
    shallow_water,  // up to the end of the particles' step
    guards,         // bring the stream in and carry it away
    particles,      // their own step, the choice of its length among it
    account,        // what passed the ends, booked and paid
    restriction     // of the window's cells to the means of the particles
};
inline constexpr std::array<std::string_view, 5> mixed_stage_names{"shallow_water", "guards", "particles", "account",
                                                                   "restriction"};
using MixedStages = StageClock<MixedStage, mixed_stage_names.size()>;

struct MixedStep {
    double dt = 0;                        // s
    double driving_acceleration = 0;      // m/s^2, towards -x; recirculating channels
    std::optional<StepReport> particles;  // none while there is no window
    MixedStages::Seconds stages{};        // wall time, s
};

class MixedWorld final : private ChannelEnds {
 public:
    explicit MixedWorld(const Scene& scene);

    // Moves the window to where the agents need it: the extent they need, if any. Between steps.
    void need(const std::optional<Interval>& agents);

    // Advances by at most `remaining` s.
    MixedStep step(double remaining);

    [[nodiscard]] const shallow_water::ShallowWater& grid_water() const { return shallow_; }
    [[nodiscard]] shallow_water::ShallowWater& grid_water() { return shallow_; }
    [[nodiscard]] const FluidWorld& particle_water() const { return fluid_; }
    [[nodiscard]] shallow_water::ColumnParticles& columns() { return columns_; }
    [[nodiscard]] const shallow_water::ColumnParticles& columns() const { return columns_; }
    // Take their impulses from both waters.
    [[nodiscard]] PeopleInWater& people() { return people_; }
    [[nodiscard]] const WindowRule& rule() const { return rule_; }
    [[nodiscard]] const Window& window() const { return window_; }
    [[nodiscard]] const std::array<End, 2>& ends() const { return guards_.ends(); }
    [[nodiscard]] const std::array<EndAccount, 2>& accounts() const { return accounts_; }
    [[nodiscard]] const MomentumBook& momentum() const { return momentum_; }
    [[nodiscard]] double outflow() const { return outflow_; }  // over the fall, m^3
    [[nodiscard]] double inflow() const { return inflow_; }    // m^3

    // Of all water, m^3: changes by what enters and leaves the channel only.
    [[nodiscard]] double volume() const;

 private:
    // What the particles meet at the ends of their channel.
    void begin_step(Particles& particles, double time, double dt) override;
    void end_step(Particles& particles, std::span<const float> x_before, double dt) override;
    [[nodiscard]] std::optional<double> driving_acceleration(const Particles&, double, double) const override {
        return -acceleration_;
    }
    [[nodiscard]] bool carry_inflow() const override { return true; }

    // One step of the shallow water; its length, s.
    double shallow_step(double remaining, PeopleInWater* people, std::optional<double> driven_by = {});
    // What gives all water v_F again in a step of dt, where momentum is booked, m/s2 towards -x.
    [[nodiscard]] std::optional<double> driving_of_all(double dt);
    void book_people(double taken_before);
    void pay_momentum(double share);
    // Cells before an end of the window, as far as its guard reaches: [begin, end) along x.
    [[nodiscard]] std::array<std::size_t, 2> cells_before(std::size_t end) const;
    void book(const Particles& particles, std::span<const float> x_before);
    // People take the share of the frame from the particles of the window and the cells outside it, each with its weight.
    void push(const CellGrid& cells, Particles& particles, double duration, double gain);
    void change_window(const Window& to);
    void wake(const Window& window);
    void sleep();
    void move(const Window& to);
    void pay(double dt);

    double spacing_;
    shallow_water::ShallowWater shallow_;
    shallow_water::ColumnParticles columns_;
    WindowRule rule_;
    Guards guards_;
    Restriction restriction_;
    FluidWorld fluid_;
    std::vector<BedFacet> bed_;
    PeopleInWater people_;
    Window window_;
    std::array<EndAccount, 2> accounts_;
    MomentumBook momentum_;
    double acceleration_ = 0;  // m/s^2 along x
    double driving_ = 0;       // integral of the driving acceleration over the step at hand, m/s
    MixedStages::Seconds seconds_{};
    MixedStages stage_{seconds_};  // of the step at hand
    double inflow_ = 0, outflow_ = 0;
};

}  // namespace wade::fluid::mixed
