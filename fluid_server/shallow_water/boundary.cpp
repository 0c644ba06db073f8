#include "fluid_server/shallow_water/boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/numbers/portable.hpp"
#include "configs/scene/channel.hpp"

namespace wade::fluid::shallow_water {

namespace {

void copy_cell(Primitive& state, std::size_t to, std::size_t from) {
    for (RowMemory* field : {&state.h, &state.eta, &state.u, &state.v}) {
        if (!field->empty()) (*field)[to] = (*field)[from];
    }
}

void copy_cells(Primitive& state, std::size_t to, std::size_t from, std::size_t n) {
    for (RowMemory* field : {&state.h, &state.eta, &state.u, &state.v}) {
        if (!field->empty()) std::copy_n(field->data() + from, n, field->data() + to);
    }
}

// Calls copy(ghost, its original) for the ghosts of n cells, or rows.
template <typename Copy>
void wrap(std::size_t cells, Copy&& copy) {
    const auto n = static_cast<std::ptrdiff_t>(cells);
    for (std::ptrdiff_t g = 1; g <= 2; ++g) {
        copy(-g, ((-g) % n + n) % n);
        copy(n - 1 + g, (g - 1) % n);
    }
}

// The same, and mirror(ghost) where the ghost is the mirror image of the original. Of a single cell the image of the image
// is the cell itself.
template <typename Copy, typename Mirror>
void reflect(std::size_t cells, Copy&& copy, Mirror&& mirror) {
    const auto n = static_cast<std::ptrdiff_t>(cells);
    for (std::ptrdiff_t g = 1; g <= 2; ++g) {
        copy(-g, std::min(g, n) - 1);
        copy(n - 1 + g, n - std::min(g, n));
        if (g > n) continue;
        mirror(-g);
        mirror(n - 1 + g);
    }
}

// q^2 / h + g h^2 / 2: the momentum flux of the discharge q at the depth h.
double momentum_flux(double q, double h, double g) {
    return q * q / h + 0.5 * g * h * h;
}

// Solves q g / c^2 - 2 c = u - 2 sqrt(g h) for the depth c^2 / g, by Newton's method from below, where it converges.
double depth_on_wave(double q, double h, double u, double g) {
    const double invariant = u - 2 * std::sqrt(g * h);
    if (q <= 0) return std::pow(std::max(0.0, -0.5 * invariant), 2) / g;
    double c = std::min(cube_root(q * g), q * g > 0 && invariant < 0 ? std::sqrt(q * g / -invariant) : 1e300);
    for (int k = 0; k < 50; ++k) {
        const double step = (q * g / (c * c) - 2 * c - invariant) / (2 * q * g / (c * c * c) + 2);
        c += step;
        if (std::abs(step) <= 1e-14 * c) break;
    }
    return c * c / g;
}

}  // namespace

void fall(double& h, double& u, double gravity) {
    const double c = std::sqrt(gravity * h);
    if (-u >= c) return;
    const double critical = std::max(0.0, (2 * c - u) / 3);
    h = critical * critical / gravity;
    u = -critical;
}

void fill_ghosts(Primitive& state, const Grid& grid, const Channel& channel, double gravity, const Lines& active,
                 std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
        if (!active.at_ends(k)) continue;
        const std::size_t row = grid.row(static_cast<std::ptrdiff_t>(k)), last = row + grid.nx - 1;
        const auto copy = [&](std::ptrdiff_t to, std::ptrdiff_t from) {
            copy_cell(state, row + static_cast<std::size_t>(to), row + static_cast<std::size_t>(from));
        };
        const auto mirror = [&](std::ptrdiff_t i) {
            double& u = state.u[row + static_cast<std::size_t>(i)];
            u = -u;
        };
        if (channel.flow == Flow::emitter) {
            for (std::size_t g = 1; g <= 2; ++g) {
                const std::size_t below = row - g;
                copy_cell(state, below, row);
                fall(state.h[below], state.u[below], gravity);
                if (!state.eta.empty()) state.eta[below] = state.eta[row] - state.h[row] + state.h[below];
                copy_cell(state, last + g, last);  // its flux is given
            }
        } else if (channel.flow == Flow::closed) {
            reflect(grid.nx, copy, mirror);
        } else {
            wrap(grid.nx, copy);
        }
    }
    const auto copy = [&](std::ptrdiff_t to, std::ptrdiff_t from) {
        if (!active.any(static_cast<std::size_t>(from))) return;
        copy_cells(state, grid.row(to) - Grid::ghosts, grid.row(from) - Grid::ghosts, grid.nx + 2 * Grid::ghosts);
    };
    const auto mirror = [&](std::ptrdiff_t k) {
        const std::ptrdiff_t from = k < 0 ? -k - 1 : 2 * static_cast<std::ptrdiff_t>(grid.nz) - 1 - k;
        if (!active.any(static_cast<std::size_t>(from))) return;
        double* const v = state.v.data() + grid.row(k);
        for (std::size_t i = 0; i < grid.nx; ++i) v[i] = -v[i];
    };
    if (channel.sides == Sides::periodic) {
        wrap(grid.nz, copy);
    } else {
        reflect(grid.nz, copy, mirror);
    }
}

double inflow_depth(double discharge, double nozzle_depth, double h, double u, double gravity) {
    const double critical = cube_root(discharge * discharge / gravity);
    const double on_wave = std::max(critical, depth_on_wave(discharge, h, u, gravity));
    const double velocity = discharge / nozzle_depth;
    if (velocity * velocity < gravity * nozzle_depth) return on_wave;
    const bool drowned = momentum_flux(discharge, on_wave, gravity) > momentum_flux(discharge, nozzle_depth, gravity);
    return drowned ? on_wave : nozzle_depth;
}

void set_inflow(const FluxRow& flux, std::size_t face, double discharge, double nozzle_depth, double h, double u,
                double gravity) {
    const double depth = inflow_depth(discharge, nozzle_depth, h, -u, gravity);
    const double momentum = depth > 0 ? momentum_flux(discharge, depth, gravity) : 0;
    flux.mass[face] = -discharge;
    flux.along[face] = 0;
    flux.into_lower[face] = momentum - 0.5 * gravity * h * h;
}

}  // namespace wade::fluid::shallow_water
