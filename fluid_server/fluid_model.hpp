#pragma once
// What the server asks of a model of the water, a few calls a frame. All the rest of the server is the same for each.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/ranks.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::fluid {

// The time that a frame spans, (begin, end]. Counted in ticks, so that sums of durations do not drift.
struct FrameInterval {
    std::uint64_t begin_tick = 0;
    std::uint64_t end_tick = 0;
    std::uint64_t ticks_per_second = 1;

    [[nodiscard]] double duration() const {  // s
        return static_cast<double>(end_tick - begin_tick) / static_cast<double>(ticks_per_second);
    }
    [[nodiscard]] double end() const {  // s
        return static_cast<double>(end_tick) / static_cast<double>(ticks_per_second);
    }
};

// The crowd as it was at `tick`, one entry an agent in each span; in place, valid during the call only.
struct AgentsView {
    std::uint64_t frame = 0;
    std::uint64_t tick = 0;
    std::span<const float> mass;            // kg
    std::span<const float> vx, vy, vz;      // m/s
    std::span<const float> px, py, pz;      // m
    std::span<const float> radius, height;  // m
    std::span<const float> state;           // shm::AgentState
    // What people got from the water, N s along x and z, and thus take from it in the frame that follows; their depth in it and
    // the radius over which they take it, m. Empty where the crowd does not push back.
    std::span<const float> jx = {}, jz = {}, submerged = {}, spread = {};
};

struct FluidState;

// What is known of the water before a numerical failure. Null where there is nothing.
struct FailureStates {
    const FluidState* frame_begin = nullptr;  // at the begin of the frame that failed
    const FluidState* last_sound = nullptr;  // the same or an earlier one, the last that better settings can go on from
};

class FluidModel {
 public:
    FluidModel() = default;
    FluidModel(const FluidModel&) = delete;
    FluidModel& operator=(const FluidModel&) = delete;
    virtual ~FluidModel() = default;

    // The producer's name in the header of the stream.
    [[nodiscard]] virtual std::string_view name() const = 0;

    // The most particles that a frame can hold, at least 1.
    [[nodiscard]] virtual std::uint32_t capacity() const = 0;

    // Width of the columns that a frame holds along x and z, m (shm::StreamInfo::column_width).
    [[nodiscard]] virtual std::array<double, 2> column_width() const { return {}; }

    // Call before the first frame: the same model in several processes then works as one. After advance_frame() the
    // first process has the water of all, and it alone writes frames and results. Throws ConfigurationError if a model
    // or a scene cannot be spread.
    virtual void spread_over(Ranks& ranks) {
        static_cast<void>(ranks);
        throw ConfigurationError("/fluid/model is " + std::string(name()) +
                                 "; allowed over ranks: shallow_water, the only model that can be spread");
    }

    // The agents that the next frame is computed with, before advance_frame(). A model may ignore them.
    virtual void take_agents(const AgentsView& agents) { static_cast<void>(agents); }

    // Computes the water at the end of the interval, which begins where the last one ended; the first begins at 0.
    // Throws RunError (numerical_failure).
    virtual shm::Diagnostics advance_frame(const FrameInterval& interval) = 0;

    // Writes the particles of the frame just computed into its slot; returns their number.
    virtual std::uint32_t write_frame(const shm::FrameFields& slot) const = 0;

    // The complete state after the last frame, to go on from later; null if the model has none that can be kept.
    // Valid until the next call.
    [[nodiscard]] virtual const FluidState* state() { return nullptr; }

    // Once advance_frame() has thrown a numerical failure.
    [[nodiscard]] virtual FailureStates states_before_failure() const { return {}; }

    // Goes on from a state instead of the scene's t = 0; before the first frame. `source` begins the ConfigurationError
    // that is thrown if it does not fit.
    virtual void restore(const FluidState& state, const std::string& source) {
        static_cast<void>(state);
        throw ConfigurationError(source + ": /fluid/model is " + std::string(name()) +
                                 "; allowed: dfsph, the only model that has a state");
    }

    // Writes files of its own into the folder of the run at its end, however it ends. Throws std::runtime_error.
    virtual void write_results(const std::filesystem::path& folder) const { static_cast<void>(folder); }

    // What a user should know at the end and no diagnostic says; empty if there is nothing.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

}  // namespace wade::fluid
