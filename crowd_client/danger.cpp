#include "crowd_client/danger.hpp"

#include <algorithm>
#include <cmath>

#include "crowd_client/csv_text.hpp"

namespace wade::crowd {
namespace {

constexpr double wanted_cell = 2;   // m
constexpr double most_cells = 1e6;  // keeps memory and file in bounds for a channel of any size

double overlap(const Interval& a, double lo, double hi) {
    return std::max(0.0, std::min(a.hi, hi) - std::max(a.lo, lo));
}

// Area of a cell that obstacles leave free; of one that they fill but for a quarter all of it, as the little water in
// what is left, or over the obstacles, would count too much.
double free_area(const DangerGrid& grid, std::size_t column, std::size_t row, const std::vector<Obstacle>& obstacles) {
    const double x = grid.x0 + static_cast<double>(column) * grid.step_x;
    const double z = grid.z0 + static_cast<double>(row) * grid.step_z;
    const double all = grid.step_x * grid.step_z;
    double left = all;
    for (const Obstacle& o : obstacles) left -= overlap(o.x, x, x + grid.step_x) * overlap(o.z, z, z + grid.step_z);
    return left < 0.25 * all ? all : left;
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

void add_step(Exposure& exposure, double depth, const Vector2d& discharge, std::uint64_t block_steps) {
    exposure.depth_sum += depth;
    exposure.discharge_sum += discharge;
    ++exposure.open_steps;
    if (exposure.open_steps >= block_steps) close_block(exposure, block_steps);
}

DangerGrid DangerGrid::over(const Channel& channel) {
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

std::size_t DangerGrid::cell_of(double x, double z) const {
    const double c = std::floor((x - x0) / step_x), r = std::floor((z - z0) / step_z);
    const bool inside = c >= 0 && c < static_cast<double>(columns) && r >= 0 && r < static_cast<double>(rows);
    return inside ? static_cast<std::size_t>(r) * columns + static_cast<std::size_t>(c) : columns * rows;
}

DangerRecord::DangerRecord(const Scene& scene, std::size_t agents, double window)
    : grid_(DangerGrid::over(scene.channel)),
      dt_(1 / scene.crowd.step_rate),
      block_steps_(static_cast<std::uint64_t>(std::max(1LL, std::llround(window * scene.crowd.step_rate)))),
      cells_(grid_.columns * grid_.rows),
      agents_(agents),
      mass_(cells_.size()),
      momentum_(cells_.size()) {
    for (std::size_t row = 0; row < grid_.rows; ++row) {
        for (std::size_t column = 0; column < grid_.columns; ++column) {
            mass_of_depth_.push_back(scene.fluid.rest_density * free_area(grid_, column, row, scene.obstacles));
        }
    }
}

void DangerRecord::sum_up(const WaterView& water) {
    std::fill(mass_.begin(), mass_.end(), 0.0);
    std::fill(momentum_.begin(), momentum_.end(), Vector2d::Zero());
    for (std::size_t i = 0; i < water.size(); ++i) {
        const std::size_t cell = grid_.cell_of(water.origin_x + water.scale_x * static_cast<double>(water.px[i]),
                                               water.origin_z + water.scale_z * static_cast<double>(water.pz[i]));
        if (cell == cells_.size()) continue;
        const double mass = static_cast<double>(water.mass[i]);
        mass_[cell] += mass;
        momentum_[cell] += mass * Vector2d(water.scale_x * static_cast<double>(water.vx[i]),
                                           water.scale_z * static_cast<double>(water.vz[i]));
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
    const DangerGrid& grid = record.grid();
    std::string csv = "x_min_m,x_max_m,z_min_m,z_max_m,danger_level,max_depth_m,max_speed_m_s,max_dv_m2_s,";
    csv += std::string(exposure_columns) + '\n';
    for (std::size_t c = 0; c < record.cells().size(); ++c) {
        const Exposure& cell = record.cells()[c];
        const double column = static_cast<double>(c % grid.columns), row = static_cast<double>(c / grid.columns);
        csv += csv_number(grid.x0 + column * grid.step_x) + ',' + csv_number(grid.x0 + (column + 1) * grid.step_x);
        csv += ',' + csv_number(grid.z0 + row * grid.step_z) + ',' + csv_number(grid.z0 + (row + 1) * grid.step_z);
        csv += ',' + std::string(danger_name(cell.largest));
        for (const double v : {cell.max_depth, cell.max_speed, cell.max_depth_speed}) csv += ',' + csv_number(v);
        csv += ',' + exposure_times(cell, record.dt()) + '\n';
    }
    return csv;
}

}  // namespace wade::crowd
