#include "crowd_client/frame_source.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include "configs/exit_code.hpp"
#include "shm_protocol/subscriber.hpp"

namespace wade::crowd {
namespace {

class SharedMemorySource final : public FrameSource {
 public:
    explicit SharedMemorySource(shm::Subscriber subscriber) : subscriber_(std::move(subscriber)) {}

    [[nodiscard]] const shm::StreamInfo& info() const override { return subscriber_.info(); }
    [[nodiscard]] std::optional<shm::Frame> acquire() override { return subscriber_.acquire(); }
    void release() override { subscriber_.release(); }
    void leave() noexcept override { subscriber_.leave(); }
    void abort(int reason_code, std::string_view text) noexcept override { subscriber_.abort(reason_code, text); }

 private:
    shm::Subscriber subscriber_;
};

}  // namespace

std::unique_ptr<FrameSource> join_session(const std::string& session, std::uint64_t scene_hash, double frame_rate,
                                          shm::Waiting waiting) {
    auto source =
        std::make_unique<SharedMemorySource>(shm::Subscriber(session, "crowd", scene_hash, std::move(waiting)));
    const shm::StreamInfo& info = source->info();
    const double stream_rate = static_cast<double>(info.ticks_per_second) / static_cast<double>(info.ticks_per_frame);
    // A rate that is no ratio of small integers may be rounded in ticks; 1e-6 is 0.4 ms over 400 s.
    if (!(std::abs(stream_rate - frame_rate) <= 1e-6 * frame_rate)) {
        std::ostringstream message;
        message << "the producer '" << info.producer_name << "' sends " << stream_rate
                << " frames a second, the scene has /frame_rate_hz " << frame_rate;
        source->abort(static_cast<int>(ExitCode::protocol_violation), message.str());
        throw RunError(ExitCode::protocol_violation, message.str());
    }
    return source;
}

}  // namespace wade::crowd
