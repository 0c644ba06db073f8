#pragma once
// How long a run still takes, from how long it took and how its water grows.
//
// In the last fifth of the wall time the run needed c seconds for each particle and simulated second. Particles come at the
// rate of that time until there are as many as the scene takes, n_max:
//
//   left = c * integral of min(n_max, n + n' (t - now)) over the rest of the simulated time

#include <optional>
#include <string>
#include <vector>

namespace wade {

class TimeLeft {
 public:
    // end: of the simulated time, s; most: n_max.
    TimeLeft(double end, double most) : end_(end), most_(most) {}

    // After a frame: simulated and wall time since the run began, s, both growing, and the particles there are.
    void note(double simulated, double wall, double particles);

    // Wall time that is left, s; nothing while too little has been seen.
    [[nodiscard]] std::optional<double> seconds() const;

    // Simulated over wall time, of the last fifth of the wall time; 0 while it is not known.
    [[nodiscard]] double pace() const;

 private:
    struct Mark {
        double simulated = 0, wall = 0, particles = 0;
    };
    double end_, most_;
    Mark now_;
    std::vector<Mark> marks_;  // some ten of the last fifth, the oldest first
};

// "40 s", "6 min", "3 h": rounded up.
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace wade
