#include "crowd_client/run_client.hpp"

#include <csignal>

#include "configs/exit_code.hpp"

namespace wade::crowd {
namespace {

void stop_if_interrupted(const ClientHooks& hooks, std::uint64_t frame) {
    const int signal = hooks.interrupted ? hooks.interrupted() : 0;
    if (signal == 0) return;
    const bool terminated = signal == SIGTERM;
    throw RunError(
        terminated ? ExitCode::terminated : ExitCode::interrupted,
        std::string("interrupted by ") + (terminated ? "SIGTERM" : "SIGINT") + " after frame " + std::to_string(frame));
}

void take_frames(CrowdWorld& crowd, FrameSource& source, RunSummary& summary, const ClientHooks& hooks) {
    while (true) {
        stop_if_interrupted(hooks, summary.frames);
        const std::optional<shm::Frame> frame = source.acquire();
        if (!frame) break;
        if (frame->frame != summary.frames + 1) {
            throw RunError(ExitCode::protocol_violation, "got frame " + std::to_string(frame->frame) +
                                                             " of the water where frame " +
                                                             std::to_string(summary.frames + 1) + " was due");
        }
        const WaterView water = ground_view(*frame, source.info());
        step(crowd, water, frame->frame);
        summary.frames = frame->frame;
        summary.frame_hash = frame->hash;
        add_frame(summary.fluid, *frame, static_cast<double>(frame->frame) * crowd.dt, crowd.dt);
        if (hooks.on_frame) hooks.on_frame(crowd, *frame, water);
        const bool stream_ends = frame->final;
        source.release();
        const bool done = run_is_over(crowd);
        if (done || stream_ends) {
            if (!stream_ends) source.leave();
            summary.status = done ? "completed" : "stream_ended";
            return;
        }
    }
    summary.status = "stream_ended";
}

}  // namespace

bool run_is_over(const CrowdWorld& crowd) {
    const bool nobody_left = crowd.agents.size() > 0 && crowd.active.empty();
    return crowd.frame >= frames_of(crowd.scene) || (nobody_left && crowd.scene.stop_when_no_agent_is_active);
}

void run_client(CrowdWorld& crowd, FrameSource& source, RunSummary& summary, const ClientHooks& hooks) {
    try {
        take_frames(crowd, source, summary, hooks);
    } catch (const RunError& error) {
        source.abort(static_cast<int>(error.code()), error.what());
        throw;
    } catch (const shm::Error&) {
        throw;  // the other side is gone or knows already
    } catch (const std::exception& error) {
        source.abort(static_cast<int>(ExitCode::unexpected), error.what());
        throw;
    }
}

std::string status_of(int exit_code) {
    switch (static_cast<ExitCode>(exit_code)) {
        case ExitCode::ok:
            return "completed";
        case ExitCode::bad_configuration:
            return "bad_configuration";
        case ExitCode::attach_timeout:
            return "attach_timeout";
        case ExitCode::peer_dead:
            return "peer_dead";
        case ExitCode::peer_aborted:
            return "peer_aborted";
        case ExitCode::protocol_violation:
            return "protocol_violation";
        case ExitCode::step_timeout:
            return "step_timeout";
        case ExitCode::name_in_use:
            return "name_in_use";
        case ExitCode::numerical_failure:
            return "numerical_failure";
        case ExitCode::interrupted:
        case ExitCode::terminated:
            return "interrupted";
        case ExitCode::unexpected:
            break;
    }
    return "failed";
}

}  // namespace wade::crowd
