#pragma once
// Ragdolls of characters that the water tumbles: data for animators, which move no agent.
//
// Source: Schaffer, Antonitsch, Neto, Musse, MIG 2020, section 4.1: a ragdoll is enabled for tau >= 0.8 and v_F > 2 m/s;
// its hip has the mean height of all colliding particles and turns about all axes at a rate that follows the particles'
// speed, increased by a random number in [0.1, 0.5]. Interpreted here as:
//   colliding    the particles of Eq. 5, which move the agent
//   mean         over these particles, in each step; the output follows it 0.5 s behind, without jumps
//                (people/pose.hpp), and stays in steps without such particles. (Their program: over 120 frames.)
//   rate         about x, y and z, in rad/s: the component of the mean particle velocity along that axis in m/s, plus
//                U(0.1, 0.5), one number for each agent and axis, for good; with random_sign plus or minus, as in their
//                program
//   v_F          the velocity that the scene gives the channel, at the time of the step
//   enabled      once the condition holds and particles collide in half of the last 0.3 s, low-passed, until in less
//                than a fifth

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/people/pose.hpp"
#include "crowd_client/water/contacts.hpp"

namespace wade::crowd {

inline constexpr double ragdoll_pace = 4;  // w of hips and rates, 1/s: 0.5 s behind

struct Ragdoll {
    std::uint32_t id = 0;          // of the agent
    double hip_height = 0;         // y, m
    std::array<double, 3> rate{};  // about x, y and z, rad/s
};

[[nodiscard]] inline bool has_ragdolls(const Scene& scene) {
    return scene.crowd->ragdoll.condition != RagdollCondition::off;
}

// Whether the rule's condition holds. v_f: of the channel, m/s; met: the water in the agent's cell.
[[nodiscard]] bool ragdoll_holds(const RagdollRule& rule, double tau, double v_f, const CellWater& met);

// The random part of the rate of the hip about x, y and z, rad/s. Draws are those of (seed, agent, axis).
[[nodiscard]] Vector3d random_rate(bool random_sign, std::uint64_t seed, std::uint32_t agent);

// Memory of an agent's ragdoll.
struct Tumbling {
    LastingCondition enabled;
    bool is_new = true;                                 // no particle has collided recently
    TouchingMean last;                                  // of the last step with collisions
    Smoothed<double> height{0, 0};                      // m
    Smoothed<Vector3d> velocity{{0, 0, 0}, {0, 0, 0}};  // m/s
};

// Updates the memory after a step of dt; touching: the particles that collide in it while the condition holds, else
// none.
void tumble_on(Tumbling& tumbling, const TouchingMean& touching, double dt);

// Finds the ragdolls of a step, ids ascending. active: ids; positions: theirs at the start of the step; water: with
// heights; tumbling: by id.
void find_ragdolls(std::vector<Ragdoll>& ragdolls, std::vector<Tumbling>& tumbling, const Scene& scene,
                   const Agents& agents, std::span<const std::uint32_t> active, std::span<const Vector2d> positions,
                   const WaterBins& water, std::uint64_t step);

}  // namespace wade::crowd
