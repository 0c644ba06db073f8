#pragma once
// A stream in a channel: what the cases of open-channel flow measure in common.

#include <functional>
#include <string>
#include <vector>

#include "configs/scene/interval.hpp"
#include "profiles.hpp"
#include "run.hpp"
#include "water.hpp"

namespace wade::validation {

// Overrides of a scene that is a slice of a wide channel, from z = 0 on; see slice_width() for how wide.
std::vector<std::string> channel_slice(const Request& request);

// Advances to the time `from`, then to `to`, and averages over all frames of the second part in columns about `column` long.
// Times in s; column: m
Columns average_columns(Water& water, double from, double to, double column, Cost& cost);

// Discharge per width of a column, m^2/s, towards -x.
double discharge(const Columns& columns, std::size_t k);

// Returns the mean over the columns with centres in a range of x; NaN if there are none.
double mean_over(const Columns& columns, const Interval& x, const std::function<double(std::size_t)>& value);
double mean_depth(const Columns& columns, const Interval& x);      // m
double mean_discharge(const Columns& columns, const Interval& x);  // m^2/s

// Returns sqrt(sum (h - h_exact)^2 / sum h_exact^2) over the columns with centres in a range of x.
double depth_error(const Columns& columns, const Interval& x, const std::function<double(double)>& exact_depth);

// Returns the largest |q / q_mean - 1| of the columns with centres in a range of x.
double discharge_variation(const Columns& columns, const Interval& x);

}  // namespace wade::validation
