#include "crowd_client/session/run_client.hpp"

#include <csignal>

#include "configs/errors/exit_code.hpp"
#include "configs/program/peer_support.hpp"
#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/session/frame_time.hpp"

namespace wade::crowd {
namespace {

int signal_of(const ClientHooks& hooks) {
    return hooks.interrupted ? hooks.interrupted() : 0;
}

// One way through the stream: the frames that came and where they led.
class Journey {
 public:
    Journey(CrowdWorld& crowd, FrameSource& source, RunSummary& summary, const ClientHooks& hooks,
            AgentsPublisher* agents)
        : crowd_(crowd), source_(source), summary_(summary), hooks_(hooks), agents_(agents) {}

    void take_frames() {
        if (agents_ != nullptr) beside_water([&] { agents_->start(crowd_); });
        while (const std::optional<shm::Frame> frame = next_frame()) {
            check_order(source_, *frame, summary_.last_frame);
            walk_through(*frame);
            const bool stream_ends = frame->final;
            const bool last = stream_ends || run_is_over(crowd_);
            publish_agents(frame->tick, last);
            source_.release();
            holds_frame_ = false;
            if (!last) continue;
            if (!stream_ends) source_.leave();
            break;
        }
        if (agents_ != nullptr) beside_water([&] { agents_->close(); });
        end_summary(summary_, crowd_);
    }

 private:
    std::optional<shm::Frame> next_frame() {
        stop_at_signal(signal_of(hooks_), summary_.last_frame);
        if (hooks_.before_frame) {
            hooks_.before_frame();
            stop_at_signal(signal_of(hooks_), summary_.last_frame);
        }
        if (hooks_.quit && hooks_.quit()) quit();
        std::optional<shm::Frame> frame = source_.acquire();
        if (agents_ != nullptr) agents_->set_paused(false);  // as it may be while the water pauses
        holds_frame_ = frame.has_value();
        return frame;
    }

    // A wait for those who take the agents; if the water goes meanwhile, its own stream says how.
    template <typename Work>
    void beside_water(Work&& work) {
        try {
            work();
        } catch (const shm::Error& error) {
            const bool by_signal = signal_of(hooks_) != 0;
            if (error.failure() != shm::Failure::interrupted || by_signal) throw;
            if (holds_frame_) source_.release();
            while (source_.acquire()) source_.release();
            throw shm::Error(shm::Failure::peer_aborted, "The water ended its stream before it took the agents.");
        }
    }

    // An end that was wished for is nobody's failure.
    [[noreturn]] void quit() {
        source_.leave();
        if (agents_ != nullptr) agents_->close();
        throw RunError(ExitCode::interrupted, "told to quit after frame " + std::to_string(summary_.last_frame));
    }

    void walk_through(const shm::Frame& frame) {
        const WaterView water = ground_view(frame, source_.info());
        const std::uint64_t due = steps_due_at(crowd_.scene, source_.info(), frame.tick);
        while (crowd_.steps < due && !run_is_over(crowd_)) {
            stop_at_signal(signal_of(hooks_), summary_.last_frame);
            step(crowd_, water);
            if (hooks_.on_step) hooks_.on_step(crowd_, water);
        }
        note_frame(summary_, source_, frame);
        if (hooks_.on_frame) hooks_.on_frame(crowd_, frame);
    }

    void publish_agents(std::uint64_t tick, bool last) {
        if (agents_ == nullptr) return;
        beside_water([&] { agents_->publish(crowd_, tick, last); });
        summary_.agents_hash = agents_->hash();
    }

    CrowdWorld& crowd_;
    FrameSource& source_;
    RunSummary& summary_;
    const ClientHooks& hooks_;
    AgentsPublisher* agents_;
    bool holds_frame_ = false;
};

}  // namespace

void run_client(CrowdWorld& crowd, FrameSource& source, RunSummary& summary, const ClientHooks& hooks,
                AgentsPublisher* agents) {
    const auto give_up = [&](int code, const char* reason) {
        source.abort(code, reason);
        if (agents != nullptr) agents->abort(code, reason);
    };
    try {
        Journey(crowd, source, summary, hooks, agents).take_frames();
    } catch (const RunError& error) {
        give_up(static_cast<int>(error.code()), error.what());
        throw;
    } catch (const shm::Error& error) {
        give_up(error.exit_code(), error.what());  // the stream that failed knows already, the other one does not
        throw;
    } catch (const std::exception& error) {
        give_up(static_cast<int>(ExitCode::unexpected), error.what());
        throw;
    }
}

void stop_at_signal(int signal, std::uint64_t last_frame) {
    if (signal == 0) return;
    const bool terminated = signal == SIGTERM;
    throw RunError(terminated ? ExitCode::terminated : ExitCode::interrupted,
                   std::string("interrupted by ") + (terminated ? "SIGTERM" : "SIGINT") + " after frame " +
                       std::to_string(last_frame));
}

void check_order(const FrameSource& source, const shm::Frame& frame, std::uint64_t last_frame) {
    const std::uint64_t due = last_frame + 1;
    if (source.in_lockstep() ? frame.frame == due : frame.frame >= due) return;
    throw RunError(ExitCode::protocol_violation, "got frame " + std::to_string(frame.frame) +
                                                     " of the water where frame " + std::to_string(due) + " was due");
}
void note_frame(RunSummary& summary, const FrameSource& source, const shm::Frame& frame) {
    const double time = time_of_tick(source.info(), frame.tick);
    add_frame(summary.fluid, frame, time, time - summary.time);
    summary.time = time;
    summary.last_frame = frame.frame;
    ++summary.frames;
    summary.dropped_frames = source.dropped_frames();
    if (source.in_lockstep()) summary.frame_hash = frame.hash;
}

}  // namespace wade::crowd
