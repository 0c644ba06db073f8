#include "fluid_server/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fluid_server/filling.hpp"

namespace wade::fluid {

namespace {

constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

// Cells above the water at rest, as a multiple of the depth: what is thrown higher counts to the topmost cell.
constexpr double headroom = 3;

template <typename T>
void gather(std::vector<T>& target, const std::vector<T>& values, const std::vector<std::uint32_t>& source,
            std::size_t n) {
    for_each_particle(n, [&](std::size_t i) { target[i] = values[source[i]]; });
}

}  // namespace

CellGrid::CellGrid(const Scene& scene, float support_radius)
    : start_(), cell_of_(static_cast<std::size_t>(scene.fluid.max_particles)),
      source_(static_cast<std::size_t>(scene.fluid.max_particles)),
      scratch_(static_cast<std::size_t>(scene.fluid.max_particles)) {
    const Channel& channel = scene.channel;
    periodic_ = {channel.flow == Flow::recirculating, false, channel.sides == Sides::periodic};
    // An emitter holds its next layers behind the upstream end.
    const double behind = channel.flow == Flow::emitter ? 3 * static_cast<double>(support_radius) : 0;
    const std::array<double, 3> lo{channel.x.lo, 0, channel.z.lo};
    const std::array<double, 3> hi{channel.x.hi + behind, headroom * deepest_water(scene), channel.z.hi};
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = hi[k] - lo[k];
        const int cells = std::max(1, static_cast<int>(length / static_cast<double>(support_radius)));
        origin_[k] = static_cast<float>(lo[k]);
        length_[k] = static_cast<float>(length);
        cells_[k] = cells;
        inverse_cell_[k] = static_cast<float>(cells / length);
    }
    start_.resize(cell_index(0, 0, cells_[2]) + 1);
}

int CellGrid::cell_along(std::size_t axis, float v) const {
    const float cell = (v - origin_[axis]) * inverse_cell_[axis];
    return static_cast<int>(std::clamp(cell, 0.0F, static_cast<float>(cells_[axis] - 1)));
}

std::size_t CellGrid::sort(Particles& p, float outflow_x) {
    const std::size_t n = p.count;
    for_each_particle(n, [&](std::size_t i) {
        cell_of_[i] = p.x[i] > outflow_x ? static_cast<std::uint32_t>(cell_index(
                                               cell_along(0, p.x[i]), cell_along(1, p.y[i]), cell_along(2, p.z[i])))
                                         : no_cell;
    });
    std::fill(start_.begin(), start_.end(), 0U);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (cell_of_[i] != no_cell) {
            ++start_[cell_of_[i]];
            ++kept;
        }
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start_) {
        sum += s;
        s = sum;  // the end of each cell; filling from the back turns it into the start
    }
    for (std::size_t i = n; i-- > 0;) {
        if (cell_of_[i] != no_cell) {
            source_[--start_[cell_of_[i]]] = static_cast<std::uint32_t>(i);
        }
    }
    for (auto array : {&Particles::x, &Particles::y, &Particles::z, &Particles::vx, &Particles::vy, &Particles::vz,
                       &Particles::density_pressure, &Particles::divergence_pressure}) {
        gather(scratch_.*array, p.*array, source_, kept);
        std::swap(scratch_.*array, p.*array);
    }
    gather(scratch_.kind, p.kind, source_, kept);
    std::swap(scratch_.kind, p.kind);
    p.count = kept;
    return n - kept;
}

template <typename Body>
void CellGrid::for_each_run(float px, float py, float pz, Body&& body) const {
    const int ci = cell_along(0, px);
    const int cj = cell_along(1, py);
    const int ck = cell_along(2, pz);
    const int last_x = cells_[0] - 1;
    for (int k = ck - 1; k <= ck + 1; ++k) {
        int kk = k;
        float shift_z = 0;
        if (k < 0 || k >= cells_[2]) {
            if (!periodic_[2]) {
                continue;
            }
            kk = k < 0 ? cells_[2] - 1 : 0;
            shift_z = k < 0 ? -length_[2] : length_[2];
        }
        for (int j = std::max(cj - 1, 0); j <= std::min(cj + 1, cells_[1] - 1); ++j) {
            const auto run = [&](int from, int to, float shift_x) {
                body(start_[cell_index(from, j, kk)], start_[cell_index(to, j, kk) + 1], shift_x, shift_z);
            };
            if (periodic_[0] && ci == 0) {
                run(last_x, last_x, -length_[0]);
            }
            run(std::max(ci - 1, 0), std::min(ci + 1, last_x), 0.0F);
            if (periodic_[0] && ci == last_x) {
                run(0, 0, length_[0]);
            }
        }
    }
}

