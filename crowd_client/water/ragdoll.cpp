#include "crowd_client/water/ragdoll.hpp"

#include "configs/scene/time_lines.hpp"
#include "crowd_client/markers/counter_random.hpp"

namespace wade::crowd {
namespace {

// Far from the streams of the markers, which count cells from 0.
constexpr std::uint64_t first_stream = 0x7261'6764'0000'0000ULL;

constexpr double smallest_increase = 0.1, largest_increase = 0.5;  // rad/s

}  // namespace

bool ragdoll_holds(const RagdollRule& rule, double tau, double v_f, const CellWater& met) {
    switch (rule.condition) {
        case RagdollCondition::paper:
            return tau >= rule.tau_min && v_f > rule.speed;
        case RagdollCondition::local_speed:
            return tau >= rule.tau_min && met.speed > rule.speed;
        case RagdollCondition::depth_speed:
            return met.depth * met.speed >= rule.depth_speed;
        case RagdollCondition::off:
            break;
    }
    return false;
}

std::array<double, 3> hip_rate(const std::array<double, 3>& velocity, bool random_sign, std::uint64_t seed,
                               std::uint32_t agent, std::uint64_t step) {
    std::array<double, 3> rate{};
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
        const std::uint64_t counter = 6 * step + 2 * axis;
        const double u = counter_uniform(seed, first_stream + agent, counter);
        const double increase = smallest_increase + (largest_increase - smallest_increase) * u;
        const bool less = random_sign && counter_uniform(seed, first_stream + agent, counter + 1) < 0.5;
        rate[axis] = velocity[axis] + (less ? -increase : increase);
    }
    return rate;
}

void find_ragdolls(std::vector<Ragdoll>& ragdolls, const Scene& scene, const Agents& agents,
                   std::span<const std::uint32_t> active, std::span<const Vector2d> positions, const WaterBins& water,
                   std::uint64_t step) {
    const RagdollRule& rule = scene.crowd.ragdoll;
    const double v_f = channel_velocity(scene.channel, static_cast<double>(step) / scene.crowd.step_rate);
    const double distance = contact_distance(scene.coupling);
    ragdolls.clear();
    for (std::size_t k = 0; k < active.size(); ++k) {
        const std::uint32_t id = active[k];
        const CellWater met = water_at(water, positions[k], scene.fluid.rest_density);
        if (!ragdoll_holds(rule, agents.tau[id], v_f, met)) continue;
        const TouchingMean mean = mean_of_touching(water, positions[k], distance);
        if (mean.count == 0) continue;
        ragdolls.push_back({id, mean.height, hip_rate(mean.velocity, rule.random_sign, scene.seed, id, step)});
    }
}

}  // namespace wade::crowd
