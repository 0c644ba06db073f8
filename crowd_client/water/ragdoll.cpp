#include "crowd_client/water/ragdoll.hpp"

#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/time_lines.hpp"
#include "crowd_client/markers/counter_random.hpp"

namespace wade::crowd {
namespace {

// Far from the streams of the markers, which count cells from 0.
constexpr std::uint64_t first_stream = 0x7261'6764'0000'0000ULL;

constexpr double smallest_increase = 0.1, largest_increase = 0.5;  // rad/s

constexpr double forgotten_below = 0.01;  // of a share: after 1.4 s without a particle the next one begins anew

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

Vector3d random_rate(bool random_sign, std::uint64_t seed, std::uint32_t agent) {
    Vector3d rate;
    for (int axis = 0; axis < 3; ++axis) {
        const auto counter = static_cast<std::uint64_t>(2 * axis);
        const double u = counter_uniform(seed, first_stream + agent, counter);
        const double increase = smallest_increase + (largest_increase - smallest_increase) * u;
        const bool less = random_sign && counter_uniform(seed, first_stream + agent, counter + 1) < 0.5;
        rate[axis] = less ? -increase : increase;
    }
    return rate;
}

void tumble_on(Tumbling& tumbling, const TouchingMean& touching, double dt) {
    note(tumbling.enabled, touching.count > 0, dt);
    if (touching.count > 0) {
        tumbling.last = touching;
    } else if (tumbling.enabled.share < forgotten_below) {
        tumbling.is_new = true;
    }
    const auto& v = tumbling.last.velocity;
    const Vector3d velocity(v[0], v[1], v[2]);
    if (tumbling.is_new && touching.count > 0) {
        tumbling.height = {touching.height, 0};
        tumbling.velocity = {velocity, Vector3d::Zero()};
        tumbling.is_new = false;
    }
    follow(tumbling.height, tumbling.last.height, ragdoll_pace, dt);
    follow(tumbling.velocity, velocity, ragdoll_pace, dt);
}

void find_ragdolls(std::vector<Ragdoll>& ragdolls, std::vector<Tumbling>& tumbling, const Scene& scene,
                   const Agents& agents, std::span<const std::uint32_t> active, std::span<const Vector2d> positions,
                   const WaterBins& water, std::uint64_t step) {
    const RagdollRule& rule = scene.crowd->ragdoll;
    const double v_f = channel_velocity(scene.channel, static_cast<double>(step) / scene.crowd->step_rate);
    const double distance = contact_distance(scene.coupling);
    ragdolls.clear();
    tumbling.resize(agents.size());
    for (std::size_t k = 0; k < active.size(); ++k) {
        const std::uint32_t id = active[k];
        const CellWater met = water_at(water, positions[k], scene.fluid->rest_density);
        const bool holds = ragdoll_holds(rule, agents.tau[id], v_f, met);
        Tumbling& one = tumbling[id];
        if (!holds && one.is_new) continue;
        tumble_on(one, holds ? mean_of_touching(water, positions[k], distance) : TouchingMean{},
                  1 / scene.crowd->step_rate);
        if (!one.enabled.holds) continue;
        const Vector3d rate = one.velocity.value + random_rate(rule.random_sign, scene.seed, id);
        ragdolls.push_back({id, one.height.value, {rate.x(), rate.y(), rate.z()}});
    }
}

}  // namespace wade::crowd
