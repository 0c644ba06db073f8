#pragma once
// The time of the water's frames, and the steps of the crowd that they lead to.
//
//   frames, 30 a second    1     2     3     4        step k is taken at k / step_rate, through the newest frame then
//   steps, 45 a second     1    2 3    4    5 6

#include <cstdint>
#include <string>

#include "configs/scene/scene.hpp"
#include "shm_protocol/stream.hpp"

namespace wade::crowd {

// Simulated time of a frame with this tick, s.
[[nodiscard]] double time_of_tick(const shm::StreamInfo& info, std::uint64_t tick);

// Returns the crowd steps that are due once the water has reached `tick`, at most all of the run. Counts frames if the
// header states the scene's frame length, because a rate rounded to whole ticks drifts.
[[nodiscard]] std::uint64_t steps_due_at(const Scene& scene, const shm::StreamInfo& info, std::uint64_t tick);

// A sentence for the user if the stream's frames are not as long as the scene's, else empty.
[[nodiscard]] std::string rate_note(const Scene& scene, const shm::StreamInfo& info);

}  // namespace wade::crowd
