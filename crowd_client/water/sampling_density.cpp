#include "crowd_client/water/sampling_density.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "crowd_client/water/near_water.hpp"

namespace wade::crowd {
namespace {

constexpr double of_radius = 0.53, of_spacing = 4.0 / 3;
constexpr double cosine_of_sector =
    0.643;                           // of 50 degrees: sectors overlap, so that lattices at 45 degrees are in both
constexpr double least_depth = 0.2;  // m
constexpr double farthest = GroundGrid::cell_size;  // m; bins hold the water that far round the cells of people
constexpr double none = 2 * farthest;               // gap of a point without neighbours, m
constexpr double largest_misfit = 0.05;             // of columns

// Number of the point of a cell that is nearest to a position.
std::size_t nearest_in(const WaterBins& bins, std::size_t cell, const Vector2d& position) {
    const auto square = [&](std::size_t k) { return (Vector2d(bins.x[k], bins.z[k]) - position).squaredNorm(); };
    std::size_t nearest = bins.cell_start[cell];
    for (std::size_t k = nearest; k < bins.cell_start[cell + 1]; ++k) {
        if (square(k) < square(nearest)) nearest = k;
    }
    return nearest;
}

}  // namespace

SamplingDensity::SamplingDensity(const Feeling& feeling, double spacing)
    : radius_(feeling.spread),
      density_(feeling.rest_density),
      widest_(std::max(of_radius * feeling.spread, of_spacing * spacing)) {}

void SamplingDensity::measure(const WaterBins& bins, const Vector2d& near) {
    // Points nearer than half of the allowed spacing may lie above one another.
    const double least = bins.has_columns() ? 0.01 * bins.column.minCoeff() : 0.5 * widest_;
    constexpr double half = std::numbers::sqrt2 / 2;
    const std::array<Vector2d, directions> along{Vector2d(1, 0), Vector2d(half, half), Vector2d(0, 1),
                                                 Vector2d(-half, half)};
    std::array<double, directions> gaps;
    gaps.fill(none);
    const std::size_t point = nearest_in(bins, bins.grid.cell_of(near.x(), near.y()), near);
    const Vector2d from(bins.x[point], bins.z[point]);
    for_each_particle_near(bins, from, (1 + largest_misfit) * farthest, [&](std::size_t k) {
        const Vector2d way = Vector2d(bins.x[k], bins.z[k]) - from;
        const double distance = std::sqrt(way.squaredNorm());
        if (distance < least) return;
        for (std::size_t d = 0; d < directions; ++d) {
            if (std::abs(way.dot(along[d])) >= cosine_of_sector * distance) gaps[d] = std::min(gaps[d], distance);
        }
    });
    for (std::size_t d = 0; d < directions; ++d) gaps_[d].push_back(gaps[d]);
}

double SamplingDensity::typical_gap(std::size_t direction) {
    std::vector<double>& gaps = gaps_[direction];
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::nth_element(gaps.begin(), middle, gaps.end());
    return *middle;
}

std::optional<std::string> SamplingDensity::fault_of_points() {
    double spacing = 0;
    for (std::size_t d = 0; d < directions; ++d) spacing = std::max(spacing, typical_gap(d));
    if (spacing <= widest_) return {};
    char text[400];
    std::snprintf(text, sizeof text,
                  "people sample the water within %.2g m, and its points lie %.2g m %sapart where they stand (allowed: "
                  "%.2g m), so that the depth that they sample errs by more than 5 %%; depth-averaged water: set "
                  "Header.column_width (wade_columns), particles: /fluid/particle_spacing_m (docs/people_in_water.md, "
                  "\"How densely water is sampled\")",
                  radius_, spacing, spacing < none ? "" : "or more ", widest_);
    return text;
}

std::optional<std::string> SamplingDensity::fault_of_columns(const Vector2d& width) {
    const Vector2d apart(typical_gap(0), typical_gap(2));
    const auto fits = [](double gap, double stated) { return std::abs(gap - stated) <= largest_misfit * stated; };
    if (fits(apart.x(), width.x()) && fits(apart.y(), width.y())) return {};
    char text[400];
    std::snprintf(
        text, sizeof text,
        "Header.column_width states columns of %.3g x %.3g m, and they lie %.3g x %.3g m %sapart where people "
        "stand, so that the depth that they sample is %.2g times that of the water; set it to the size of the "
        "cells, of at most 2 m (wade_columns, docs/people_in_water.md, \"How densely water is sampled\")",
        width.x(), width.y(), apart.x(), apart.y(), apart.maxCoeff() < none ? "" : "or more ",
        apart.x() * apart.y() / (width.x() * width.y()));
    return text;
}

std::optional<std::string> SamplingDensity::look(const WaterBins& bins, std::span<const Vector2d> positions) {
    cells_.clear();
    for (std::size_t k = 0; k < positions.size(); ++k) {
        cells_.emplace_back(bins.grid.cell_of(positions[k].x(), positions[k].y()), k);
    }
    std::sort(cells_.begin(), cells_.end());
    const auto same_cell = [](const auto& a, const auto& b) { return a.first == b.first; };
    cells_.erase(std::unique(cells_.begin(), cells_.end(), same_cell), cells_.end());
    for (const auto& [cell, k] : cells_) {
        constexpr double area = GroundGrid::cell_size * GroundGrid::cell_size;
        if (is_decided() || !(sum_of_cell(bins, cell).mass > least_depth * density_ * area)) continue;
        measure(bins, positions[k]);
    }
    if (!is_decided()) return {};
    return bins.has_columns() ? fault_of_columns(bins.column) : fault_of_points();
}

}  // namespace wade::crowd
