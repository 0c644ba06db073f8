#include "fluid_server/dfsph/coarse_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "fluid_server/particles/parallel.hpp"

// W13 of docs/step_of_the_water.md.

namespace wade::fluid {

namespace {

// Spacings a cell is long. In trials 3 to 8 made no difference to a solve; the longer ones are for water that fills little of
// the box round it.
constexpr std::array<float, 2> cell_lengths{4, 8};

// A cell holds so many particles on average, or there is no grid: at 170 bytes a cell and its node these take at most 22 bytes a
// particle, beside 20 for where it lies.
constexpr std::size_t least_particles_a_cell = 8;

// A node with less than this share of the water of one that is all inside is left out. At the surface of water at rest a node
// has a half and more, or less than a half; with none left out one particle of a lattice let go flew 896 m.
constexpr float least_share = 0.5F;

// The conjugate gradients end once the residual has shrunk to this share, as the next iteration of the solve goes on from
// there; the limit is for a matrix that rounding has spoilt.
constexpr double enough = 0.3;
constexpr int most_iterations = 30;

// Of the diagonal of a line: added, and left at least, so that rounding makes none negative.
constexpr float ridge = 1e-4F, least_pivot = 1e-6F;

constexpr std::size_t cells_at_once = 1024;  // cells per batch; their matrix elements are stored until they are added

constexpr std::size_t self = 13;  // of the entries of a row; below it, above it: one less, one more

std::size_t bit(std::size_t corner, std::size_t axis) {
    return corner >> axis & 1;
}

// The factors of the hats along each axis.
using HatsAlong = std::array<CoarseGrid::Hats, 3>;
HatsAlong hats_along(const std::array<float, 3>& way) {
    HatsAlong hats;
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t q = 0; q < CoarseGrid::corners; ++q) hats[a][q] = bit(q, a) == 1 ? way[a] : 1 - way[a];
    }
    return hats;
}
CoarseGrid::Hats product(const CoarseGrid::Hats& u, const CoarseGrid::Hats& v) {
    CoarseGrid::Hats w;
    for (std::size_t q = 0; q < CoarseGrid::corners; ++q) w[q] = u[q] * v[q];
    return w;
}
CoarseGrid::Hats hats_at(const std::array<float, 3>& way) {
    const HatsAlong along = hats_along(way);
    return product(product(along[0], along[1]), along[2]);
}

// Calls body(cell) for each cell of [begin, end), in parallel where there are particles enough. A cell is worked by one
// thread and shares nothing.
template <typename Body>
void for_each_cell(std::size_t begin, std::size_t end, std::size_t particles, Body&& body) {
    const std::size_t shares = shares_of(particles), count = end - begin;
    for_each_share(shares, [&](std::size_t s) {
        for (std::size_t c = begin + s * count / shares; c < begin + (s + 1) * count / shares; ++c) body(c);
    });
}

double dot(const std::vector<float>& u, const std::vector<float>& v) {
    double sum = 0;
    for (std::size_t k = 0; k < u.size(); ++k) sum += static_cast<double>(u[k]) * static_cast<double>(v[k]);
    return sum;
}

}  // namespace

CoarseGrid::CoarseGrid(const Scene& scene) : spacing_(static_cast<float>(scene.fluid->particle_spacing)) {
    const Channel& c = scene.channel;
    periodic_ = {c.flow == Flow::recirculating || c.flow == Flow::periodic, c.top == Top::periodic,
                 c.sides == Sides::periodic};
    channel_.lo = {static_cast<float>(c.x.lo), 0, static_cast<float>(c.z.lo)};
    channel_.hi = {static_cast<float>(c.x.hi), std::numeric_limits<float>::max(), static_cast<float>(c.z.hi)};
}

bool CoarseGrid::place(const Particles& p) {
    const Box box = box_of(p);
    const bool placed = std::any_of(cell_lengths.begin(), cell_lengths.end(),
                                    [&](float spacings) { return cut(box, spacings * spacing_, p.count); });
    if (placed) sort(p);
    return placed;
}

