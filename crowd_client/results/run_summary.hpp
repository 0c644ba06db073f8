#pragma once
// How a run went: its status, its frames, its hashes, the health of its water.

#include <cstdint>
#include <exception>
#include <optional>
#include <string>

#include "crowd_client/crowd_world.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::crowd {

// Mean of values that may be missing, each with a weight.
struct WeightedMean {
    double sum = 0;
    double weight = 0;

    void add(double value, double its_weight);  // a NaN is left out
    [[nodiscard]] std::optional<double> value() const;
};

// Means and maxima over the frames that begin at or after `settling_time`; values that no frame gave stay empty.
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

// Adds one frame with its state at `time` (s); dt is the length of a frame.
void add_frame(FluidSummary& summary, const shm::Frame& frame, double time, double dt);

// Momentum exchange of people and water along x and z up to the last frame, N s; for a crowd that pushes the water.
struct MomentumBalance {
    Vector2d got = Vector2d::Zero();      // by people
    Vector2d lost = Vector2d::Zero();     // by the water
    Vector2d missing = Vector2d::Zero();  // that the water no longer had

    // Returns the water's loss less the people's gain, corrected by the missing part, N s.
    [[nodiscard]] double difference() const { return (lost + missing - got).norm(); }
};

// Returns the balance from the water's diagnostics; none if they give none, as without two-way coupling.
[[nodiscard]] std::optional<MomentumBalance> momentum_balance(const shm::Diagnostics& diagnostics, const Vector2d& got);

// How a run went so far. Kept by the caller, so that it is complete up to the last frame when the loop throws.
struct RunSummary {
    std::string status = "running";
    std::string message;               // why the run ended badly, a full sentence
    std::uint64_t frames = 0;          // of the water, taken
    std::uint64_t last_frame = 0;      // number of the last of them
    double time = 0;                   // s, of the last of them
    std::uint64_t dropped_frames = 0;  // not received, outside lockstep only
    std::uint64_t frame_hash = 0;      // chain over them; 0 = unknown, as it is outside lockstep
    std::uint64_t agents_hash = 0;     // chain over the frames of agents, 0 = none were made
    FluidSummary fluid;
    std::optional<MomentumBalance> momentum;
};

// Returns whether the step just taken is the last: the duration is over, or all agents have arrived or died and the
// scene says that the run ends then. A scene without agents runs for its whole duration.
[[nodiscard]] bool run_is_over(const CrowdWorld& crowd);

// Returns the status for an exit code: "interrupted", "peer_dead", ...
[[nodiscard]] std::string status_of(int exit_code);

// Returns the status of a run that an error ends: that of its exit code, or "disk_full".
[[nodiscard]] std::string status_of(const std::exception& error);

// Ends the summary of a run without errors, after its last frame: "completed", or "stream_ended" with a message.
void end_summary(RunSummary& summary, const CrowdWorld& crowd);

// Ends the summary of a run that an error ends. A run that ended well has failed, too, if its files cannot be written.
// A run that failed before keeps its first reason.
void fail_summary(RunSummary& summary, const std::exception& error);

}  // namespace wade::crowd
