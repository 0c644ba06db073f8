#include "crowd_client/run_crowds.hpp"

#include <exception>
#include <string>
#include <vector>

#include "configs/exit_code.hpp"
#include "crowd_client/frame_time.hpp"

namespace wade::crowd {
namespace {

class CommonJourney {
 public:
    CommonJourney(std::span<CrowdRun> crowds, FrameSource& source, const CrowdsHooks& hooks, int threads)
        : crowds_(crowds), source_(source), hooks_(hooks), threads_(threads) {
        for (std::size_t k = 0; k < crowds.size(); ++k) walking_.push_back(k);
        bins_ = empty_bins(crowds.front().crowd.scene);
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
            end_crowds(frame->final);
            last = frame->final || walking_.empty();
            source_.release();
            if (last && !frame->final) source_.leave();
        }
        end_crowds(true);
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

    void walk_one(std::size_t k, const WaterView& water, const shm::Frame& frame) {
        CrowdWorld& crowd = crowds_[k].crowd;
        const std::uint64_t due = steps_due_at(crowd.scene, source_.info(), frame.tick);
        while (crowd.steps < due && !run_is_over(crowd)) {
            step_through(crowd, bins_);
            if (hooks_.on_step) hooks_.on_step(k, water);
        }
    }

    void walk_through(const shm::Frame& frame) {
        const WaterView water = ground_view(frame, source_.info());
        sort_water(water, frame);
        failures_.assign(walking_.size(), nullptr);
#pragma omp parallel for schedule(dynamic) num_threads(threads_) if (threads_ > 1)
        for (std::size_t i = 0; i < walking_.size(); ++i) {
            try {
                walk_one(walking_[i], water, frame);
            } catch (...) {
                failures_[i] = std::current_exception();
            }
        }
        for (const std::exception_ptr& failure : failures_) {
            if (failure) std::rethrow_exception(failure);
        }
        for (const std::size_t k : walking_) note_frame(crowds_[k].summary, source_, frame);
    }

    void end_crowds(bool stream_ends) {
        std::erase_if(walking_, [&](std::size_t k) {
            CrowdRun& run = crowds_[k];
            if (!stream_ends && !run_is_over(run.crowd)) return false;
            run.summary.status = status_at_end(run.crowd, run.summary);
            run.over = true;
            if (hooks_.on_over) hooks_.on_over(k);
            return true;
        });
    }

    std::span<CrowdRun> crowds_;
    FrameSource& source_;
    const CrowdsHooks& hooks_;
    int threads_;
    std::vector<std::size_t> walking_;  // crowds that are not over, ascending
    std::uint64_t last_frame_ = 0;
    WaterBins bins_;
    std::vector<Vector2d> positions_;
    std::vector<std::exception_ptr> failures_;
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
