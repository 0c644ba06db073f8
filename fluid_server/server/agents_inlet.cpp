#include "fluid_server/server/agents_inlet.hpp"

#include <utility>

namespace wade::fluid {

AgentsInlet::AgentsInlet(std::string session, std::uint32_t lag, shm::JoinOptions options)
    : session_(std::move(session)), lag_(lag), options_(std::move(options)) {
    options_.kind = shm::stream_agents;
}

void AgentsInlet::join(std::string_view model) {
    subscriber_.emplace(session_, std::string(model), options_);
    const shm::StreamInfo& info = subscriber_->info();
    const std::string stream = "The agents stream of session '" + session_ + "' ";
    if (info.coupling_lag != lag_) {
        throw shm::Error(shm::Failure::protocol_violation, stream + "has the coupling lag " +
                                                               std::to_string(info.coupling_lag) + ", the scene says " +
                                                               std::to_string(lag_) + ".");
    }
    if (!info.in_world_coordinates()) {
        throw shm::Error(shm::Failure::protocol_violation,
                         stream + "is not in world coordinates (metres, axes 1 2 3, no offset).");
    }
}

bool AgentsInlet::take(std::uint64_t water_frame, FluidModel& model) {
    if (water_frame <= lag_) return true;
    const std::optional<shm::Frame> frame = subscriber_->acquire();
    if (!frame) return false;
    if (frame->frame != water_frame - lag_) {
        throw shm::Error(shm::Failure::protocol_violation, "The agents stream of session '" + session_ +
                                                               "' came with frame " + std::to_string(frame->frame) +
                                                               " where " + std::to_string(water_frame - lag_) +
                                                               " was due.");
    }
    model.take_agents({frame->frame, frame->tick, frame->mass, frame->vx, frame->vy, frame->vz, frame->px, frame->py,
                       frame->pz, frame->radius, frame->height, frame->state, frame->jx, frame->jz, frame->submerged,
                       frame->spread});
    ++frames_;
    hash_ = frame->hash;
    subscriber_->release();
    return true;
}

void AgentsInlet::leave() noexcept {
    if (subscriber_) subscriber_->leave();
}

void AgentsInlet::abort(int reason_code, std::string_view text) noexcept {
    if (subscriber_) subscriber_->abort(reason_code, text);
}

}  // namespace wade::fluid
