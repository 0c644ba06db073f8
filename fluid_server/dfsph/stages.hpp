#pragma once
// The stages of a step of the water and the time they take.

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

namespace wade::fluid {

enum class Stage : std::size_t {
    sort,        // by cell
    neighbours,  // which clusters see whom
    density,     // kernel, density, diagonal
    forces,      // viscosity, gravity, friction
    divergence_solve,
    density_solve,
    contact,  // with solids, at the end of either solve
    advance   // new positions, emitter
};
inline constexpr std::array<std::string_view, 8> stage_names{
    "sort", "neighbours", "density", "forces", "divergence_solve", "density_solve", "contact", "advance"};

using StageSeconds = std::array<double, stage_names.size()>;  // s of wall time

// Gives the time since its last call, or since it was made, to a stage.
class StageClock {
 public:
    explicit StageClock(StageSeconds& seconds) : seconds_(seconds) {}
    void finished(Stage stage) {
        const auto now = std::chrono::steady_clock::now();
        seconds_[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

 private:
    StageSeconds& seconds_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace wade::fluid
