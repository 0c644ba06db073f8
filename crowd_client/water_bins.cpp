#include "crowd_client/water_bins.hpp"

#include <algorithm>
#include <cmath>

namespace wade::crowd {
namespace {

void mark_cells_near(WaterBins& bins, std::span<const Vector2d> positions) {
    const GroundGrid& grid = bins.grid;
    bins.near_agent.assign(grid.cells(), 0);
    for (const Vector2d& p : positions) {
        const int column = GroundGrid::line_of(p.x());
        const int row = GroundGrid::line_of(p.y());
        for (int r = row - 1; r <= row + 1; ++r) {
            for (int c = column - 1; c <= column + 1; ++c) bins.near_agent[grid.index(c, r)] = 1;
        }
    }
}

void keep(WaterBins& bins, std::size_t particle, std::size_t cell) {
    if (bins.near_agent[cell] == 0) return;
    bins.kept_particle.push_back(static_cast<std::uint32_t>(particle));
    bins.kept_cell.push_back(static_cast<std::uint32_t>(cell));
    ++bins.cell_start[cell + 1];
}

// x brought into [0, period).
double in_period(double x, double period) {
    const double inside = x - period * std::floor(x / period);
    return inside < period ? inside : 0;
}

// In a periodic world the first and the last column of cells stand in the border, too, at the other end.
void keep_with_images(WaterBins& bins, std::size_t particle, double x, double z) {
    const GroundGrid& grid = bins.grid;
    const int last = grid.columns - 3;
    const int column = GroundGrid::line_of(in_period(x, bins.period));
    const int row = GroundGrid::line_of(z);
    keep(bins, particle, grid.index(column, row));
    if (column == 1) keep(bins, particle, grid.index(last + 1, row));
    if (column == last) keep(bins, particle, grid.index(0, row));
}

// x of a particle as it is seen in a cell of the periodic world's grid.
double x_seen_in(const WaterBins& bins, double x, std::size_t cell) {
    const double inside = in_period(x, bins.period);
    const int column = static_cast<int>(cell % static_cast<std::size_t>(bins.grid.columns));
    if (column == 0) return inside - bins.period;
    return column > bins.grid.columns - 3 ? inside + bins.period : inside;
}

// Fills kept_particle and kept_cell and counts the particles of cell c into cell_start[c + 1].
void keep_near(WaterBins& bins, const WaterView& water) {
    const GroundGrid& grid = bins.grid;
    const double x_lo = GroundGrid::line_start(0);
    const double x_hi = GroundGrid::line_start(grid.columns);
    const double z_lo = GroundGrid::line_start(0);
    const double z_hi = GroundGrid::line_start(grid.rows);
    bins.kept_particle.clear();
    bins.kept_cell.clear();
    bins.cell_start.assign(grid.cells() + 1, 0);
    for (std::size_t i = 0; i < water.size(); ++i) {
        const double x = water.origin_x + water.scale_x * static_cast<double>(water.px[i]);
        const double z = water.origin_z + water.scale_z * static_cast<double>(water.pz[i]);
        if (!(x >= x_lo && x < x_hi && z >= z_lo && z < z_hi)) continue;  // false for NaN, too
        if (bins.period > 0) {
            keep_with_images(bins, i, x, z);
        } else {
            keep(bins, i, grid.cell_of(x, z));
        }
    }
}

double gap_to_interval(double v, double lo, double hi) {
    return std::max({lo - v, v - hi, 0.0});
}

void sort_marked(WaterBins& bins, const WaterView& water) {
    keep_near(bins, water);

    // cell_start[c + 1] serves as the next free place of cell c while the particles are dealt out; once all are, it is
    // the end of cell c.
    const std::size_t cells = bins.grid.cells();
    std::uint32_t before = 0;
    for (std::size_t c = 0; c < cells; ++c) {
        const std::uint32_t count = bins.cell_start[c + 1];
        bins.cell_start[c + 1] = before;
        before += count;
    }
    const std::size_t kept = bins.kept_particle.size();
    for (std::vector<double>* v : {&bins.x, &bins.z, &bins.mass, &bins.vx, &bins.vz}) v->resize(kept);
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t i = bins.kept_particle[k];
        const std::size_t to = bins.cell_start[bins.kept_cell[k] + std::size_t{1}]++;
        const double x = water.origin_x + water.scale_x * static_cast<double>(water.px[i]);
        bins.x[to] = bins.period > 0 ? x_seen_in(bins, x, bins.kept_cell[k]) : x;
        bins.z[to] = water.origin_z + water.scale_z * static_cast<double>(water.pz[i]);
        bins.mass[to] = static_cast<double>(water.mass[i]);
        bins.vx[to] = water.scale_x * static_cast<double>(water.vx[i]);
        bins.vz[to] = water.scale_z * static_cast<double>(water.vz[i]);
    }
}

}  // namespace

WaterBins empty_bins(const Scene& scene) {
    WaterBins bins;
    bins.grid = GroundGrid::over(scene.world);
    bins.period = scene.world.period();
    return bins;
}

void bin_water(WaterBins& bins, const WaterView& water, std::span<const Vector2d> positions) {
    mark_cells_near(bins, positions);
    sort_marked(bins, water);
}

void bin_all_water(WaterBins& bins, const WaterView& water) {
    bins.near_agent.assign(bins.grid.cells(), 1);
    sort_marked(bins, water);
}

double contact_distance(const Coupling& coupling) {
    return coupling.contact_rule == ContactRule::sum ? coupling.agent_radius + coupling.particle_radius
                                                     : std::abs(coupling.agent_radius - coupling.particle_radius);
}

Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                     std::vector<WaterParticle>& touching) {
    touching.clear();
    const int column = GroundGrid::line_of(agent.x());
    const int row = GroundGrid::line_of(agent.y());
    const double limit = distance * distance;
    for (int r = row - 1; r <= row + 1; ++r) {
        const double gap_z = gap_to_interval(agent.y(), GroundGrid::line_start(r), GroundGrid::line_start(r + 1));
        for (int c = column - 1; c <= column + 1; ++c) {
            const double gap_x = gap_to_interval(agent.x(), GroundGrid::line_start(c), GroundGrid::line_start(c + 1));
            if (gap_x * gap_x + gap_z * gap_z >= limit) continue;  // no particle of this cell can be close enough
            const std::size_t cell = bins.grid.index(c, r);
            for (std::size_t k = bins.cell_start[cell]; k < bins.cell_start[cell + 1]; ++k) {
                const double dx = bins.x[k] - agent.x();
                const double dz = bins.z[k] - agent.y();
                if (dx * dx + dz * dz < limit) touching.push_back({bins.mass[k], {bins.vx[k], bins.vz[k]}});
            }
        }
    }
    return contact_momentum(touching);
}

CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density) {
    const std::size_t cell = bins.grid.cell_of(agent.x(), agent.y());
    Contact all;
    for (std::size_t k = bins.cell_start[cell]; k < bins.cell_start[cell + 1]; ++k) {
        all.mass += bins.mass[k];
        all.momentum += bins.mass[k] * Vector2d(bins.vx[k], bins.vz[k]);
    }
    if (!(all.mass > 0)) return {};
    constexpr double cell_area = GroundGrid::cell_size * GroundGrid::cell_size;
    return {all.mass / (rest_density * cell_area), std::sqrt(all.momentum.squaredNorm()) / all.mass};
}

}  // namespace wade::crowd
