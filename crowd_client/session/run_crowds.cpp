#include "crowd_client/session/run_crowds.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <utility>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/program/peer_support.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/session/frame_time.hpp"
#include "crowd_client/water/plausibility.hpp"

namespace wade::crowd {
namespace {

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

// Adds a frame to the summary after the steps of the crowd in it.
void note_frame(RunSummary& summary, const FrameSource& source, const shm::Frame& frame) {
    const double time = time_of_tick(source.info(), frame.tick);
    add_frame(summary.fluid, frame, time, time - summary.time);
    summary.time = time;
    summary.last_frame = frame.frame;
    ++summary.frames;
    summary.dropped_frames = source.dropped_frames();
    if (source.in_lockstep()) summary.frame_hash = frame.hash;
}

// One run through the stream: its frames, and the steps of the crowds.
class Journey {
 public:
    Journey(std::span<CrowdRun> crowds, FrameSource& source, const RunHooks& hooks, int threads,
            AgentsPublisher* agents)
        : crowds_(crowds),
          source_(source),
          hooks_(hooks),
          threads_(threads),
          agents_(agents),
          plausibility_(crowds.front().crowd.scene) {
        for (std::size_t k = 0; k < crowds.size(); ++k) walking_.push_back(k);
        marker_memories_.resize(static_cast<std::size_t>(threads));
        bins_ = empty_bins(crowds.front().crowd.scene);
        for (const CrowdRun& run : crowds) bins_.with_heights |= has_ragdolls(run.crowd.scene);
    }

    void take_frames() {
        if (agents_ != nullptr) beside_water([&] { agents_->start(only().crowd); });
        bool last = false;
        while (!last) {
            const std::optional<shm::Frame> frame = next_frame();
            if (!frame) break;
            check_order(source_, *frame, last_frame_);
            walk_through(*frame);
            last_frame_ = frame->frame;
            const bool stream_ends = frame->final;
            part_with_finished(stream_ends);
            if (walking_.empty()) demand_a_survivor();
            if (hooks_.on_frame) hooks_.on_frame(*frame);
            last = stream_ends || walking_.empty();
            publish_agents(frame->tick, last);
            source_.release();  // the water goes on while the crowds write their files
            holds_frame_ = false;
            if (last && !stream_ends) source_.leave();
            tell_of_finished();
        }
        if (agents_ != nullptr) beside_water([&] { agents_->close(); });
        part_with_finished(true);
        tell_of_finished();
    }

 private:
    [[nodiscard]] CrowdRun& only() { return crowds_.front(); }
    [[nodiscard]] int signal() const { return hooks_.interrupted ? hooks_.interrupted() : 0; }

    std::optional<shm::Frame> next_frame() {
        stop_at_signal(signal(), last_frame_);
        if (hooks_.before_frame) {
            hooks_.before_frame();
            stop_at_signal(signal(), last_frame_);
        }
        if (hooks_.quit && hooks_.quit()) quit();
        std::optional<shm::Frame> frame = source_.acquire();
        if (agents_ != nullptr) agents_->set_paused(false);  // it may be paused along with the water
        holds_frame_ = frame.has_value();
        return frame;
    }

    // A requested end is no failure.
    [[noreturn]] void quit() {
        source_.leave();
        if (agents_ != nullptr) agents_->close();
        throw RunError(ExitCode::interrupted, "told to quit after frame " + std::to_string(last_frame_));
    }

    // Waits for consumers of the agents; if the water ends meanwhile, its own stream gives the reason.
    template <typename Work>
    void beside_water(Work&& work) {
        try {
            work();
        } catch (const shm::Error& error) {
            const bool by_signal = signal() != 0;
            if (error.failure() != shm::Failure::interrupted || by_signal) throw;
            if (holds_frame_) source_.release();
            while (source_.acquire()) source_.release();
            throw shm::Error(shm::Failure::peer_aborted, "The water ended its stream before it took the agents.");
        }
    }

    // Most often each crowd takes one step a frame, and the water near the agents is enough. With several steps, or
    // long ones, agents may leave the cells that were near. A crowd that is alone sorts its water before each of its
    // steps.
    void sort_water(const WaterView& water, const shm::Frame& frame) {
        if (is_alone()) return;
        std::uint64_t most_steps = 0;
        bool far = false;
        positions_.clear();
        for (const std::size_t k : walking_) {
            CrowdWorld& crowd = crowds_[k].crowd;
            let_out(crowd);
            const std::uint64_t due = steps_due_at(crowd.scene, source_.info(), frame.tick);
            most_steps = std::max(most_steps, due - std::min(due, crowd.steps));
            far = far || needs_all_water(crowd);
            for (const std::uint32_t id : crowd.active) positions_.push_back(crowd.agents.position[id]);
        }
        if (most_steps == 1 && !far) {
            bin_water(bins_, water, positions_);
        } else if (most_steps > 0) {
            bin_all_water(bins_, water);
        }
    }
    [[nodiscard]] bool is_alone() const { return crowds_.size() == 1; }

