#include "crowd_client/biocrowds.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace wade::crowd {
namespace {

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

void sort_walkers_by_cell(MarkerClaims& claims, const GroundGrid& grid, std::span<const Vector2d> walkers) {
    claims.walker_cell_start.assign(grid.cells() + 1, 0);
    for (const Vector2d& p : walkers) ++claims.walker_cell_start[grid.cell_of(p.x(), p.y()) + 1];
    std::uint32_t before = 0;
    for (std::size_t c = 0; c < grid.cells(); ++c) {
        const std::uint32_t count = claims.walker_cell_start[c + 1];
        claims.walker_cell_start[c + 1] = before;
        before += count;
    }
    claims.walkers_by_cell.resize(walkers.size());
    for (std::size_t k = 0; k < walkers.size(); ++k) {
        const std::size_t cell = grid.cell_of(walkers[k].x(), walkers[k].y());
        claims.walkers_by_cell[claims.walker_cell_start[cell + 1]++] = static_cast<std::uint32_t>(k);
    }
}

// Walkers whose disc of perception reaches into the cell.
void find_candidates(MarkerClaims& claims, const GroundGrid& grid, std::span<const Vector2d> walkers, int column,
                     int row, double radius) {
    claims.candidates.clear();
    const double x_lo = GroundGrid::line_start(column);
    const double x_hi = GroundGrid::line_start(column + 1);
    const double z_lo = GroundGrid::line_start(row);
    const double z_hi = GroundGrid::line_start(row + 1);
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid.rows - 1); ++r) {
        const std::size_t first = grid.index(std::max(column - 1, 0), r);
        const std::size_t last = grid.index(std::min(column + 1, grid.columns - 1), r);
        for (std::size_t i = claims.walker_cell_start[first]; i < claims.walker_cell_start[last + 1]; ++i) {
            const std::uint32_t k = claims.walkers_by_cell[i];
            const double gap_x = std::max({x_lo - walkers[k].x(), walkers[k].x() - x_hi, 0.0});
            const double gap_z = std::max({z_lo - walkers[k].y(), walkers[k].y() - z_hi, 0.0});
            if (gap_x * gap_x + gap_z * gap_z <= radius * radius) claims.candidates.push_back(k);
        }
    }
}

// Adds the images of the walkers that perceive markers beyond the joint of a periodic world. Each marker is there once
// and sees a walker once, or its image, whichever is nearer.
std::span<const Vector2d> add_images(MarkerClaims& claims, std::span<const Vector2d> walkers, double radius,
                                     double period) {
    claims.with_images.assign(walkers.begin(), walkers.end());
    claims.image_of.resize(walkers.size());
    std::iota(claims.image_of.begin(), claims.image_of.end(), 0U);
    const auto add = [&](std::size_t k, double shift) {
        claims.with_images.emplace_back(walkers[k].x() + shift, walkers[k].y());
        claims.image_of.push_back(static_cast<std::uint32_t>(k));
    };
    for (std::size_t k = 0; k < walkers.size(); ++k) {
        if (walkers[k].x() < radius) add(k, period);
        if (walkers[k].x() > period - radius) add(k, -period);
    }
    return claims.with_images;
}

// Of two at one distance the one that comes first in the list without images; image_of is empty where there are none.
bool comes_first(const MarkerClaims& claims, std::uint32_t k, std::uint32_t other) {
    if (other == nobody || claims.image_of.empty()) return k < other;
    return claims.image_of[k] < claims.image_of[other];
}

std::uint32_t nearest(const MarkerClaims& claims, std::span<const Vector2d> walkers, double x, double z,
                      double radius) {
    std::uint32_t owner = nobody;
    double best = radius * radius;
    for (const std::uint32_t k : claims.candidates) {
        const double dx = x - walkers[k].x();
        const double dz = z - walkers[k].y();
        const double distance = dx * dx + dz * dz;
        if (distance < best || (distance == best && comes_first(claims, k, owner))) {
            owner = k;
            best = distance;
        }
    }
    return owner;
}

}  // namespace

void claim_markers(MarkerClaims& claims, const Markers& markers, std::span<const Vector2d> walkers_in_world,
                   double perception_radius, double period) {
    const GroundGrid& grid = markers.grid;
    claims.image_of.clear();
    const std::span<const Vector2d> walkers =
        period > 0 ? add_images(claims, walkers_in_world, perception_radius, period) : walkers_in_world;
    const auto whose = [&](std::uint32_t k) { return claims.image_of.empty() ? k : claims.image_of[k]; };
    sort_walkers_by_cell(claims, grid, walkers);
    claims.claimed_marker.clear();
    claims.claimed_by.clear();
    claims.start.assign(walkers_in_world.size() + 1, 0);
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            find_candidates(claims, grid, walkers, column, row, perception_radius);
            if (claims.candidates.empty()) continue;
            const std::size_t cell = grid.index(column, row);
            for (std::uint32_t m = markers.cell_start[cell]; m < markers.cell_start[cell + 1]; ++m) {
                const std::uint32_t owner = nearest(claims, walkers, markers.x[m], markers.z[m], perception_radius);
                if (owner == nobody) continue;
                claims.claimed_marker.push_back(m);
                claims.claimed_by.push_back(owner);
                ++claims.start[whose(owner) + std::size_t{1}];
            }
        }
    }

    // start[k + 1] is the next free place of walker k while the markers are dealt out, and its end when all are.
    std::uint32_t before = 0;
    for (std::size_t k = 0; k < walkers_in_world.size(); ++k) {
        const std::uint32_t count = claims.start[k + 1];
        claims.start[k + 1] = before;
        before += count;
    }
    claims.offsets.resize(before);
    for (std::size_t i = 0; i < claims.claimed_marker.size(); ++i) {
        const std::uint32_t m = claims.claimed_marker[i];
        const std::uint32_t owner = claims.claimed_by[i];
        claims.offsets[claims.start[whose(owner) + std::size_t{1}]++] =
            Vector2d(markers.x[m], markers.z[m]) - walkers[owner];
    }
}

Vector2d biocrowds_velocity(MarkerClaims& claims, std::size_t k, const Vector2d& goal_offset, double desired_speed,
                            SpeedRule rule, double dt) {
    const std::span<const Vector2d> own(claims.offsets.data() + claims.start[k], claims.start[k + 1] - claims.start[k]);
    std::vector<double>& w = claims.weights;
    w.resize(own.size());
    double preference_sum = 0;
    for (std::size_t i = 0; i < own.size(); ++i) {
        w[i] = marker_preference(goal_offset, own[i]);
        preference_sum += w[i];
    }
    for (double& weight : w) weight = marker_weight(weight, preference_sum);
    return walking_velocity(motion_vector(w, own), desired_speed, rule, dt);
}

}  // namespace wade::crowd
