#include "configs/program/time_left.hpp"

#include <algorithm>
#include <cmath>

namespace wade {

void TimeLeft::note(double simulated, double wall, double particles) {
    constexpr double window = 0.2, between_marks = 0.02;  // of the wall time
    now_ = {simulated, wall, particles};
    while (marks_.size() > 1 && marks_[1].wall <= (1 - window) * wall) marks_.erase(marks_.begin());
    if (marks_.empty() || wall > (1 + between_marks) * marks_.back().wall) marks_.push_back(now_);
}

double TimeLeft::pace() const {
    if (marks_.empty() || now_.wall <= marks_.front().wall) return 0;
    return (now_.simulated - marks_.front().simulated) / (now_.wall - marks_.front().wall);
}

std::optional<double> TimeLeft::seconds() const {
    if (pace() <= 0) return std::nullopt;
    const Mark& from = marks_.front();
    const double span = now_.simulated - from.simulated;
    const double n = std::max(1.0, now_.particles), seen = std::max(1.0, 0.5 * (from.particles + now_.particles));
    const double cost = (now_.wall - from.wall) / (span * seen);
    const double rest = std::max(0.0, end_ - now_.simulated), most = std::max(n, most_);
    const double growth = std::max(0.0, (now_.particles - from.particles) / span);
    const double grows = growth > 0 ? std::min(rest, (most - n) / growth) : 0;  // s until it is full
    const double later = n + growth * grows;
    return cost * (0.5 * (n + later) * grows + later * (rest - grows));
}

std::string duration_text(double seconds) {
    const auto whole = static_cast<long>(std::ceil(seconds));
    if (whole < 100) return std::to_string(whole) + " s";
    if (whole < 6000) return std::to_string((whole + 59) / 60) + " min";
    return std::to_string((whole + 3599) / 3600) + " h";
}

}  // namespace wade