    // Working memory that one crowd after the other uses stays in the processor's cache.
    [[nodiscard]] MarkerMemory& memory_of_thread() {
        return marker_memories_[static_cast<std::size_t>(omp_get_thread_num())];
    }

    // Steps one crowd, and keeps its error instead of throwing it. A signal ends the steps early.
    void walk_one(std::size_t k, const WaterView& water, const shm::Frame& frame) {
        CrowdRun& run = crowds_[k];
        const std::uint64_t due = steps_due_at(run.crowd.scene, source_.info(), frame.tick);
        MarkerMemory& memory = memory_of_thread();
        std::swap(run.crowd.marker_memory, memory);
        try {
            while (run.crowd.steps < due && !run_is_over(run.crowd)) {
                if (const int number = signal(); number != 0) {
                    signal_in_steps_ = number;
                    break;
                }
                if (is_alone()) {
                    step(run.crowd, water);
                } else {
                    step_through(run.crowd, bins_);
                }
                if (hooks_.on_step) hooks_.on_step(k, water);
            }
        } catch (const std::exception& error) {
            run.failure = std::current_exception();
            fail_summary(run.summary, error);
        }
        std::swap(run.crowd.marker_memory, memory);
    }

    void walk_through(const shm::Frame& frame) {
        const WaterView water = ground_view(frame, source_.info());
        for (const std::string& sentence :
             plausibility_.look(water, frame.frame, time_of_tick(source_.info(), frame.tick))) {
            if (hooks_.warn) hooks_.warn(sentence);
        }
        sort_water(water, frame);
#pragma omp parallel for schedule(dynamic) num_threads(threads_) if (threads_ > 1)
        for (std::size_t i = 0; i < walking_.size(); ++i) walk_one(walking_[i], water, frame);
        stop_at_signal(signal_in_steps_, last_frame_);
        for (const std::size_t k : walking_) {
            if (!crowds_[k].failure) note_frame(crowds_[k].summary, source_, frame);
            if (agents_ != nullptr && crowds_[k].crowd.pushing) note_momentum(crowds_[k].summary, frame);
        }
    }

    // The water of frame f has taken the impulses of the agents frames up to f - lag.
    void note_momentum(RunSummary& summary, const shm::Frame& frame) {
        const std::uint64_t taken = frame.frame - agents_->lag();
        summary.momentum = momentum_balance(frame.diagnostics, agents_->given_until(taken));
    }

    void publish_agents(std::uint64_t tick, bool last) {
        if (agents_ == nullptr) return;
        beside_water([&] { agents_->publish(only().crowd, tick, last); });
        only().summary.agents_hash = agents_->hash();
    }

    // Marks all crowds that are over before any on_over(), so that these calls affect no other crowd.
    void part_with_finished(bool stream_ends) {
        std::erase_if(walking_, [&](std::size_t k) {
            CrowdRun& run = crowds_[k];
            if (!run.failure && !stream_ends && !run_is_over(run.crowd)) return false;
            run.over = true;
            finished_.push_back(k);
            return true;
        });
    }

    void demand_a_survivor() {
        const auto failed = [](const CrowdRun& run) { return run.failure != nullptr; };
        if (!std::all_of(crowds_.begin(), crowds_.end(), failed)) return;
        tell_of_finished();
        std::rethrow_exception(crowds_.front().failure);
    }

    void tell_of_finished() {
        for (const std::size_t k : finished_) {
            if (!crowds_[k].failure) end_summary(crowds_[k].summary, crowds_[k].crowd);
        }
        for (const std::size_t k : std::exchange(finished_, {})) {
            try {
                if (hooks_.on_over) hooks_.on_over(k);
            } catch (const std::exception& error) {
                if (!crowds_[k].failure) crowds_[k].failure = std::current_exception();
                fail_summary(crowds_[k].summary, error);
            }
        }
    }

    std::span<CrowdRun> crowds_;
    FrameSource& source_;
    const RunHooks& hooks_;
    int threads_;
    AgentsPublisher* agents_;
    std::vector<std::size_t> walking_;   // crowds that are not over, ascending
    std::vector<std::size_t> finished_;  // that are over, with on_over still to be called
    std::atomic<int> signal_in_steps_ = 0;
    std::uint64_t last_frame_ = 0;
    bool holds_frame_ = false;
    Plausibility plausibility_;
    std::vector<MarkerMemory> marker_memories_;  // by thread
    WaterBins bins_;                             // of crowds that are not alone
    std::vector<Vector2d> positions_;
};

}  // namespace

void run_crowds(std::span<CrowdRun> crowds, FrameSource& source, const RunHooks& hooks, int threads,
                AgentsPublisher* agents) {
    try {
        Journey(crowds, source, hooks, threads, agents).take_frames();
    } catch (const std::exception& error) {
        // The stream that failed knows already, another one does not.
        const int code = exit_code_of<shm::Error>(error);
        source.abort(code, error.what());
        if (agents != nullptr) agents->abort(code, error.what());
        throw;
    }
}

}  // namespace wade::crowd
