#pragma once
// Fewer threads while others want the processors.
//
// Threads that share a loop wait for the one that has no processor, so that on a busy machine more threads take more from
// others than they give: two runs of two threads each on two processors made 0.72 of what they make with one thread each. The
// bits do not depend on the number of threads, so that it may change with each frame.

#include <algorithm>
#include <chrono>
#include <cmath>

namespace wade::fluid {

// How many threads to use, from period to period.
struct ThreadChoice {
    int most = 1;  // as many as were asked for
    int now = 1;
    int calm = 0;      // periods since the number changed
    int patience = 8;  // periods before one more thread is tried

    static constexpr int least_patience = 8, most_patience = 128;
    // More threads waiting for a processor than this are too many. The crowd of the same run, on a machine with as many
    // processors as threads, keeps 0.5 of one waiting at most: it works while the water does. Measured with two threads: 0.07
    // alone, 0.24 with 5,000 people in the water, 0.8 and 1.0 beside two busy programs and beside another such run.
    static constexpr double too_many_waiting = 0.65;

    // waiting: threads that were ready and had no processor, the mean over a period.
    void after_period(double waiting) {
        ++calm;
        if (waiting > too_many_waiting && now > 1) {
            // A trial that failed makes the next one rarer.
            patience = calm == 1 ? std::min(2 * patience, most_patience) : least_patience;
            now = std::max(1, now - static_cast<int>(std::lround(waiting)));
            calm = 0;
        } else if (now < most && calm >= patience) {
            ++now;
            calm = 0;
        }
    }
};

// The threads of this process, all together: how long they were ready and waited for a processor, s; negative if the system
// does not tell.
[[nodiscard]] double time_without_processor();

// Sets the number of threads of the loops of the calling thread, frame by frame.
class ThreadsInUse {
 public:
    ThreadsInUse();

    // To be called after each frame.
    void frame_done();

    [[nodiscard]] int now() const { return choice_.now; }

 private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds period{100};

    ThreadChoice choice_;
    Clock::time_point begin_;
    double waited_;  // s, at begin_
};

}  // namespace wade::fluid
