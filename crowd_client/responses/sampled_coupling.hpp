#pragma once
// The rule `continuous` with the water sampled several times a step, along the path of the agent and of the particles.
//
// An agent that particles push goes with them and stays in contact with them for longer than one that stands still
// would. On average it meets more along its path (Lagrangian mean) than a fixed point does (Eulerian mean), as with the
// drift under waves (Stokes 1847). Steps longer than a particle takes to pass an agent, 0.5 m over their difference in
// speed, miss this. So the contact is computed every 1 / sampling_rate_hz, with each particle moved on from its
// position in the frame at its own velocity:
//
//   x_i(s) = x_i + f v_i s,   f = 1, or the transport_factor of kinematic water
//
// This is exact for kinematic water, and for solved water except for its acceleration within a step. s counts from the
// start of the step: with steps shorter than frames, particles still wait for their next frame.

#include "crowd_client/agents.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

// Sampling of the water in a scene.
struct Sampling {
    int samples = 1;       // in a step of the crowd; 1: as the frame has it, once
    double transport = 1;  // f
};

// samples: dt of the crowd times sampling_rate_hz, rounded up.
[[nodiscard]] Sampling sampling_of(const Scene& scene);

// State of an agent at the start of a step.
struct Walker {
    Vector2d position;  // m
    Vector2d velocity;  // v(t), m/s
    Vector2d walking;   // v_B, m/s
    double mass = 0;    // kg
    double tau = 0;
};

// Computes Eq. 5 with the particles at their positions a time after the start of the step, s. Finds all that move by
// less than 2 m less the contact distance within this time. A position outside the world is taken at its edge.
[[nodiscard]] Contact contact_after(const WaterBins& bins, const World& world, const Vector2d& place, double distance,
                                    double time, double transport);

// Computes relaxed_velocity() in `sampling.samples` equal parts of a step of length dt, each with the contact at its
// start.
[[nodiscard]] RelaxedVelocity sampled_velocity(const WaterBins& bins, const Scene& scene, const Sampling& sampling,
                                               const Walker& walker, double dt);

}  // namespace wade::crowd
