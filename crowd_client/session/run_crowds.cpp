#include "crowd_client/session/run_crowds.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/session/frame_time.hpp"

namespace wade::crowd {
namespace {

class CommonJourney {
 public:
    CommonJourney(std::span<CrowdRun> crowds, FrameSource& source, const CrowdsHooks& hooks, int threads)
        : crowds_(crowds), source_(source), hooks_(hooks), threads_(threads) {
        for (std::size_t k = 0; k < crowds.size(); ++k) walking_.push_back(k);
        bins_ = empty_bins(crowds.front().crowd.scene);
        for (const CrowdRun& run : crowds) bins_.with_heights |= has_ragdolls(run.crowd.scene);
    }

    void take_frames() {
        bool last = false;
        while (!last) {
            const std::optional<shm::Frame> frame = next_frame();
            if (!frame) break;
            check_order(source_, *frame, last_frame_);
            walk_through(*frame);
            last_frame_ = frame->frame;
            if (hooks_.on_frame) hooks_.on_frame(*frame);
            const bool stream_ends = frame->final;
            part_with_finished(stream_ends);
            last = stream_ends || walking_.empty();
            if (last) demand_a_survivor();
            source_.release();  // the water goes on while the crowds write their files
            if (last && !stream_ends) source_.leave();
            tell_of_finished();
        }
        part_with_finished(true);
        tell_of_finished();
    }

 private:
    [[nodiscard]] int signal() const { return hooks_.interrupted ? hooks_.interrupted() : 0; }

    std::optional<shm::Frame> next_frame() {
        stop_at_signal(signal(), last_frame_);
        if (hooks_.before_frame) {
            hooks_.before_frame();
            stop_at_signal(signal(), last_frame_);
        }
        if (hooks_.quit && hooks_.quit()) {
            source_.leave();
            throw RunError(ExitCode::interrupted, "told to quit after frame " + std::to_string(last_frame_));
        }
        return source_.acquire();
    }

    // Most often each crowd takes one step a frame and the water near the agents is enough; one that takes several may
    // leave the cells that were near.
    void sort_water(const WaterView& water, const shm::Frame& frame) {
        std::uint64_t most_steps = 0;
        positions_.clear();
        for (const std::size_t k : walking_) {
            const CrowdWorld& crowd = crowds_[k].crowd;
            const std::uint64_t due = steps_due_at(crowd.scene, source_.info(), frame.tick);
            most_steps = std::max(most_steps, due - std::min(due, crowd.steps));
            for (const std::uint32_t id : crowd.active) positions_.push_back(crowd.agents.position[id]);
        }
        if (most_steps == 1) {
            bin_water(bins_, water, positions_);
        } else if (most_steps > 1) {
            bin_all_water(bins_, water);
        }
    }

    // Without the error of the crowd, which is kept. A signal ends the walk early.
    void walk_one(std::size_t k, const WaterView& water, const shm::Frame& frame) {
        CrowdRun& run = crowds_[k];
        const std::uint64_t due = steps_due_at(run.crowd.scene, source_.info(), frame.tick);
        try {
            while (run.crowd.steps < due && !run_is_over(run.crowd)) {
                if (const int number = signal(); number != 0) {
                    signal_in_steps_ = number;
                    return;
                }
                step_through(run.crowd, bins_);
                if (hooks_.on_step) hooks_.on_step(k, water);
            }
        } catch (const std::exception& error) {
            run.failure = std::current_exception();
            fail_summary(run.summary, error);
        }
    }

    void walk_through(const shm::Frame& frame) {
        const WaterView water = ground_view(frame, source_.info());
        sort_water(water, frame);
#pragma omp parallel for schedule(dynamic) num_threads(threads_) if (threads_ > 1)
        for (std::size_t i = 0; i < walking_.size(); ++i) walk_one(walking_[i], water, frame);
        stop_at_signal(signal_in_steps_, last_frame_);
        for (const std::size_t k : walking_) {
            if (!crowds_[k].failure) note_frame(crowds_[k].summary, source_, frame);
        }
    }

    // All that are over are marked before any of them is told, so that what happens then touches nobody else.
    void part_with_finished(bool stream_ends) {
        std::erase_if(walking_, [&](std::size_t k) {
            CrowdRun& run = crowds_[k];
            if (!run.failure && !stream_ends && !run_is_over(run.crowd)) return false;
            if (!run.failure) end_summary(run.summary, run.crowd);
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
    const CrowdsHooks& hooks_;
    int threads_;
    std::vector<std::size_t> walking_;   // crowds that are not over, ascending
    std::vector<std::size_t> finished_;  // that are over, with on_over still to be called
    std::atomic<int> signal_in_steps_ = 0;
    std::uint64_t last_frame_ = 0;
    WaterBins bins_;
    std::vector<Vector2d> positions_;
};

}  // namespace

void run_crowds(std::span<CrowdRun> crowds, FrameSource& source, const CrowdsHooks& hooks, int threads) {
    try {
        CommonJourney(crowds, source, hooks, threads).take_frames();
    } catch (const RunError& error) {
        source.abort(static_cast<int>(error.code()), error.what());
        throw;
    } catch (const shm::Error& error) {
        source.abort(error.exit_code(), error.what());
        throw;
    } catch (const std::exception& error) {
        source.abort(static_cast<int>(ExitCode::unexpected), error.what());
        throw;
    }
}

}  // namespace wade::crowd
