#include "crowd_client/session/agents_stream.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <tuple>

#include "configs/scene/coupling.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/header.hpp"

namespace wade::crowd {
namespace {

shm::StreamInfo agents_info(const CrowdWorld& crowd, const shm::StreamInfo& water) {
    shm::StreamInfo info;
    info.kind = shm::stream_agents;
    info.producer_name = "crowd";
    info.capacity = static_cast<std::uint32_t>(std::max<std::size_t>(1, crowd.agents.size()));
    info.coupling_lag = crowd.scene.coupling->agents_stream == AgentsStream::parallel ? 1 : 0;
    info.depth = 1 + info.coupling_lag;
    info.impulses = crowd.pushing.has_value();
    info.ticks_per_second = water.ticks_per_second;
    info.ticks_per_frame = water.ticks_per_frame;
    info.scene_hash = crowd.scene.hash;
    return info;
}

float state_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::arrived:
        case Outcome::sheltered:
        case Outcome::indoors:
        case Outcome::upper_floor:
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
        radius.push_back(static_cast<float>(crowd.scene.coupling->agent_radius));
        height.push_back(static_cast<float>(agents.people.height[id]));
        state.push_back(state_of(agents.outcome[id]));
    }
}

std::array<Vector2d, 4> AgentsPublisher::no_impulses() {
    const Vector2d none = Vector2d::Zero();
    return {none, none, none, none};
}

void AgentsPublisher::gather_impulses(const CrowdWorld& crowd) {
    const Pushing& pushing = *crowd.pushing;
    const auto spread = static_cast<float>(crowd.feeling->spread);
    for (std::vector<float>& field : impulses_) field.clear();
    auto& [jx, jz, submerged, spreads] = impulses_;
    sent_.resize(crowd.agents.size(), Vector2d::Zero());
    Vector2d sum = Vector2d::Zero();
    for (std::size_t id = 0; id < crowd.agents.size(); ++id) {
        const Vector2d due = pushing.given[id] - sent_[id];
        const auto x = static_cast<float>(due.x()), z = static_cast<float>(due.y());
        const Vector2d sent(static_cast<double>(x), static_cast<double>(z));
        sent_[id] += sent;
        sum += sent;
        const bool in_water = (pushing.wet[id] && crowd.agents.outcome[id] == Outcome::active) || x != 0 || z != 0;
        jx.push_back(x);
        jz.push_back(z);
        submerged.push_back(in_water ? static_cast<float>(pushing.submerged[id]) : 0);
        spreads.push_back(spread);
    }
    given_[frame_ % given_.size()] = given_[(frame_ - 1) % given_.size()] + sum;
}

void AgentsPublisher::publish(const CrowdWorld& crowd, std::uint64_t tick, bool final) {
    gather(crowd);
    // If the first frame of the water is at tick 0, it has the tick of the start once more.
    last_tick_ = frame_ == 0 ? tick : std::max(tick, last_tick_ + 1);
    ++frame_;
    if (crowd.pushing) gather_impulses(crowd);
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
    if (crowd.pushing) {
        const std::array pushed{slot->jx, slot->jz, slot->submerged, slot->spread};
        for (std::size_t i = 0; i < pushed.size(); ++i) {
            std::copy(impulses_[i].begin(), impulses_[i].end(), pushed[i].begin());
        }
    }
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
