#pragma once
// From a scale model, in its own units of length and time, to a stream in world units.
//
//   world metre  = metres_per_unit x model unit      stated in the header, positions are stored as they are
//   world second = time_scale      x model second    stated in the header's ticks, velocities are stored / time_scale
//   world kg     = metres_per_unit^3 x model kg      masses are stored in kg
//
// so that a reader who keeps to the header sees a body that moves as fast as its positions say. Gravity becomes
// g metres_per_unit / time_scale^2: similar to the model by Froude's law with time_scale = sqrt(metres_per_unit).

#include <array>
#include <cstdint>

#include "shm_protocol/stream.hpp"

namespace wade::splishsplash {

struct ModelUnits {
    double metres_per_unit = 1;
    double time_scale = 1;                      // world seconds in a second of the model
    std::array<double, 3> origin{};             // m
    std::array<std::int32_t, 3> axes{1, 2, 3};  // world axis i is the model's axis |axes[i]| - 1, mirrored if negative
    double frame_rate = 25;                     // frames in a second of the model
};

struct ModelParticle {
    double mass = 0;                  // kg in the model, whose litre holds rest density x unit^3 / 1000
    std::array<float, 3> position{};  // units
    std::array<float, 3> velocity{};  // units per second of the model
};

inline constexpr std::uint64_t ticks_per_frame = 1'000'000;

// Errors: std::invalid_argument that names the key, its value and its range.
void check(const ModelUnits& units);

// Header of the stream, without a session's choices (depth, slots). particle_radius in units, rest_density in kg/m3.
[[nodiscard]] shm::StreamInfo stream_info(const ModelUnits& units, std::uint32_t capacity, double particle_radius,
                                          double rest_density);

// Model time as the sum of its time steps. The simulator's own clock, a sum in single precision, drifts: after 12,000
// steps of 1/300 s by more than one of them.
class ModelClock {
 public:
    // The simulator's clock after a time step of this length, both in s; steps since the last call that were all as
    // long are counted, others are taken from the clock. The first call is one step after the start. Returns s.
    double advance(double clock, double step);

 private:
    bool started_ = false;
    double clock_ = 0;
    double time_ = 0;
};

// The tick of the model's time, s. Frame f is due at f / frame_rate; a time that is a whole number of frames up to the
// rounding of a time step to single precision is a whole number of frames in ticks too.
// Errors: std::invalid_argument if the time is more than one and a half frames off: readers count frames, so a model
// whose time steps are longer than a frame would run slow in their eyes.
[[nodiscard]] std::uint64_t tick_of_time(const ModelUnits& units, double time, std::uint64_t frame);

void store(const ModelUnits& units, const ModelParticle& particle, const shm::FrameFields& slot, std::size_t i);

}  // namespace wade::splishsplash
