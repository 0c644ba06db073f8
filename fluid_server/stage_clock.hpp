#pragma once
// A step as a list of named stages, and the wall time that each of them takes.
//
//   enum class Stage : std::size_t { sort, advance };
//   StageClock<Stage, 2> stage(report.stages);
//   stage(Stage::sort, [&] { sort(); });
//   stage(Stage::advance, [&] { advance(); });

#include <array>
#include <chrono>
#include <cstddef>

namespace wade::fluid {

template <typename Stage, std::size_t count>
class StageClock {
 public:
    using Seconds = std::array<double, count>;  // by stage, s

    explicit StageClock(Seconds& seconds) : seconds_(&seconds) {}

    template <typename Work>
    void operator()(Stage stage, Work&& work) {
        work();
        finished(stage);
    }
    // Gives the time since the last call, or since the clock was made, to a stage.
    void finished(Stage stage) {
        const auto now = std::chrono::steady_clock::now();
        (*seconds_)[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

 private:
    Seconds* seconds_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace wade::fluid
