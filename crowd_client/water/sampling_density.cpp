#include "crowd_client/water/sampling_density.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdio>

namespace wade::crowd {
namespace {

constexpr double of_radius = 0.53, of_spacing = 4.0 / 3;
constexpr double least_depth = 0.2;  // m
constexpr double quantile = 0.9;     // of the counts: banks, fronts and walls leave fewer points

// Number of distinct positions of the points in a cell, to 1/8 m; points above one another count once.
std::uint16_t positions_in(const WaterBins& bins, std::size_t cell) {
    constexpr int parts = 16;
    std::bitset<std::size_t{parts} * parts> taken;
    const auto part = [](double place) {
        const double share = place / GroundGrid::cell_size;
        return std::min(parts - 1, static_cast<int>(parts * (share - std::floor(share))));
    };
    for (std::size_t k = bins.cell_start[cell]; k < bins.cell_start[cell + 1]; ++k) {
        taken.set(static_cast<std::size_t>(part(bins.z[k]) * parts + part(bins.x[k])));
    }
    return static_cast<std::uint16_t>(taken.count());
}

}  // namespace

SamplingDensity::SamplingDensity(const Feeling& feeling, double spacing)
    : radius_(feeling.spread),
      density_(feeling.rest_density),
      widest_(std::max(of_radius * feeling.spread, of_spacing * spacing)) {}

std::optional<std::string> SamplingDensity::look(const WaterBins& bins, std::span<const Vector2d> positions) {
    cells_.clear();
    for (const Vector2d& place : positions) cells_.push_back(bins.grid.cell_of(place.x(), place.y()));
    std::sort(cells_.begin(), cells_.end());
    cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
    for (const std::size_t cell : cells_) {
        constexpr double area = GroundGrid::cell_size * GroundGrid::cell_size;
        if (is_decided() || !(sum_of_cell(bins, cell).mass > least_depth * density_ * area)) continue;
        counts_.push_back(positions_in(bins, cell));
    }
    if (!is_decided()) return {};
    const auto high = counts_.begin() + static_cast<std::ptrdiff_t>(quantile * static_cast<double>(counts_.size()));
    std::nth_element(counts_.begin(), high, counts_.end());
    const double spacing = GroundGrid::cell_size / std::sqrt(static_cast<double>(*high));
    if (spacing <= widest_) return {};
    char text[400];
    std::snprintf(text, sizeof text,
                  "people sample the water within %.2g m, and its points lie %.2g m apart where they stand (allowed: "
                  "%.2g m), so that "
                  "the depth that they sample errs by more than 5 %%; depth-averaged water: set Header.column_width "
                  "(wade_columns), "
                  "particles: /fluid/particle_spacing_m (docs/people_in_water.md, \"How densely water is sampled\")",
                  radius_, spacing, widest_);
    return text;
}

}  // namespace wade::crowd