CoarseGrid::Box CoarseGrid::box_of(const Particles& p) const {
    constexpr float far = std::numeric_limits<float>::max();
    BlockSums<Box> boxes;
    boxes.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        Box box{{far, far, far}, {-far, -far, -far}};
        for (std::size_t i = begin; i < end; ++i) {
            const std::array<float, 3> x{p.x[i], p.y[i], p.z[i]};
            for (std::size_t a = 0; a < 3; ++a) box.lo[a] = std::min(box.lo[a], x[a]);
            for (std::size_t a = 0; a < 3; ++a) box.hi[a] = std::max(box.hi[a], x[a]);
        }
        boxes[b] = box;
    });
    Box all{{far, far, far}, {-far, -far, -far}};
    for (std::size_t b = 0; b < block_count(p.count); ++b) {
        for (std::size_t a = 0; a < 3; ++a) all.lo[a] = std::min(all.lo[a], boxes[b].lo[a]);
        for (std::size_t a = 0; a < 3; ++a) all.hi[a] = std::max(all.hi[a], boxes[b].hi[a]);
    }
    for (std::size_t a = 0; a < 3; ++a) {  // up to the walls that the water touches
        if (periodic_[a] || std::abs(all.lo[a] - channel_.lo[a]) < spacing_) all.lo[a] = channel_.lo[a];
        if (periodic_[a] || std::abs(all.hi[a] - channel_.hi[a]) < spacing_) all.hi[a] = channel_.hi[a];
    }
    return all;
}

bool CoarseGrid::cut(const Box& box, float cell, std::size_t particles) {
    double all = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        const float length = std::max(box.hi[a] - box.lo[a], spacing_);
        const float count = std::max(1.0F, std::round(length / cell));
        all *= static_cast<double>(count);
        if (all * static_cast<double>(least_particles_a_cell) > static_cast<double>(particles)) return false;
        lo_[a] = box.lo[a];
        inverse_[a] = count / length;
        cells_[a] = static_cast<std::size_t>(count);
        nodes_[a] = cells_[a] + (periodic_[a] ? 0 : 1);
        walls_[a] = {box.lo[a] == channel_.lo[a], box.hi[a] == channel_.hi[a]};
    }
    return true;
}

void CoarseGrid::sort(const Particles& p) {
    cell_of_.resize(p.count);
    inside_.resize(p.count);
    const auto along = [&](std::size_t axis, float x) {  // in cells
        return std::clamp((x - lo_[axis]) * inverse_[axis], 0.0F, static_cast<float>(cells_[axis]));
    };
    const auto cell_along = [&](std::size_t axis, float at) {
        return std::min(static_cast<std::size_t>(at), cells_[axis] - 1);
    };
    for_each_particle(p.count, [&](std::size_t i) {
        const std::size_t at = cell_along(2, along(2, p.z[i])) * cells_[0] + cell_along(0, along(0, p.x[i]));
        cell_of_[i] = static_cast<std::uint32_t>(at * cells_[1] + cell_along(1, along(1, p.y[i])));
    });
    start_.assign(cells() + 2, 0);
    for (const std::uint32_t c : cell_of_) ++start_[c + std::size_t{2}];
    for (std::size_t c = 2; c < start_.size(); ++c) start_[c] += start_[c - 1];
    for (std::uint32_t i = 0; i < p.count; ++i) {
        const std::array<float, 3> x{p.x[i], p.y[i], p.z[i]};
        Inside& inside = inside_[start_[cell_of_[i] + std::size_t{1}]++];
        inside.i = i;
        for (std::size_t a = 0; a < 3; ++a) {
            const float at = along(a, x[a]);
            inside.way[a] = at - static_cast<float>(cell_along(a, at));
        }
    }
}

std::array<std::uint32_t, CoarseGrid::corners> CoarseGrid::nodes_of(std::size_t cell) const {
    const std::size_t j = cell % cells_[1], i = cell / cells_[1] % cells_[0], k = cell / cells_[1] / cells_[0];
    std::array<std::uint32_t, corners> numbers;
    for (std::size_t q = 0; q < corners; ++q) {
        const std::size_t at = node((i + bit(q, 0)) % nodes_[0], j + bit(q, 1), (k + bit(q, 2)) % nodes_[2]);
        numbers[q] = static_cast<std::uint32_t>(at);
    }
    return numbers;
}

float CoarseGrid::full_node(std::size_t i, std::size_t j, std::size_t k) const {
    const std::array<std::size_t, 3> at{i, j, k};
    float particles = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        const bool half = !periodic_[a] && ((at[a] == 0 && walls_[a][0]) || (at[a] + 1 == nodes_[a] && walls_[a][1]));
        particles /= inverse_[a] * spacing_ * (half ? 2 : 1);
    }
    return particles;
}

