#pragma once
// Where the water tumbles a character, and how: data for animators, by which no agent is moved.
//
// Source: Schaffer, Antonitsch, Neto, Musse, MIG 2020, section 4.1: a ragdoll is enabled for tau >= 0.8 and v_F > 2 m/s;
// its hip has the mean height of all colliding particles and turns about all axes at a rate that follows the particles'
// speed, increased by a random number in [0.1, 0.5]. Read here as:
//   colliding    the particles of Eq. 5, those that move the agent in this step; without any there is no ragdoll
//   mean         over these particles, of one step (their program takes it over 120 frames)
//   rate         about x, y and z, in rad/s: the component of the mean particle velocity along that axis in m/s, plus
//                U(0.1, 0.5), one number for each axis; with random_sign plus or minus, as in their program
//   v_F          the velocity that the scene gives the channel, at the time of the step

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd_client/agents.hpp"
#include "crowd_client/water/contacts.hpp"

namespace wade::crowd {

struct Ragdoll {
    std::uint32_t id = 0;          // of the agent
    double hip_height = 0;         // y, m
    std::array<double, 3> rate{};  // about x, y and z, rad/s
};

[[nodiscard]] inline bool has_ragdolls(const Scene& scene) {
    return scene.crowd.ragdoll.condition != RagdollCondition::off;
}

// Whether the rule's condition holds. v_f: of the channel, m/s; met: the water in the agent's cell.
[[nodiscard]] bool ragdoll_holds(const RagdollRule& rule, double tau, double v_f, const CellWater& met);

// Rate of the hip, rad/s. velocity: mean of the particles in contact, m/s. Draws are those of (seed, agent, step, axis).
[[nodiscard]] std::array<double, 3> hip_rate(const std::array<double, 3>& velocity, bool random_sign,
                                             std::uint64_t seed, std::uint32_t agent, std::uint64_t step);

// The ragdolls of a step, ids ascending. active: ids; positions: theirs at the begin of the step; water: with heights.
void find_ragdolls(std::vector<Ragdoll>& ragdolls, const Scene& scene, const Agents& agents,
                   std::span<const std::uint32_t> active, std::span<const Vector2d> positions, const WaterBins& water,
                   std::uint64_t step);

}  // namespace wade::crowd
