#pragma once
// The energy of the water and the work done on it, from what can be seen between two steps.
//
//   energy    E = sum over the fluid particles of m (v^2 / 2 + g' y),  g' = g cos(atan slope)
//   carried out by particles that pass the outflow: their energy when last seen
//   put in    emitter: energy of the particles that pass the opening, and F . v of the force F with which the lattice
//             behind it drives the water (from the change of momentum: no other force acts along x there)
//             drive of a recirculating channel: M a dt (v - a dt / 2), v the bulk speed after the push a dt
//             slope: g sin(atan slope) times the displacement along -x
//
// Most potential energy cannot become motion: water never lies lower than a level pool. In a closed channel the kinetic
// energy is therefore compared with what was put in less the potential energy of the same volume in such a pool.
//
// Friction, viscosity and contact only take energy away. The emitter's force is wrong where obstacles or bed friction
// push along x as well, so scenes with an emitter have none.

#include "configs/scene/scene.hpp"
#include "fluid_server/dfsph/fluid_world.hpp"

namespace wade::stability {

// Height of the bed at x, m; ends of its polyline go on level.
[[nodiscard]] double bed_height(const Channel& channel, double x);

// Potential energy, J, of a volume of water, m^3, that fills the scene's channel from its lowest point up to one level,
// bed and obstacles left free, as if all basins were connected: the least that this volume can have. Positions are
// resolved to half a spacing along x and z.
[[nodiscard]] double level_pool_energy(const Scene& scene, double volume);

class EnergyBudget {
 public:
    // The state that the budget starts from.
    explicit EnergyBudget(const fluid::FluidWorld& world);

    // After each step.
    void note_step(const fluid::FluidWorld& world, const fluid::StepReport& step);

    [[nodiscard]] double ratio() const;          // present energy and what was carried out, over what was put in
    [[nodiscard]] double kinetic_ratio() const;  // present kinetic energy over what could become kinetic
    [[nodiscard]] double put_in() const { return put_in_; }  // J
    // What was put in less what must stay potential, J: 0 is subtracted unless the channel is closed. A level surface is
    // known to half a spacing only, so it is never less than the energy of waves that high, rho g' A d^2 / 8.
    [[nodiscard]] double convertible() const;

    // Adds to what was put in, J: energy that a case has stored at the start and that is not kinetic or potential, or the
    // work of a force of its own.
    void add(double energy) { put_in_ += energy; }

 private:
    // Sums over the fluid particles, without particles still inside the emitter.
    struct Sums {
        double count = 0;
        double kinetic = 0, potential = 0;  // J
        double momentum = 0;                // along x, kg m/s
        double leaving = 0;                 // J, of particles that the next step removes
        double leaving_momentum = 0, leaving_count = 0;
        double inflow_velocity = 0;  // along -x, of particles inside the emitter, m/s
    };
    [[nodiscard]] Sums sum(const fluid::FluidWorld& world) const;
    void note_emitter(const fluid::FluidWorld& world, const Sums& now);

    double gravity_across_, gravity_along_;  // m/s^2
    double mass_;                            // of a particle, kg
    Sums last_;
    double put_in_ = 0, carried_out_ = 0;  // J
    double resting_ = 0;                   // J, of the level pool
    double surface_energy_ = 0;            // J, rho g' A d^2 / 8
};

}  // namespace wade::stability
