#pragma once
// Between the structs of the C ABI and those of C++.

#include "shm_protocol/c_api/wade_shm.h"
#include "shm_protocol/stream.hpp"

namespace wade::shm::c_api {

// Errors: std::invalid_argument for a name without an end.
StreamInfo from_c(const wade_stream& stream);
Waiting from_c(const wade_waiting* waiting);  // null = the defaults; wade_interrupt() always interrupts
JoinOptions from_c(const wade_join* join);
Diagnostics from_c(const wade_diagnostics* diagnostics);

wade_stream to_c(const StreamInfo& info);
wade_slot to_c(const FrameFields& fields);
wade_frame to_c(const Frame& frame);
wade_slot_impulses impulses_to_c(const FrameFields& fields);
wade_frame_impulses impulses_to_c(const Frame& frame);

void set_interrupt(bool on) noexcept;

}  // namespace wade::shm::c_api
