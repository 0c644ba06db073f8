#include "fluid_server/shallow_water/boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wade::fluid::shallow_water {

namespace {

void copy_cell(Primitive& state, std::size_t to, std::size_t from) {
    for (RowMemory* field : {&state.h, &state.eta, &state.u, &state.v}) (*field)[to] = (*field)[from];
}

void mirror_cell(Primitive& state, std::size_t to, std::size_t from, RowMemory& normal) {
    copy_cell(state, to, from);
    normal[to] = -normal[to];
}

// The water in the ghost cells below the fall, from the cell before it.
void fall(Primitive& state, std::size_t to, std::size_t from, double gravity) {
    copy_cell(state, to, from);
    const double c = std::sqrt(gravity * state.h[from]);
    if (-state.u[from] >= c) return;
    const double critical = std::max(0.0, (2 * c - state.u[from]) / 3);
    const double bed = state.eta[from] - state.h[from];
    state.h[to] = critical * critical / gravity;
    state.eta[to] = bed + state.h[to];
    state.u[to] = -critical;
}

// Places of a line of n cells, `step` apart, of which the first is at `first`: its ghosts and where they come from.
struct Line {
    std::size_t first, step, n;
    [[nodiscard]] std::size_t at(std::ptrdiff_t i) const {
        return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(first) + i * static_cast<std::ptrdiff_t>(step));
    }
};

void wrap_line(Primitive& state, const Line& line) {
    const auto n = static_cast<std::ptrdiff_t>(line.n);
    for (std::ptrdiff_t g = 1; g <= 2; ++g) {
        copy_cell(state, line.at(-g), line.at(((-g) % n + n) % n));
        copy_cell(state, line.at(n - 1 + g), line.at((g - 1) % n));
    }
}

// In a line of one cell the image of the image is the cell itself.
void mirror_line(Primitive& state, const Line& line, RowMemory& normal) {
    const auto n = static_cast<std::ptrdiff_t>(line.n);
    for (std::ptrdiff_t g = 1; g <= 2; ++g) {
        if (g <= n) {
            mirror_cell(state, line.at(-g), line.at(g - 1), normal);
            mirror_cell(state, line.at(n - 1 + g), line.at(n - g), normal);
        } else {
            copy_cell(state, line.at(-g), line.at(0));
            copy_cell(state, line.at(n - 1 + g), line.at(0));
        }
    }
}

void fall_and_inflow_line(Primitive& state, const Line& line, double gravity) {
    const auto n = static_cast<std::ptrdiff_t>(line.n);
    for (std::ptrdiff_t g = 1; g <= 2; ++g) {
        fall(state, line.at(-g), line.at(0), gravity);
        copy_cell(state, line.at(n - 1 + g), line.at(n - 1));  // its flux is given
    }
}

// q^2 / h + g h^2 / 2: the momentum flux of the discharge q at the depth h.
double momentum_flux(double q, double h, double g) {
    return q * q / h + 0.5 * g * h * h;
}

// The depth c^2 / g at which q g / c^2 - 2 c = u - 2 sqrt(g h), by Newton's method from below, where it converges.
double depth_on_wave(double q, double h, double u, double g) {
    const double invariant = u - 2 * std::sqrt(g * h);
    if (q <= 0) return std::pow(std::max(0.0, -0.5 * invariant), 2) / g;
    double c = std::min(std::cbrt(q * g), q * g > 0 && invariant < 0 ? std::sqrt(q * g / -invariant) : 1e300);
    for (int k = 0; k < 50; ++k) {
        const double step = (q * g / (c * c) - 2 * c - invariant) / (2 * q * g / (c * c * c) + 2);
        c += step;
        if (std::abs(step) <= 1e-14 * c) break;
    }
    return c * c / g;
}

}  // namespace

void fill_ghosts(Primitive& state, const Grid& grid, const Channel& channel, double gravity) {
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const Line row{grid.row(static_cast<std::ptrdiff_t>(k)), 1, grid.nx};
        if (channel.flow == Flow::emitter) {
            fall_and_inflow_line(state, row, gravity);
        } else if (channel.flow == Flow::closed) {
            mirror_line(state, row, state.u);
        } else {
            wrap_line(state, row);
        }
    }
    for (std::size_t i = 0; i < grid.nx; ++i) {
        const Line column{grid.row(0) + i, grid.stride, grid.nz};
        if (channel.sides == Sides::periodic) {
            wrap_line(state, column);
        } else {
            mirror_line(state, column, state.v);
        }
    }
}

double inflow_depth(double discharge, double nozzle_depth, double h, double u, double gravity) {
    const double critical = std::cbrt(discharge * discharge / gravity);
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