void NeighbourBlock::resize(std::size_t pairs) {
    j.resize(pairs);
    gx.resize(pairs);
    gy.resize(pairs);
    gz.resize(pairs);
    gradient_factor.resize(pairs);
}

namespace {

constexpr std::size_t lanes = 64;  // candidates tested together

// Appends to the block all candidates near the point x; accept(j) may still refuse one.
template <typename Accept>
void append_near(const CellGrid& grid, const Particles& p, const Vec3& at, float h2, NeighbourBlock& block,
                 std::size_t& n, Accept&& accept) {
    std::array<float, lanes> r2{};
    grid.for_each_run(at[0], at[1], at[2], [&](std::size_t from, std::size_t to, float shift_x, float shift_z) {
        const float sx = at[0] - shift_x;
        const float sy = at[1];
        const float sz = at[2] - shift_z;
        for (std::size_t chunk = from; chunk < to; chunk += lanes) {
            const std::size_t size = std::min(lanes, to - chunk);
            if (block.j.size() < n + size) {
                block.resize(2 * (n + size));
            }
            const float* x = p.x.data() + chunk;
            const float* y = p.y.data() + chunk;
            const float* z = p.z.data() + chunk;
#pragma omp simd
            for (std::size_t c = 0; c < size; ++c) {
                const float dx = sx - x[c];
                const float dy = sy - y[c];
                const float dz = sz - z[c];
                r2[c] = dx * dx + dy * dy + dz * dz;
            }
            // Each candidate is written; only a neighbour moves the end of the list.
            for (std::size_t c = 0; c < size; ++c) {
                block.j[n] = static_cast<std::uint32_t>(chunk + c);
                block.gx[n] = sx - x[c];
                block.gy[n] = sy - y[c];
                block.gz[n] = sz - z[c];
                n += (r2[c] < h2 && accept(chunk + c)) ? 1U : 0U;
            }
        }
    });
}

}  // namespace

void find_neighbours(const CellGrid& grid, const Solids& solids, const Particles& p, const CubicSpline& kernel,
                     float support_radius, float volume, NeighbourLists& lists) {
    const float h2 = support_radius * support_radius;
    const float self = volume * kernel.value(0);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        NeighbourBlock& block = lists.blocks[b];
        std::vector<Mirror>& mirrors = block.mirrors;
        std::size_t n = 0;
        block.segments.clear();
        block.first_segment[0] = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 x{p.x[i], p.y[i], p.z[i]};
            const std::size_t first = n;
            const bool by_obstacle = solids.obstacle_near(x);
            const auto at = [&](std::size_t j) { return Vec3{p.x[j], p.y[j], p.z[j]}; };
            append_near(grid, p, x, h2, block, n,
                        [&](std::size_t j) { return j != i && (!by_obstacle || solids.visible(x, at(j))); });
            block.segments.push_back({static_cast<std::uint32_t>(n)});
            solids.mirrors_near(x, mirrors);
            for (const Mirror& mirror : mirrors) {
                append_near(grid, p, mirror.reflect(x), h2, block, n, [&](std::size_t j) {
                    return !by_obstacle || (mirror.obstacle < 0 ? solids.visible(x, mirror.reflect(at(j)))
                                                                : solids.sees_image(x, at(j), mirror));
                });
                const Vec3 sign = mirror.sign();
                block.segments.push_back({static_cast<std::uint32_t>(n), sign[0], sign[1], sign[2]});
            }
            block.first_segment[i - begin + 1] = static_cast<std::uint32_t>(block.segments.size());

            float* gx = block.gx.data();
            float* gy = block.gy.data();
            float* gz = block.gz.data();
            float* factor = block.gradient_factor.data();
            float sum = 0;
#pragma omp simd reduction(+ : sum)
            for (std::size_t k = first; k < n; ++k) {
                const float r = std::sqrt(gx[k] * gx[k] + gy[k] * gy[k] + gz[k] * gz[k]);
                const float g = volume * kernel.gradient_factor(r);
                sum += kernel.value(r);
                factor[k] = g;
                gx[k] *= g;
                gy[k] *= g;
                gz[k] *= g;
            }
            lists.density[i] = self + volume * sum;
        }
    });
}

}  // namespace wade::fluid
