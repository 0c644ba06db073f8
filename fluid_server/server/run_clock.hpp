#pragma once
// The pace of a run: which simulated time a frame spans, and when it may be sent.
//
//   clock.start();
//   while (!clock.ended()) {
//       const FrameInterval interval = clock.next_frame(idle);
//       ... compute ...
//       clock.wait_until_due(idle);
//       ... send ...
//       clock.note_sent();
//   }

#include <cstdint>
#include <functional>

#include "configs/scene/scene.hpp"
#include "fluid_server/fluid_model.hpp"

namespace wade::fluid {

enum class Pace {
    fast,       // every frame lasts 1 / frame_rate and is sent as soon as it is ready
    real_time,  // the same frames, none sent before its time has come on the wall clock
    variable    // a frame lasts as long as the wall time since the one before: simulated time follows the wall clock
};

// The unit of time of a stream.
struct Ticks {
    std::uint64_t per_second = 1;
    std::uint64_t per_frame = 1;
};

// A power of ten a frame and at least a million a second, so that a rate such as 29.97 frames/s is a whole number of
// ticks and rounding changes no rate by more than 5e-7 of itself.
[[nodiscard]] Ticks ticks_of(double frame_rate);

// Where the wall time comes from; tests bring their own and never sleep.
struct WallClock {
    std::function<double()> now;            // s, never goes back
    std::function<void(double)> sleep_for;  // s; may return early
};
[[nodiscard]] WallClock steady_wall_clock();

class RunClock {
 public:
    // A frame of variable duration lasts between 1/1000 s and four times 1 / frame_rate; only the last may be shorter.
    static constexpr std::uint64_t shortest_per_second = 1000;
    static constexpr std::uint64_t longest_in_frames = 4;

    // Runs to the end of the scene, whatever the pace.
    RunClock(const Scene& scene, Pace pace, WallClock wall = steady_wall_clock());

    // Called at least 20 times a second while the clock lets the caller wait; may throw to end the wait.
    using Idle = std::function<void()>;

    void start();
    [[nodiscard]] bool ended() const { return interval_.end_tick == end_tick_; }
    FrameInterval next_frame(const Idle& idle);
    void wait_until_due(const Idle& idle);
    void note_sent();

    // Wall time between the two does not count. A pause may be begun again while it lasts.
    void pause();
    void resume();
    // The same for a pause of the other side, told afterwards. s
    void discount(double paused);

    [[nodiscard]] Pace pace() const { return pace_; }
    [[nodiscard]] double end() const {  // s
        return static_cast<double>(end_tick_) / static_cast<double>(ticks_.per_second);
    }
    [[nodiscard]] double simulated() const { return interval_.end(); }        // s
    [[nodiscard]] std::uint64_t late_frames() const { return late_frames_; }  // sent over 1 ms after they were due
    [[nodiscard]] double worst_lateness() const { return worst_lateness_; }   // s

 private:
    void wait_until(double wall_time, const Idle& idle);
    [[nodiscard]] double due() const { return start_ + interval_.end(); }
    std::uint64_t variable_duration(const Idle& idle);

    Ticks ticks_;
    std::uint64_t end_tick_;
    Pace pace_;
    WallClock wall_;
    FrameInterval interval_;
    double start_ = 0;     // wall time of tick 0, s
    double followed_ = 0;  // wall time that the simulated time has reached, s
    double paused_at_ = -1;
    std::uint64_t late_frames_ = 0;
    double worst_lateness_ = 0;
};

}  // namespace wade::fluid
