#pragma once
// Depth-averaged water of others as the columns of a stream (StreamInfo::column_width).

#include <cstdint>

#include "shm_protocol/c_api/wade_shm.h"

namespace wade::shm::c_api {

// Sets capacity, column_width and, where it is 0, rest_density of a stream for this grid: cells wider than 2 m are divided equally.
// Errors: std::invalid_argument for a grid that cannot be columns.
void suit_to_grid(const wade_grid& grid, wade_stream& stream);

// Writes the columns of the wet cells into a slot; returns their number. The stream is one that suit_to_grid() has set.
// Errors: std::invalid_argument, which names cell and value.
std::uint32_t write_columns(const wade_grid& grid, const wade_stream& stream, const wade_slot& slot);

}  // namespace wade::shm::c_api
