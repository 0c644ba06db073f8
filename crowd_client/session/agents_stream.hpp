#pragma once
// The agents stream: the crowd's agents as a stream for the water, "/<session>-agents".
//
// Agents frame f is the state before frame f of the water, frame 1 the start. All agents are in every frame, in the
// order of their ids, standing on the bed y = 0. Agents that have arrived or died rest at their last position.
//
// For a crowd that pushes the water it also holds each agent's impulse from the water since the agents frame before.
//
//   crowd    publish 1 | take water 1, steps, publish 2, release 1 | take water 2, steps, publish 3, release 2 | ...
//   water    serial, lag 0:   take agents f     before it computes frame f
//            parallel, lag 1: take agents f - 1 before it computes frame f, none for frame 1

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "crowd_client/crowd_world.hpp"
#include "shm_protocol/publisher.hpp"

namespace wade::crowd {

class AgentsPublisher {
 public:
    // Creates the stream for a number of consumers, the producer of the water among them; start() waits for them. Ticks
    // are those of the water's stream. The scene's agents_stream must not be `off`. Errors: as shm::Publisher.
    AgentsPublisher(const std::string& session, const CrowdWorld& crowd, const shm::StreamInfo& water,
                    const shm::Waiting& waiting, int consumers = 1);

    // Waits for the consumers and publishes frame 1. Errors: as shm::Publisher.
    void start(const CrowdWorld& crowd);

    // Publishes the next frame, the state after the steps due with a frame of the water with this tick. Goes on without
    // consumers once they have left. Errors: as shm::Publisher.
    void publish(const CrowdWorld& crowd, std::uint64_t tick, bool final);

    // Waits until all frames are taken or the consumers have left. Errors: as shm::Publisher.
    void close();

    // Tells the consumers why this side gives up.
    void abort(int reason_code, std::string_view text) noexcept;

    void set_paused(bool paused) noexcept;

    // Shows a sign of life while this side waits elsewhere.
    void heartbeat() noexcept;

    // Returns the impulse of the water on people in the agents frames up to this one, N s along x and z; of the last
    // four frames.
    [[nodiscard]] Vector2d given_until(std::uint64_t agents_frame) const {
        return given_[agents_frame % given_.size()];
    }
    [[nodiscard]] std::uint64_t lag() const { return publisher_.info().coupling_lag; }

    // Returns the chain hash over all frames made so far, taken or not, so that it depends on the crowd alone.
    [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
    static std::array<Vector2d, 4> no_impulses();
    void gather(const CrowdWorld& crowd);
    void gather_impulses(const CrowdWorld& crowd);

    shm::Publisher publisher_;
    int consumers_;
    bool taken_ = true;  // a consumer still takes part
    std::uint64_t frame_ = 0;
    std::uint64_t last_tick_ = 0;
    std::uint64_t hash_ = 0;
    std::array<std::vector<float>, 10> fields_;   // in the order of the stream's required fields
    std::array<std::vector<float>, 4> impulses_;  // of the optional ones, if the crowd pushes the water
    std::vector<Vector2d> sent_;                  // by id, N s; the rest of rounding to float comes with the next frame
    std::array<Vector2d, 4> given_ = no_impulses();  // by frame modulo 4
};

}  // namespace wade::crowd
