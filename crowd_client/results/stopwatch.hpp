#pragma once
// Wall time.

#include <chrono>

namespace wade::crowd {

class Stopwatch {
 public:
    // Returns the time since construction, s.
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

 private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace wade::crowd
