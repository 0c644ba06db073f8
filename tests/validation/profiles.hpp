#pragma once
// Depth and mean velocity of the water in columns along x.

#include <cstddef>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::validation {

// Equal columns over [x.lo, x.hi], all across a channel of the width. Samples may be summed over several frames.
struct Columns {
    Interval x;                    // m
    double width = 0;              // of the channel, m
    std::vector<double> volume;    // of the particles in each column, m^3
    std::vector<double> momentum;  // volume * velocity along x, m^4/s
    double samples = 0;            // frames

    [[nodiscard]] std::size_t count() const { return volume.size(); }
    [[nodiscard]] double length() const { return x.length() / static_cast<double>(count()); }  // of a column, m
    [[nodiscard]] double centre(std::size_t k) const { return x.lo + (static_cast<double>(k) + 0.5) * length(); }
    [[nodiscard]] double depth(std::size_t k) const { return volume[k] / (samples * length() * width); }
    // m/s, along +x; 0 where there is no water
    [[nodiscard]] double velocity(std::size_t k) const { return volume[k] > 0 ? momentum[k] / volume[k] : 0; }
};

// Columns as near to `column` long as the extent allows. column: m
Columns make_columns(const Interval& x, double width, double column);

// Adds a frame: each fluid particle is a cube of the spacing and counts to the columns that it lies in, so that a lattice at
// rest has the same depth in columns of any length. What lies beyond the columns does not count. spacing: m
void sample(const fluid::Particles& particles, double spacing, Columns& columns);

// Where the water reaches to: the smallest x of all fluid particles, m; `none` if there are none.
double leading_x(const fluid::Particles& particles, double none);

// The pth quantile of values, 0 <= p <= 1, between neighbours linearly; NaN of none.
double quantile(std::vector<double> values, double p);

}  // namespace wade::validation
