#include "fluid_server/server/threads_in_use.hpp"

#include <omp.h>

#include <filesystem>
#include <fstream>

namespace wade::fluid {

// /proc/PID/task/TID/schedstat: time on a processor, time ready without one, both in ns, and time slices.
double time_without_processor() {
    double all = 0;
    std::error_code error;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error)) {
        std::ifstream file(task.path() / "schedstat");
        double on = 0, without = 0;
        if (file >> on >> without) all += 1e-9 * without;  // a thread may have ended meanwhile
    }
    return error ? -1 : all;
}

ThreadsInUse::ThreadsInUse() : begin_(Clock::now()), waited_(time_without_processor()) {
    choice_.most = choice_.now = omp_get_max_threads();
}

void ThreadsInUse::frame_done() {
    const Clock::time_point end = Clock::now();
    if (choice_.most == 1 || waited_ < 0 || end - begin_ < period) return;
    const double waited = time_without_processor();
    choice_.after_period((waited - waited_) / std::chrono::duration<double>(end - begin_).count());
    omp_set_num_threads(choice_.now);
    begin_ = end, waited_ = waited;
}

}  // namespace wade::fluid
