#pragma once
// Flow sampled at a person: means of the whole column over a cone around the person.
//
//   w(r) = max(0, 1 - r / R)                             r: distance in the ground plane, m
//   R     = 0.5 m                         of columns (StreamInfo::column_width); w_i is the mean of w over the rectangle of column i,
//                                         less what is solid, so that the sampled depth does not depend on the width of the columns
//   R     = max(0.5 m, 1.5 d)             of points, d their spacing (on a site that of the cells, with R up to 2 m)
//   S     = sum w_i m_i                   kg
//   theta = sum w_i^2 m_i / S             0.5 in even water; F / S * theta is how fast a force F slows U
//   U     = sum w_i m_i v_i / S           m/s
//   h     = S / (rho I)                   m;  I = integral of w over the ground of the channel that no box or house stands on, m2
//
// A disc of 0.25 m around the person holds so few particles of 0.46 m that (h U)^2, which topples people, changes
// by 79 % from frame to frame in an even river; with the cone by 6 to 8 %. I includes dry ground, because the front of
// a flood is thin. It excludes walls, because they would halve the depth. The same weights spread a force over the
// water, so that the person gains the momentum that the water loses.

#include <cstddef>
#include <span>
#include <vector>

#include "configs/scene/interval.hpp"
#include "crowd_client/markers/placed_boxes.hpp"
#include "crowd_client/markers/placed_houses.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

struct FeltWater {
    Vector2d velocity = Vector2d::Zero();  // U, m/s; 0 without water
    double depth = 0;                      // h, m
    double weight = 0;                     // S, kg
    double theta = 0;                      // 0 without water
    double spread = 0;                     // R, m
};

// Rules for sampling the flow at people; the same for all of a run.
struct Feeling {
    double spread = 0.5;       // R, m
    double disc_radius = 0.5;  // of the water that a person slows: R, but no less than the width of a column, m
    double rest_density = 0;   // rho, kg/m3
    Interval x, z;             // ground of the channel, m; without ends along x where the world is periodic
    PlacedBoxes boxes;         // a periodic world has three copies of them, a world's length apart
    PlacedHouses houses;       // their cells may hold the water of cells that they cut
};

// Returns the sampling rules of a scene. column: width of the columns along x and z, m, 0 for points. Throws
// ConfigurationError for points more than 4/3 m apart, because their cone would reach beyond the sorted water.
[[nodiscard]] Feeling make_feeling(const Scene& scene, const Vector2d& column = Vector2d::Zero());

// Returns I at a position in the channel: the integral of w over what is not solid, m2; pi R^2 / 3 in the open.
[[nodiscard]] double open_ground(const Feeling& feeling, const Vector2d& place);

// Returns the flow sampled at `place`; zero beside the channel, where people stand above the water.
[[nodiscard]] FeltWater feel_water(const Feeling& feeling, const WaterBins& bins, const Vector2d& place);

// Returns half of the vorticity about y at `place`, rad/s: the rate at which the water turns drifting bodies. Fits a
// linear field to the velocities in the cone, with its weights. Returns 0 with too few particles for a fit, or beside
// the channel.
[[nodiscard]] double spin_of_water(const Feeling& feeling, const WaterBins& bins, const Vector2d& place);

// Samples the flow at each of `positions`, with at most `threads` threads, which change no bit.
void feel_water(const Feeling& feeling, const WaterBins& bins, std::span<const Vector2d> positions, int threads,
                std::vector<FeltWater>& felt);

}  // namespace wade::crowd
