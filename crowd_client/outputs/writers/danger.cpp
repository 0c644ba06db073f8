#include "crowd_client/outputs/writers/danger.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/intervals.hpp"
#include "configs/scene/obstacle.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/water/footprint.hpp"

namespace wade::crowd {
namespace {

constexpr double wanted_cell = 2;   // m
constexpr double most_cells = 1e6;  // keeps memory and file in bounds for a channel of any size

// Returns the fraction of a cell that obstacles leave free.
double free_share(const GroundCells& grid, std::size_t cell, const std::vector<Obstacle>& obstacles) {
    const double x = grid.x0 + static_cast<double>(cell % grid.columns) * grid.step_x;
    const std::size_t row = cell / grid.columns;
    const double z = grid.z0 + static_cast<double>(row) * grid.step_z;
    const double all = grid.step_x * grid.step_z;
    double left = all;
    const Interval along{x, x + grid.step_x}, across{z, z + grid.step_z};
    for (const Obstacle& o : obstacles) left -= common_length(o.x, along) * common_length(o.z, across);
    return left / all;
}

}  // namespace

void close_block(Exposure& exposure, std::uint64_t block_steps) {
    if (exposure.open_steps == 0) return;
    if (exposure.open_steps >= block_steps || !exposure.has_block) {
        const double n = static_cast<double>(exposure.open_steps);
        const double depth = exposure.depth_sum / n;
        const double depth_speed = std::sqrt(exposure.discharge_sum.squaredNorm()) / n;
        exposure.last = danger_level(depth, depth_speed);
        exposure.has_block = true;
        exposure.largest = std::max(exposure.largest, exposure.last);
        exposure.max_depth = std::max(exposure.max_depth, depth);
        exposure.max_depth_speed = std::max(exposure.max_depth_speed, depth_speed);
        if (depth > 0) exposure.max_speed = std::max(exposure.max_speed, depth_speed / depth);
    }
    exposure.steps[static_cast<std::size_t>(exposure.last)] += exposure.open_steps;
    exposure.open_steps = 0;
    exposure.depth_sum = 0;
    exposure.discharge_sum.setZero();
}

std::string_view danger_name(DangerLevel level) {
    constexpr std::array<std::string_view, danger_levels> names{"none", "low", "moderate", "high", "very_high"};
    return names[static_cast<std::size_t>(level)];
}

void add_step(Exposure& exposure, double depth, const Vector2d& discharge, std::uint64_t block_steps) {
    exposure.depth_sum += depth;
    exposure.discharge_sum += discharge;
    ++exposure.open_steps;
    if (exposure.open_steps >= block_steps) close_block(exposure, block_steps);
}

GroundCells danger_grid(const Channel& channel) {
    const double cell = std::max(wanted_cell, std::sqrt(channel.x.length() * channel.z.length() / most_cells));
    const auto count = [&](double length) { return std::max(1.0, std::round(length / cell)); };
    const double columns = count(channel.x.length()), rows = count(channel.z.length());
    return {channel.x.lo,
            channel.z.lo,
            channel.x.length() / columns,
            channel.z.length() / rows,
            static_cast<std::size_t>(columns),
            static_cast<std::size_t>(rows)};
}

DangerRecord::DangerRecord(const Scene& scene, std::size_t agents, double window)
    : grid_(danger_grid(scene.channel)),
      rest_density_(scene.fluid->rest_density),
      dt_(1 / scene.crowd->step_rate),
      block_steps_(static_cast<std::uint64_t>(std::max(1LL, std::llround(window * scene.crowd->step_rate)))),
      cells_(grid_.cells()),
      agents_(agents),
      mass_(cells_.size()),
      momentum_(cells_.size()) {
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        const double free = free_share(grid_, c, scene.obstacles);
        // A cell that is less than a quarter free counts as a whole. Otherwise the little water in the rest, or over
        // the obstacles, would count too much.
        const double counted = free < 0.25 ? 1 : free;
        mass_of_depth_.push_back(rest_density_ * counted * grid_.step_x * grid_.step_z);
        filled_.push_back(free < 1e-9);
    }
}

void DangerRecord::sum_up(const WaterView& water) {
    std::fill(mass_.begin(), mass_.end(), 0.0);
    std::fill(momentum_.begin(), momentum_.end(), Vector2d::Zero());
    Footprints footprints(grid_, rest_density_, water.column);
    for (std::size_t i = 0; i < water.size(); ++i) {
        const double x = water.origin_x + water.scale_x * static_cast<double>(water.px[i]);
        const double z = water.origin_z + water.scale_z * static_cast<double>(water.pz[i]);
        const double mass = static_cast<double>(water.mass[i]);
        const Vector2d velocity(water.scale_x * static_cast<double>(water.vx[i]),
                                water.scale_z * static_cast<double>(water.vz[i]));
        footprints.deal(x, z, mass, [&](std::size_t met, double share, std::size_t own) {
            // Water beside an obstacle stays on its own side of the face.
            const std::size_t cell = filled_[met] ? own : met;
            mass_[cell] += share * mass;
            momentum_[cell] += share * mass * velocity;
        });
    }
}

void DangerRecord::add(const Agents& agents, std::span<const std::uint32_t> active, const WaterView& water) {
    sum_up(water);
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        add_step(cells_[c], mass_[c] / mass_of_depth_[c], momentum_[c] / mass_of_depth_[c], block_steps_);
    }
    for (const std::uint32_t id : active) {
        const std::size_t c = grid_.cell_of(agents.position[id].x(), agents.position[id].y());
        const bool in_channel = c != cells_.size();
        add_step(agents_[id], in_channel ? mass_[c] / mass_of_depth_[c] : 0.0,
                 in_channel ? Vector2d(momentum_[c] / mass_of_depth_[c]) : Vector2d::Zero(), block_steps_);
    }
}

void DangerRecord::close() {
    for (Exposure& e : cells_) close_block(e, block_steps_);
    for (Exposure& e : agents_) close_block(e, block_steps_);
}

std::string exposure_times(const Exposure& exposure, double dt) {
    std::string text;
    for (const std::uint64_t steps : exposure.steps) {
        if (!text.empty()) text += ',';
        text += csv_number(static_cast<double>(steps) * dt);
    }
    return text;
}

std::string danger_csv(const DangerRecord& record) {
    const GroundCells& grid = record.grid();
    std::string csv = "x_min_m,x_max_m,z_min_m,z_max_m,danger_level,max_depth_m,max_speed_m_s,max_dv_m2_s,";
    csv += exposure_columns;
    csv += '\n';
    for (std::size_t c = 0; c < record.cells().size(); ++c) {
        const Exposure& cell = record.cells()[c];
        const std::size_t row = c / grid.columns;
        const double i = static_cast<double>(c % grid.columns), k = static_cast<double>(row);
        csv += csv_number(grid.x0 + i * grid.step_x) + ',' + csv_number(grid.x0 + (i + 1) * grid.step_x);
        csv += ',' + csv_number(grid.z0 + k * grid.step_z) + ',' + csv_number(grid.z0 + (k + 1) * grid.step_z);
        csv += ',' + std::string(danger_name(cell.largest));
        for (const double v : {cell.max_depth, cell.max_speed, cell.max_depth_speed}) csv += ',' + csv_number(v);
        csv += ',' + exposure_times(cell, record.dt()) + '\n';
    }
    return csv;
}

}  // namespace wade::crowd
