#pragma once
// What the diagnostics that travel with the frames say about the water of a whole run.

#include <cstdint>
#include <optional>

#include "shm_protocol/stream.hpp"

namespace wade::crowd {

// Mean of values that may be missing, each with a weight.
struct WeightedMean {
    double sum = 0;
    double weight = 0;

    void add(double value, double its_weight);  // a NaN is left out
    [[nodiscard]] std::optional<double> value() const;
};

// Means and maxima over the frames that begin at or after `settling_time`; what no frame gave stays empty.
struct FluidSummary {
    static constexpr double settling_time = 1;  // s; the first second of a run is not representative

    std::uint32_t particles_max = 0;
    std::uint64_t steps = 0;           // time steps of the solver
    std::uint64_t particle_steps = 0;  // particles times time steps
    std::uint64_t solver_ns = 0;
    std::uint64_t position_clamps = 0;
    std::uint64_t recycled_particles = 0;
    std::uint64_t resident_bytes = 0;  // the largest seen
    WeightedMean depth, speed;         // m, m/s; each frame counts once
    WeightedMean density_error;        // fraction; each time step counts once
    std::optional<double> max_density_error;
};

// Takes in one frame, whose state is at `time` (s); dt is the length of a frame.
void add_frame(FluidSummary& summary, const shm::Frame& frame, double time, double dt);

}  // namespace wade::crowd
