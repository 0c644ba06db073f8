#pragma once
// The way back: takes the agents of the crowd, a frame of them for each frame of the water.
//
//   lag 0, serial     agents f, the crowd before frame f of the water, are taken before that frame is computed
//   lag 1, parallel   agents f - 1 are; frame 1 is computed without

#include <cstdint>
#include <optional>
#include <string>

#include "fluid_server/fluid_model.hpp"
#include "shm_protocol/subscriber.hpp"

namespace wade::fluid {

class AgentsInlet {
 public:
    // lag: 0 or 1. options.kind is set here.
    AgentsInlet(std::string session, std::uint32_t lag, shm::JoinOptions options);

    // Joins the agents stream of the session under the name of the model.
    // Errors: as shm::Subscriber; protocol_violation if the stream has another lag or is not in world coordinates.
    void join(std::string_view model);

    // Hands the agents for this frame of the water to the model. False once the crowd has ended its stream.
    // Errors: as shm::Subscriber; protocol_violation if a frame was missed.
    bool take(std::uint64_t water_frame, FluidModel& model);

    // A clean goodbye.
    void leave() noexcept;

    // Gives up and tells the crowd why.
    void abort(int reason_code, std::string_view text) noexcept;

    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    [[nodiscard]] std::uint64_t hash() const { return hash_; }  // chain over the frames taken, 0 = none

 private:
    std::string session_;
    std::uint32_t lag_;
    shm::JoinOptions options_;
    std::optional<shm::Subscriber> subscriber_;
    std::uint64_t frames_ = 0;
    std::uint64_t hash_ = 0;
};

}  // namespace wade::fluid