void CoarsePressure::build(const Particles& p, const std::vector<float>& mask, const ConstVectorArrays& open) {
    leave_out_thin_nodes(mask);
    rows_.assign(grid_.nodes(), {});
    elements_.resize(std::min(cells_at_once, grid_.cells()));
    for (std::size_t begin = 0; begin < grid_.cells(); begin += cells_at_once) {
        const std::size_t end = std::min(begin + cells_at_once, grid_.cells());
        for_each_cell(begin, end, p.count, [&](std::size_t c) { elements_[c - begin] = element_of(c, p, mask, open); });
        for (std::size_t c = begin; c < end; ++c) add(elements_[c - begin], c);
    }
    eliminate_lines();
}

void CoarsePressure::leave_out_thin_nodes(const std::vector<float>& mask) {
    restrict_to_nodes(mask, in_use_);
    for (std::size_t k = 0; k < grid_.nodes_along(2); ++k) {
        for (std::size_t i = 0; i < grid_.nodes_along(0); ++i) {
            for (std::size_t j = 0; j < grid_.nodes_along(1); ++j) {
                float& water = in_use_[grid_.node(i, j, k)];
                water = water >= least_share * grid_.full_node(i, j, k) ? 1 : 0;
            }
        }
    }
}

CoarsePressure::Element CoarsePressure::element_of(std::size_t cell, const Particles& p, const std::vector<float>& mask,
                                                   const ConstVectorArrays& open) const {
    Element element{};
    for (const auto& [i, way] : grid_.particles_in(cell)) {
        if (p.kind[i] == Kind::inflow) continue;
        const HatsAlong along = hats_along(way);
        const CoarseGrid::Hats hats = product(product(along[0], along[1]), along[2]);
        const std::array<float, 3> c{open.x[i], open.y[i], open.z[i]};
        std::array<CoarseGrid::Hats, 3> moved;  // -(G P_q)_i
        for (std::size_t a = 0; a < 3; ++a) {
            const float slope = mask[i] * grid_.cells_a_metre(a);
            const CoarseGrid::Hats across = product(along[(a + 1) % 3], along[(a + 2) % 3]);
            for (std::size_t q = 0; q < corners; ++q)
                moved[a][q] = hats[q] * c[a] + (bit(q, a) == 1 ? slope : -slope) * across[q];
        }
        for (std::size_t u = 0; u < corners; ++u) {
            for (std::size_t v = 0; v < corners; ++v) {
                element[corners * u + v] +=
                    moved[0][u] * moved[0][v] + moved[1][u] * moved[1][v] + moved[2][u] * moved[2][v];
            }
        }
    }
    return element;
}

void CoarsePressure::add(const Element& element, std::size_t cell) {
    const std::array<std::uint32_t, corners> nodes = grid_.nodes_of(cell);
    for (std::size_t u = 0; u < corners; ++u) {
        for (std::size_t v = 0; v < corners; ++v) {
            if (in_use_[nodes[u]] == 0 || in_use_[nodes[v]] == 0) continue;
            const std::size_t dx = bit(v, 0) + 1 - bit(u, 0), dy = bit(v, 1) + 1 - bit(u, 1);
            const std::size_t dz = bit(v, 2) + 1 - bit(u, 2);
            rows_[nodes[u]][9 * dz + 3 * dx + dy] += element[corners * u + v];
        }
    }
}

void CoarsePressure::restrict_to_nodes(const std::vector<float>& q, std::vector<float>& sums) {
    at_corners_.resize(grid_.cells());
    for_each_cell(0, grid_.cells(), grid_.particles(), [&](std::size_t c) {
        CoarseGrid::Hats sum{};
        for (const auto& [i, way] : grid_.particles_in(c)) {
            const CoarseGrid::Hats hats = hats_at(way);
            for (std::size_t u = 0; u < corners; ++u) sum[u] += q[i] * hats[u];
        }
        at_corners_[c] = sum;
    });
    sums.assign(grid_.nodes(), 0);
    for (std::size_t c = 0; c < grid_.cells(); ++c) {
        const std::array<std::uint32_t, corners> nodes = grid_.nodes_of(c);
        for (std::size_t u = 0; u < corners; ++u) sums[nodes[u]] += at_corners_[c][u];
    }
}

void CoarsePressure::interpolate_at_particles(const std::vector<float>& e, std::vector<float>& q) const {
    for_each_cell(0, grid_.cells(), grid_.particles(), [&](std::size_t c) {
        const std::array<std::uint32_t, corners> nodes = grid_.nodes_of(c);
        CoarseGrid::Hats of_nodes;
        for (std::size_t u = 0; u < corners; ++u) of_nodes[u] = e[nodes[u]];
        for (const auto& [i, way] : grid_.particles_in(c)) {
            const CoarseGrid::Hats hats = hats_at(way);
            float sum = 0;
            for (std::size_t u = 0; u < corners; ++u) sum += hats[u] * of_nodes[u];
            q[i] = sum;
        }
    });
}

