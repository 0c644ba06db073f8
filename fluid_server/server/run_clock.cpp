#include "fluid_server/server/run_clock.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "configs/scene/scene_frames.hpp"

namespace wade::fluid {

namespace {

constexpr double slice = 0.05;           // s, the longest sleep
constexpr double late_tolerance = 1e-3;  // s, above what a sleep overruns on an idle machine

}  // namespace

Ticks ticks_of(double frame_rate) {
    std::uint64_t per_frame = 1;
    while (frame_rate * static_cast<double>(per_frame) < 1e6 && per_frame < 1'000'000'000'000) {
        per_frame *= 10;
    }
    const double per_second = frame_rate * static_cast<double>(per_frame);
    return {static_cast<std::uint64_t>(std::max(1LL, std::llround(per_second))), per_frame};
}

WallClock steady_wall_clock() {
    return {[] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); },
            [](double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }};
}

RunClock::RunClock(const Scene& scene, Pace pace, WallClock wall)
    : ticks_(ticks_of(scene.frame_rate)),
      end_tick_(frames_of(scene) * ticks_.per_frame),
      pace_(pace),
      wall_(std::move(wall)),
      interval_{0, 0, ticks_.per_second} {}

void RunClock::start() {
    start_ = wall_.now();
    followed_ = start_;
}

FrameInterval RunClock::next_frame(const Idle& idle) {
    const bool follows = pace_ == Pace::variable && interval_.end_tick > 0;
    const std::uint64_t duration = follows ? variable_duration(idle) : ticks_.per_frame;
    interval_.begin_tick = interval_.end_tick;
    interval_.end_tick = std::min(interval_.begin_tick + duration, end_tick_);
    if (pace_ == Pace::variable && !follows) followed_ = wall_.now();
    return interval_;
}

// What is left of a tick, and what the frame would have been too short for, counts for the next frame; what it would
// have been too long for is lost, so that a run that was held up does not jump.
std::uint64_t RunClock::variable_duration(const Idle& idle) {
    const auto per_second = static_cast<double>(ticks_.per_second);
    const std::uint64_t shortest = std::max<std::uint64_t>(1, ticks_.per_second / shortest_per_second);
    const std::uint64_t longest = longest_in_frames * ticks_.per_frame;
    wait_until(followed_ + static_cast<double>(shortest) / per_second, idle);
    const double now = wall_.now();
    const auto elapsed = static_cast<std::uint64_t>((now - followed_) * per_second);
    if (elapsed >= longest) {
        followed_ = now;
        return longest;
    }
    const std::uint64_t duration = std::max(elapsed, shortest);
    followed_ += static_cast<double>(duration) / per_second;
    return duration;
}

void RunClock::wait_until(double wall_time, const Idle& idle) {
    for (double left = wall_time - wall_.now(); left > 0; left = wall_time - wall_.now()) {
        idle();
        wall_.sleep_for(std::min(left, slice));
    }
}

void RunClock::wait_until_due(const Idle& idle) {
    if (pace_ == Pace::real_time) wait_until(due(), idle);
}

void RunClock::note_sent() {
    if (pace_ != Pace::real_time) return;
    const double lateness = wall_.now() - due();
    if (lateness > late_tolerance) ++late_frames_;
    worst_lateness_ = std::max(worst_lateness_, lateness);
}

void RunClock::pause() {
    if (paused_at_ < 0) paused_at_ = wall_.now();
}

void RunClock::resume() {
    if (paused_at_ < 0) return;
    discount(wall_.now() - paused_at_);
    paused_at_ = -1;
}

void RunClock::discount(double paused) {
    start_ += paused;
    followed_ += paused;
}

}  // namespace wade::fluid
