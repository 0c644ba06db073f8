#include "crowd_client/water/water_bins.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "configs/scene/world.hpp"

namespace wade::crowd {
namespace {

// The particles are located in blocks that stay in the nearest cache.
constexpr std::size_t block_size = 1024;

void mark_cells_near(WaterBins& bins, std::span<const Vector2d> positions) {
    const GroundGrid& grid = bins.grid;
    bins.use.assign(grid.cells() + 1, WaterBins::unused);
    for (const Vector2d& p : positions) {
        const int column = GroundGrid::line_of(p.x());
        const int row = GroundGrid::line_of(p.y());
        for (int r = row - 1; r <= row + 1; ++r) {
            for (int c = column - 1; c <= column + 1; ++c) {
                WaterBins::Use& use = bins.use[grid.index(c, r)];
                use = std::max(use, WaterBins::kept);
            }
        }
        bins.use[grid.cell_of(p.x(), p.y())] = WaterBins::summed;
    }
}

// Finds the cells of n particles from `begin` on; the number of cells for particles outside the grid and for NaN. Has
// no branch, so that the compiler turns it into vector code.
void locate(const GroundGrid& grid, const WaterView& water, std::size_t begin, std::size_t n, std::uint32_t* cells) {
    const float* const px = water.px.data() + begin;
    const float* const pz = water.pz.data() + begin;
    const double columns = grid.columns, rows = grid.rows, outside = columns * rows;
    const double origin_x = water.origin_x, scale_x = water.scale_x;
    const double origin_z = water.origin_z, scale_z = water.scale_z;
    for (std::size_t i = 0; i < n; ++i) {
        const double x = origin_x + scale_x * static_cast<double>(px[i]);
        const double z = origin_z + scale_z * static_cast<double>(pz[i]);
        const double column = std::floor(x / GroundGrid::cell_size) + 1;  // GroundGrid::line_of
        const double row = std::floor(z / GroundGrid::cell_size) + 1;
        const bool inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows);
        const double cell = inside ? row * columns + column : outside;
        cells[i] = static_cast<std::uint32_t>(static_cast<std::int32_t>(cell));
    }
}

// Fills kept_particle and kept_cell; returns their number.
std::size_t keep_near(WaterBins& bins, const WaterView& water) {
    const std::size_t particles = water.size();
    if (bins.kept_particle.size() < particles) {
        bins.kept_particle.resize(particles);
        bins.kept_cell.resize(particles);
    }
    std::array<std::uint32_t, block_size> cells;
    std::size_t kept = 0;
    for (std::size_t begin = 0; begin < particles; begin += block_size) {
        const std::size_t n = std::min(block_size, particles - begin);
        locate(bins.grid, water, begin, n, cells.data());
        // Each is written, and overwritten by the next one unless it is kept: no branch that is hard to predict.
        for (std::size_t i = 0; i < n; ++i) {
            bins.kept_particle[kept] = static_cast<std::uint32_t>(begin + i);
            bins.kept_cell[kept] = cells[i];
            kept += bins.use[cells[i]] == WaterBins::unused ? 0U : 1U;
        }
    }
    return kept;
}

void keep(WaterBins& bins, std::size_t particle, std::size_t cell) {
    if (bins.use[cell] == WaterBins::unused) return;
    bins.kept_particle.push_back(static_cast<std::uint32_t>(particle));
    bins.kept_cell.push_back(static_cast<std::uint32_t>(cell));
}

// x brought into [0, period).
double in_period(double x, double period) {
    const double inside = x - period * std::floor(x / period);
    return inside < period ? inside : 0;
}

// Keeps a particle. In a periodic world the first and the last column of cells appear in the border at the other end,
// too.
void keep_with_images(WaterBins& bins, std::size_t particle, double x, double z) {
    const GroundGrid& grid = bins.grid;
    const int last = grid.columns - 3;
    const int column = GroundGrid::line_of(in_period(x, bins.period));
    const int row = GroundGrid::line_of(z);
    keep(bins, particle, grid.index(column, row));
    if (column == 1) keep(bins, particle, grid.index(last + 1, row));
    if (column == last) keep(bins, particle, grid.index(0, row));
}

// Returns x of a particle, or of its image, in a cell of the periodic world's grid.
double x_seen_in(const WaterBins& bins, double x, std::size_t cell) {
    const double inside = in_period(x, bins.period);
    const int column = static_cast<int>(cell % static_cast<std::size_t>(bins.grid.columns));
    if (column == 0) return inside - bins.period;
    return column > bins.grid.columns - 3 ? inside + bins.period : inside;
}

// As keep_near, for a periodic world.
std::size_t keep_near_with_images(WaterBins& bins, const WaterView& water) {
    const double x_lo = GroundGrid::line_start(0), x_hi = GroundGrid::line_start(bins.grid.columns);
    const double z_lo = GroundGrid::line_start(0), z_hi = GroundGrid::line_start(bins.grid.rows);
    bins.kept_particle.clear();
    bins.kept_cell.clear();
    for (std::size_t i = 0; i < water.size(); ++i) {
        const double x = water.origin_x + water.scale_x * static_cast<double>(water.px[i]);
        const double z = water.origin_z + water.scale_z * static_cast<double>(water.pz[i]);
        // False for NaN, too.
        if (x >= x_lo && x < x_hi && z >= z_lo && z < z_hi) keep_with_images(bins, i, x, z);
    }
    return bins.kept_particle.size();
}

void sum_up_cells(WaterBins& bins) {
    bins.sums.resize(bins.grid.cells());
    for (std::size_t c = 0; c < bins.grid.cells(); ++c) {
        if (bins.use[c] == WaterBins::summed) bins.sums[c] = sum_of_cell(bins, c);
    }
}

// Counts the kept particles into cell_start and leaves there, for each cell c, the first index of cell c in
// cell_start[c + 1].
void count_by_cell(WaterBins& bins, std::size_t kept) {
    const std::size_t cells = bins.grid.cells();
    bins.cell_start.assign(cells + 1, 0);
    for (std::size_t k = 0; k < kept; ++k) ++bins.cell_start[bins.kept_cell[k] + std::size_t{1}];
    std::uint32_t before = 0;
    for (std::size_t c = 0; c < cells; ++c) {
        const std::uint32_t count = bins.cell_start[c + 1];
        bins.cell_start[c + 1] = before;
        before += count;
    }
}

// Deals out the numbers of the kept particles into `order`. cell_start[c + 1] serves as the next free index of cell c
// meanwhile; once all are dealt out, it is the end of cell c.
void deal_out(WaterBins& bins, std::size_t kept) {
    const std::uint32_t* const particle = bins.kept_particle.data();
    const std::uint32_t* const cell = bins.kept_cell.data();
    std::uint32_t* const next = bins.cell_start.data() + 1;
    std::uint32_t* const order = bins.order.data();
    for (std::size_t k = 0; k < kept; ++k) order[next[cell[k]]++] = particle[k];
}

// Copies the particles of the cells in their order, so that memory is written consecutively; x of each is x_of(x of the
// world, cell).
template <typename PlaceOf>
void fetch(WaterBins& bins, const WaterView& water, PlaceOf&& x_of) {
    const std::uint32_t* const order = bins.order.data();
    double *const x = bins.x.data(), *const z = bins.z.data();
    float *const mass = bins.mass.data(), *const vx = bins.vx.data(), *const vz = bins.vz.data();
    const WaterView from = water;  // a copy that nothing written here can change
    for (std::size_t c = 0; c < bins.grid.cells(); ++c) {
        for (std::size_t k = bins.cell_start[c]; k < bins.cell_start[c + 1]; ++k) {
            const std::size_t i = order[k];
            x[k] = x_of(from.origin_x + from.scale_x * static_cast<double>(from.px[i]), c);
            z[k] = from.origin_z + from.scale_z * static_cast<double>(from.pz[i]);
            mass[k] = from.mass[i];
            vx[k] = from.vx[i];
            vz[k] = from.vz[i];
            if (!bins.with_heights) continue;
            bins.y[k] = from.origin_y + from.scale_y * static_cast<double>(from.py[i]);
            bins.vy[k] = from.scale_y * static_cast<double>(from.vy[i]);
        }
    }
}

void sort_marked(WaterBins& bins, const WaterView& water) {
    const std::size_t kept = bins.period > 0 ? keep_near_with_images(bins, water) : keep_near(bins, water);
    count_by_cell(bins, kept);
    bins.scale_x = water.scale_x;
    bins.scale_z = water.scale_z;
    bins.column = water.column;
    for (std::vector<double>* v : {&bins.x, &bins.z}) v->resize(kept);
    for (std::vector<float>* v : {&bins.mass, &bins.vx, &bins.vz}) v->resize(kept);
    for (std::vector<double>* v : {&bins.y, &bins.vy}) v->resize(bins.with_heights ? kept : 0);
    bins.order.resize(kept);
    deal_out(bins, kept);
    if (bins.period > 0) {
        fetch(bins, water, [&](double x, std::size_t cell) { return x_seen_in(bins, x, cell); });
    } else {
        fetch(bins, water, [](double x, std::size_t) { return x; });
    }
    sum_up_cells(bins);
}

}  // namespace

Contact sum_of_cell(const WaterBins& bins, std::size_t cell) {
    Contact all;
    for (std::size_t k = bins.cell_start[cell]; k < bins.cell_start[cell + 1]; ++k) {
        const WaterParticle p = bins.particle(k);
        all.mass += p.mass;
        all.momentum += p.mass * p.velocity;
    }
    return all;
}

WaterBins empty_bins(const Scene& scene) {
    WaterBins bins;
    bins.grid = GroundGrid::over(scene.world);
    bins.period = scene.world->period();
    bins.with_heights = scene.crowd->ragdoll.condition != RagdollCondition::off;
    return bins;
}

void bin_water(WaterBins& bins, const WaterView& water, std::span<const Vector2d> positions) {
    if (water.size() > 0)
        mark_cells_near(bins, positions);
    else
        bins.use.assign(bins.grid.cells() + 1, WaterBins::unused);  // nothing to keep, so no marks are needed
    sort_marked(bins, water);
}

void bin_all_water(WaterBins& bins, const WaterView& water) {
    bins.use.assign(bins.grid.cells(), WaterBins::kept);
    bins.use.push_back(WaterBins::unused);
    sort_marked(bins, water);
}

}  // namespace wade::crowd
