#include "crowd_client/session/frame_source.hpp"

#include <utility>

#include "shm_protocol/latest_reader.hpp"
#include "shm_protocol/subscriber.hpp"

namespace wade::crowd {
namespace {

class LockstepSource final : public FrameSource {
 public:
    explicit LockstepSource(shm::Subscriber subscriber) : subscriber_(std::move(subscriber)) {}

    [[nodiscard]] const shm::StreamInfo& info() const override { return subscriber_.info(); }
    [[nodiscard]] std::optional<shm::Frame> acquire() override { return subscriber_.acquire(); }
    void release() override { subscriber_.release(); }
    void set_paused(bool paused) noexcept override { subscriber_.set_paused(paused); }
    [[nodiscard]] bool producer_is_there() const override { return subscriber_.producer_is_there(); }
    void leave() noexcept override { subscriber_.leave(); }
    void abort(int reason_code, std::string_view text) noexcept override { subscriber_.abort(reason_code, text); }

 private:
    shm::Subscriber subscriber_;
};

// The producer does not wait for this side, so that a pause or a reason to give up are no news to it.
class LatestSource final : public FrameSource {
 public:
    explicit LatestSource(shm::LatestReader reader) : reader_(std::move(reader)) {}

    [[nodiscard]] const shm::StreamInfo& info() const override { return reader_.info(); }
    [[nodiscard]] bool in_lockstep() const override { return false; }
    [[nodiscard]] std::optional<shm::Frame> acquire() override { return reader_.next(); }
    void release() override {}
    [[nodiscard]] std::uint64_t dropped_frames() const override { return reader_.dropped_frames(); }
    [[nodiscard]] bool producer_is_there() const override { return reader_.producer_is_there(); }
    void leave() noexcept override { reader_.leave(); }
    void abort(int, std::string_view) noexcept override { reader_.leave(); }

 private:
    shm::LatestReader reader_;
};

}  // namespace

std::unique_ptr<FrameSource> join_session(const std::string& session, std::uint64_t scene_hash, FrameMode mode,
                                          shm::Waiting waiting) {
    shm::JoinOptions options{.scene_hash = scene_hash, .waiting = std::move(waiting)};
    if (mode == FrameMode::latest) {
        return std::make_unique<LatestSource>(shm::LatestReader(session, "crowd", std::move(options)));
    }
    return std::make_unique<LockstepSource>(shm::Subscriber(session, "crowd", std::move(options)));
}

}  // namespace wade::crowd
