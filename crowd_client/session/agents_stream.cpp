#include "crowd_client/session/agents_stream.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <tuple>

#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/header.hpp"

namespace wade::crowd {
namespace {

shm::StreamInfo agents_info(const CrowdWorld& crowd, const shm::StreamInfo& water) {
    shm::StreamInfo info;
    info.kind = shm::stream_agents;
    info.producer_name = "crowd";
    info.capacity = static_cast<std::uint32_t>(std::max<std::size_t>(1, crowd.agents.size()));
    info.coupling_lag = crowd.scene.coupling.agents_stream == AgentsStream::parallel ? 1 : 0;
    info.depth = 1 + info.coupling_lag;
    info.ticks_per_second = water.ticks_per_second;
    info.ticks_per_frame = water.ticks_per_frame;
    info.scene_hash = crowd.scene.hash;
    return info;
}

float state_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::arrived:
            return shm::agent_arrived;
        case Outcome::dead:
            return shm::agent_dead;
        case Outcome::active:
            break;
    }
    return shm::agent_walking;
}

}  // namespace

AgentsPublisher::AgentsPublisher(const std::string& session, const CrowdWorld& crowd, const shm::StreamInfo& water,
                                 const shm::Waiting& waiting, int consumers)
    : publisher_(session, agents_info(crowd, water), waiting), consumers_(consumers) {}

void AgentsPublisher::start(const CrowdWorld& crowd) {
    publisher_.wait_for_consumers(consumers_);
    publish(crowd, 0, false);
}

void AgentsPublisher::gather(const CrowdWorld& crowd) {
    const Agents& agents = crowd.agents;
    for (std::vector<float>& field : fields_) field.clear();
    auto& [mass, vx, vy, vz, px, py, pz, radius, height, state] = fields_;
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const bool walks = agents.outcome[id] == Outcome::active;
        const Vector2d velocity = walks ? agents.velocity[id] : Vector2d::Zero();
        mass.push_back(static_cast<float>(agents.mass[id]));
        vx.push_back(static_cast<float>(velocity.x()));
        vy.push_back(0);
        vz.push_back(static_cast<float>(velocity.y()));
        px.push_back(static_cast<float>(agents.position[id].x()));
        py.push_back(0);
        pz.push_back(static_cast<float>(agents.position[id].y()));
        radius.push_back(static_cast<float>(crowd.scene.coupling.agent_radius));
        height.push_back(body_height);
        state.push_back(state_of(agents.outcome[id]));
    }
}

void AgentsPublisher::publish(const CrowdWorld& crowd, std::uint64_t tick, bool final) {
    gather(crowd);
    // A water whose first frame is at tick 0 has the tick of the start once more.
    last_tick_ = frame_ == 0 ? tick : std::max(tick, last_tick_ + 1);
    ++frame_;
    std::array<std::span<const float>, std::tuple_size_v<decltype(fields_)>> spans;
    std::copy(fields_.begin(), fields_.end(), spans.begin());
    hash_ = shm::chain_hash(hash_, frame_, spans);
    if (!taken_) return;
    const std::optional<shm::FrameFields> slot = publisher_.begin_frame();
    taken_ = slot.has_value();
    if (!slot) return;
    const std::array to{slot->mass, slot->vx, slot->vy,     slot->vz,     slot->px,
                        slot->py,   slot->pz, slot->radius, slot->height, slot->state};
    for (std::size_t i = 0; i < to.size(); ++i) std::copy(fields_[i].begin(), fields_[i].end(), to[i].begin());
    publisher_.end_frame(static_cast<std::uint32_t>(crowd.agents.size()), {}, final, last_tick_);
}

void AgentsPublisher::close() {
    publisher_.close();
}

void AgentsPublisher::abort(int reason_code, std::string_view text) noexcept {
    publisher_.abort(reason_code, text);
}

void AgentsPublisher::set_paused(bool paused) noexcept {
    publisher_.set_paused(paused);
}

void AgentsPublisher::heartbeat() noexcept {
    publisher_.heartbeat();
}

}  // namespace wade::crowd
