#pragma once
// Whether the points of a stream lie densely enough for the sampling cone of the crowd (felt_water.hpp).
//
// On a square grid of points d apart the cone of radius R errs by at most 3.6 % up to d = 0.53 R, 11 % at 2/3 R, 15 % at 1.06 R,
// 38 % at 1.2 R and 115 % at 1.5 R. So 0.53 R is allowed; where a scene states the spacing of its particles, R is made for that,
// and so is 4/3 of it, as a cell of 2 m cuts a grid by up to that much.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "crowd_client/water/felt_water.hpp"
#include "crowd_client/water/water_bins.hpp"

namespace wade::crowd {

class SamplingDensity {
 public:
    // spacing: of the particles, as the scene states it, m
    SamplingDensity(const Feeling& feeling, double spacing);

    // Counts the points of the 2 x 2 m cells around people, where the water is deeper than 0.2 m. Returns a sentence for the
    // user once 200 cells were counted and the points are too far apart; to be called until is_decided().
    [[nodiscard]] std::optional<std::string> look(const WaterBins& bins, std::span<const Vector2d> positions);
    [[nodiscard]] bool is_decided() const { return counts_.size() >= enough; }

    // Largest spacing of points that is allowed, m.
    [[nodiscard]] double widest() const { return widest_; }

 private:
    static constexpr std::size_t enough = 200;

    double radius_, density_, widest_;
    std::vector<std::uint16_t> counts_;  // distinct positions, by cell and step
    std::vector<std::size_t> cells_;     // of a step
};

}  // namespace wade::crowd
