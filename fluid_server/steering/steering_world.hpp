#pragma once
// A water of vehicles that steer by their neighbours: the whole state and the step that advances it.
//
// A step, forward Euler as Reynolds (1999) writes it:
//   steering force = flock (flock_sweep.hpp) + walls (walls.hpp), truncated to max_force
//   v <- truncate(v + dt (force / mass + gravity), max_speed), then bodies and the restriction by walls
//   x <- x + dt v
//
// Lists of neighbours reach further than the neighbourhoods by a margin and serve until two particles may have moved
// by the margin against one another. A river that moves as a whole keeps its lists.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/neighbours/neighbours.hpp"
#include "fluid_server/particles/channel_ends.hpp"
#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/particles/solids.hpp"
#include "fluid_server/steering/bodies.hpp"
#include "fluid_server/steering/flock_sweep.hpp"
#include "fluid_server/steering/settings.hpp"
#include "fluid_server/steering/walls.hpp"

namespace wade::fluid::steering {

struct SteeringStep {
    double dt = 0;                    // s
    double driving_acceleration = 0;  // m/s^2, towards -x; recirculating channels
    double max_displacement = 0;      // m, the longest way of a particle
    bool new_lists = false;
};

// Kinetic energy, and potential energy of gravity above y = 0, of the pairs and of the push of walls, J.
struct Energies {
    double kinetic = 0, gravity = 0, pairs = 0, walls = 0;
    [[nodiscard]] double total() const { return kinetic + gravity + pairs + walls; }
};

class SteeringWorld {
 public:
    explicit SteeringWorld(const Scene& scene);

    // Advances by at most `remaining` seconds, by a whole fraction of it. Throws RunError (numerical_failure) if something is
    // no longer finite.
    SteeringStep step(double remaining);

    [[nodiscard]] double time() const { return time_; }  // s
    // Between two steps a particle may be less than a margin beyond a periodic border, or the outflow.
    [[nodiscard]] const Particles& particles() const { return particles_; }
    [[nodiscard]] Particles& particles() { return particles_; }
    [[nodiscard]] bool has_left(std::size_t i) const { return !(particles_.x[i] > ends_->outflow_x()); }
    [[nodiscard]] Vec3 place(std::size_t i) const;  // within the periodic borders
    [[nodiscard]] double mass(std::size_t i) const {
        return particle_mass_ * static_cast<double>(mass_factors(particles_)[i]);
    }
    [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
    [[nodiscard]] const Settings& settings() const { return settings_; }
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] EmitterState emitter() const { return ends_->state().value_or(EmitterState{}); }
    [[nodiscard]] std::uint64_t position_clamps() const { return position_clamps_; }
    // Neighbours nearer than the longest radius, a particle, itself left out; of the energies that of the pairs costs as much.
    [[nodiscard]] double neighbours() const;
    [[nodiscard]] Energies energies() const;

 private:
    [[nodiscard]] double time_step(double remaining);
    void make_lists();
    void set_classes(std::size_t begin);
    void accelerate(float dt);
    void drive(SteeringStep& report);
    void let_in(double dt);
    // A particle's place, or that of its image beyond a periodic border which is nearer to the body.
    [[nodiscard]] Vec3 nearest_image(std::size_t i, const Body& body) const;
    void push_by_bodies(float dt);
    void move_bodies(double dt);
    void advance(float dt, SteeringStep& report);
    template <typename OnPair>
    void for_each_neighbour(OnPair&& on_pair) const;

    Scene scene_;
    Settings settings_;
    double margin_;  // m
    double particle_mass_;
    Particles particles_;
    CellGrid grid_;
    NeighbourLists lists_;
    Solids solids_;
    Solids no_solids_;  // for lists without images
    Walls walls_;
    std::vector<BedFacet> bed_;
    std::vector<Body> bodies_;
    std::unique_ptr<ChannelEnds> ends_;
    std::vector<float> ax_, ay_, az_;
    double gravity_x_, gravity_y_;  // m/s^2, tilted by the slope of the bed
    Vec3 period_{};                 // m; 0 where the axis is not periodic
    double time_ = 0;
    std::uint64_t position_clamps_ = 0;
    std::uint64_t born_ = 0;  // particles so far, for the draw of their class
    bool lists_serve_ = false;

    // Of a step: how far particles have moved since the lists were made, and guards.
    struct Moves {
        Vec3 least{Box::inf, Box::inf, Box::inf}, most{-Box::inf, -Box::inf, -Box::inf};
        std::uint64_t clamps = 0, not_finite = 0;
        float longest_squared = 0;
    };
    BlockSums<Moves> moves_;
    BlockSums<float> fastest_;
    BlockSums<std::vector<Momentum>> reactions_;
    std::vector<Momentum> reaction_;
};

}  // namespace wade::fluid::steering
