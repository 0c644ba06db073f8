#pragma once
// Checks whether the particles of a stream lie as the sampling cone of the crowd (felt_water.hpp) assumes.
//
// Points must lie densely enough. On a square grid of points d apart the cone of radius R errs by at most 3.6 % up to d = 0.53 R,
// 11 % at 2/3 R, 15 % at 1.06 R, 38 % at 1.2 R and 115 % at 1.5 R. So 0.53 R is allowed; where a scene states the spacing of its
// particles, R is made for that, and so is 4/3 of it for points anywhere in their cells. Columns must lie as far apart as they
// are wide, within 5 %.
//
// The gap of a point in a direction is the distance to the nearest other point within 50 degrees of it, ahead or behind, so that
// banks and fronts count on one side only. Four directions tell the longer side of stretched cells that are turned by any angle.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "crowd_client/water/felt_water.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

class SamplingDensity {
 public:
    // spacing: of the particles, as the scene states it, m
    SamplingDensity(const Feeling& feeling, double spacing);

    // Measures the gaps of a point in each of the 2 x 2 m cells of people, where the water is deeper than 0.2 m.
    // Returns a sentence for the user once 200 points are measured and lie wrong; to be called until is_decided().
    [[nodiscard]] std::optional<std::string> look(const WaterBins& bins, std::span<const Vector2d> positions);
    [[nodiscard]] bool is_decided() const { return gaps_[0].size() >= enough; }

    // Largest spacing of points that is allowed, m.
    [[nodiscard]] double widest() const { return widest_; }

 private:
    static constexpr std::size_t enough = 200;
    static constexpr std::size_t directions = 4;  // along x, diagonal, along z, diagonal

    void measure(const WaterBins& bins, const Vector2d& near);
    [[nodiscard]] double typical_gap(std::size_t direction);
    [[nodiscard]] std::optional<std::string> fault_of_points();
    [[nodiscard]] std::optional<std::string> fault_of_columns(const Vector2d& width);

    double radius_, density_, widest_;
    std::array<std::vector<double>, directions> gaps_;        // m, by point
    std::vector<std::pair<std::size_t, std::size_t>> cells_;  // of a step, with a person in each
};

}  // namespace wade::crowd