// L D L^T of each line, from below: D_j = A_jj - A_j,j-1^2 / D_j-1.
void CoarsePressure::eliminate_lines() {
    line_inverse_.assign(grid_.nodes(), 0);
    for (std::size_t at = 0; at < grid_.nodes(); ++at) {
        const float diagonal = rows_[at][self], below = rows_[at][self - 1];
        float left = diagonal * (1 + ridge);
        if (at % grid_.nodes_along(1) > 0) left -= below * below * line_inverse_[at - 1];
        line_inverse_[at] = left > least_pivot * diagonal ? 1 / left : 0;
    }
}

void CoarsePressure::solve_lines(const std::vector<float>& r, std::vector<float>& z) const {
    const std::size_t high = grid_.nodes_along(1);
    for (std::size_t first = 0; first < grid_.nodes(); first += high) {
        for (std::size_t at = first; at < first + high; ++at) {
            z[at] = r[at] - (at > first ? rows_[at][self - 1] * line_inverse_[at - 1] * z[at - 1] : 0);
        }
        for (std::size_t at = first + high; at-- > first;) {
            z[at] = line_inverse_[at] * (z[at] - (at + 1 < first + high ? rows_[at][self + 1] * z[at + 1] : 0));
        }
    }
}

void CoarsePressure::multiply(const std::vector<float>& e, std::vector<float>& out) const {
    const std::size_t wide = grid_.nodes_along(0), high = grid_.nodes_along(1), deep = grid_.nodes_along(2);
    // The neighbour before, at or after i, or `count` if there is none.
    const auto beside = [](std::size_t i, std::size_t step, std::size_t count, bool wraps) {
        if (wraps) return (i + step + count - 1) % count;
        return i + step == 0 || i + step > count ? count : i + step - 1;
    };
    std::fill(out.begin(), out.end(), 0.0F);
    for (std::size_t k = 0; k < deep; ++k) {
        for (std::size_t i = 0; i < wide; ++i) {
            const std::size_t first = grid_.node(i, 0, k);
            for (std::size_t line = 0; line < 9; ++line) {
                const std::size_t ii = beside(i, line % 3, wide, grid_.wraps(0));
                const std::size_t kk = beside(k, line / 3, deep, grid_.wraps(2));
                if (ii == wide || kk == deep) continue;
                const std::size_t other = grid_.node(ii, 0, kk);
                for (std::size_t j = 0; j < high; ++j) {
                    const float* const row = rows_[first + j].data() + 3 * line;
                    float sum = row[1] * e[other + j];
                    if (j > 0) sum += row[0] * e[other + j - 1];
                    if (j + 1 < high) sum += row[2] * e[other + j + 1];
                    out[first + j] += sum;
                }
            }
        }
    }
}

double CoarsePressure::solve(std::vector<float>& residual) {
    restrict_to_nodes(residual, r_);
    double compression = 0;
    for (std::size_t k = 0; k < r_.size(); ++k) {
        r_[k] *= in_use_[k];
        compression += static_cast<double>(std::max(r_[k], 0.0F));
    }
    solve_by_conjugate_gradients();
    interpolate_at_particles(e_, residual);
    return compression;
}

// From e = 0 and r, preconditioned.
void CoarsePressure::solve_by_conjugate_gradients() {
    e_.assign(r_.size(), 0);
    z_.resize(r_.size());
    q_.resize(r_.size());
    solve_lines(r_, z_);
    d_ = z_;
    double rz = dot(r_, z_);
    const double small = enough * enough * rz;
    for (int iteration = 0; iteration < most_iterations && rz > small; ++iteration) {
        multiply(d_, q_);
        const double dq = dot(d_, q_);
        if (!(dq > 0)) break;
        const auto alpha = static_cast<float>(rz / dq);
        for (std::size_t k = 0; k < e_.size(); ++k) {
            e_[k] += alpha * d_[k];
            r_[k] -= alpha * q_[k];
        }
        solve_lines(r_, z_);
        const double next = dot(r_, z_);
        const auto beta = static_cast<float>(next / rz);
        rz = next;
        for (std::size_t k = 0; k < d_.size(); ++k) d_[k] = z_[k] + beta * d_[k];
    }
}

}  // namespace wade::fluid
