#include "fluid_server/shallow_water/row_update.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace wade::fluid::shallow_water {

namespace {

constexpr double least_depth_of_friction = 1e-3;  // m

// h^(-4/3) to single precision: Newton's method for h^(-1/3) from h^(-3/8); for h from 1e-4 to 1e4.
inline double friction_of_depth(double h) {
    const auto x = static_cast<float>(h > least_depth_of_friction ? h : least_depth_of_friction);
    const float root = std::sqrt(x), fourth = std::sqrt(root), eighth = std::sqrt(fourth);
    float y = 1 / (fourth * eighth);
    for (int k = 0; k < 5; ++k) y = y * (4 - x * (y * y * y)) * (1.0F / 3);
    const float y2 = y * y;
    return static_cast<double>(y2 * y2);
}

// Rows of a thread's own, carved from one buffer: slopes and fluxes.
struct Workspace {
    SlopeRow slopes_x{};                 // cells -1 to nx, here from 0
    std::array<SlopeRow, 2> slopes_z{};  // of the row at hand and of the one above
    FluxRow flux_x{};                    // faces 0 to nx
    std::array<FluxRow, 2> flux_z{};     // below and above the row at hand

    Workspace(RowMemory& buffer, std::size_t nx) {
        const std::size_t length = whole_lines(nx + 2) + line_values;
        buffer.resize(24 * length);
        double* next = buffer.data();
        const auto take = [&] { return std::exchange(next, next + length); };
        for (SlopeRow* row : {&slopes_x, &slopes_z[0], &slopes_z[1]}) *row = {take(), take(), take(), take()};
        for (FluxRow* row : {&flux_x, &flux_z[0], &flux_z[1]}) *row = {take(), take(), take(), take()};
    }
};

// Cells from place c on, with u or v as the velocity normal to the faces.
Cells along_x(const Primitive& p, std::size_t c) {
    return {p.h.data() + c, p.eta.data() + c, p.u.data() + c, p.v.data() + c};
}
Cells across(const Primitive& p, std::size_t c) {
    return {p.h.data() + c, p.eta.data() + c, p.v.data() + c, p.u.data() + c};
}

Cells shifted(const SlopeRow& row, std::size_t by) {
    return {row.h + by, row.eta + by, row.normal + by, row.along + by};
}

struct RowOf {
    const double *h, *qx, *qz;
};
struct RowTo {
    double *h, *qx, *qz;
    double *depth, *eta, *u, *v;
};

// Returns the smallest depth.
template <bool friction>
double mix_row(const StageTerms& terms, const Grid& grid, std::size_t n, const Cells& cells, const double* slope_x,
               const double* slope_z, const FluxRow& x, const FluxRow& below, const FluxRow& above, const RowOf& from,
               const RowOf& base, const double* bed, const RowTo& to) {
    // Pointers of the loop's own, so that the compiler knows that no store changes them.
    const double *const u = cells.normal, *const v = cells.along;
    const double *const old_h = from.h, *const old_qx = from.qx, *const old_qz = from.qz;
    const double *const base_h = base.h, *const base_qx = base.qx, *const base_qz = base.qz;
    const double *const mass_x = x.mass, *const along_x = x.along;
    const double *const lower_x = x.into_lower, *const upper_x = x.into_upper;
    const double *const mass_above = above.mass, *const along_above = above.along;
    const double *const mass_below = below.mass, *const along_below = below.along;
    const double *const lower_above = above.into_lower, *const upper_below = below.into_upper;
    double *const to_h = to.h, *const to_qx = to.qx, *const to_qz = to.qz;
    double *const depth = to.depth, *const eta = to.eta, *const new_u = to.u, *const new_v = to.v;
    const double g = terms.constants.gravity, dry = terms.constants.dry, dt = terms.dt, share = terms.share;
    const double per_x = dt / grid.dx, per_z = dt / grid.dz, kept = 1 - share, push = dt * terms.acceleration;
    const double drag = dt * g * terms.manning_n * terms.manning_n;
    double least = 0;
#pragma omp simd reduction(min : least)
    for (std::size_t i = 0; i < n; ++i) {
        const double h = old_h[i], weight = g * h;
        double new_h = h - per_x * (mass_x[i + 1] - mass_x[i]) - per_z * (mass_above[i] - mass_below[i]);
        double qx = old_qx[i] - per_x * (lower_x[i + 1] - upper_x[i] + weight * slope_x[i]) -
                    per_z * (along_above[i] - along_below[i]) + push * h;
        double qz = old_qz[i] - per_x * (along_x[i + 1] - along_x[i]) -
                    per_z * (lower_above[i] - upper_below[i] + weight * slope_z[i]);
        if constexpr (friction) {
            const double speed = std::sqrt(u[i] * u[i] + v[i] * v[i]);
            const double slowed = 1 / (1 + drag * speed * friction_of_depth(h));
            qx *= slowed;
            qz *= slowed;
        }
        new_h = kept * base_h[i] + share * new_h;
        qx = kept * base_qx[i] + share * qx;
        qz = kept * base_qz[i] + share * qz;
        least = new_h < least ? new_h : least;
        // Rounding may leave a dry cell at -1e-20 m; a film has no velocity.
        new_h = new_h > 0 ? new_h : 0.0;
        const bool wet = new_h > dry;
        qx = wet ? qx : 0.0;
        qz = wet ? qz : 0.0;
        const double inverse = 1 / (wet ? new_h : 1.0);
        to_h[i] = new_h;
        to_qx[i] = qx;
        to_qz[i] = qz;
        depth[i] = new_h;
        eta[i] = new_h + bed[i];
        new_u[i] = qx * inverse;
        new_v[i] = qz * inverse;
    }
    return least;
}

double sum(const double* values, std::size_t n) {
    double total = 0;
#pragma omp simd reduction(+ : total)
    for (std::size_t i = 0; i < n; ++i) total += values[i];
    return total;
}

}  // namespace

void update_band(ShallowWater& world, const BandFrom& from, const StageTerms& terms, std::size_t begin, std::size_t end,
                 RowMemory& buffer, const BandTo& to) {
    const Grid& grid = world.grid;
    const Primitive& p = from.primitive;
    const auto row_from = [](const Water& water, std::size_t c) {
        return RowOf{water.h.data() + c, water.qx.data() + c, water.qz.data() + c};
    };
    const auto row_to = [&](std::size_t c) {
        Primitive& q = to.primitive;
        return RowTo{to.water.h.data() + c, to.water.qx.data() + c, to.water.qz.data() + c, q.h.data() + c,
                     q.eta.data() + c,      q.u.data() + c,         q.v.data() + c};
    };
    const std::size_t n = grid.nx;
    Workspace work(buffer, n);
    const auto row_of = [&](std::size_t k, std::ptrdiff_t offset) {
        return grid.row(static_cast<std::ptrdiff_t>(k) + offset);
    };
    const auto slopes_of_row = [&](std::size_t c, const SlopeRow& slopes) {
        limited_slopes(across(p, c - grid.stride), across(p, c), across(p, c + grid.stride), n, slopes);
    };
    const auto fluxes_above_row = [&](std::size_t c, const FluxRow& flux) {
        face_fluxes(across(p, c), work.slopes_z[0], across(p, c + grid.stride), work.slopes_z[1],
                    world.wall_z.empty() ? nullptr : world.wall_z.data() + c + grid.stride, n, terms.constants, flux);
    };
    if (begin == end) return;
    slopes_of_row(row_of(begin, -1), work.slopes_z[0]);
    slopes_of_row(row_of(begin, 0), work.slopes_z[1]);
    fluxes_above_row(row_of(begin, -1), work.flux_z[0]);
    for (std::size_t k = begin; k < end; ++k) {
        const std::size_t c = row_of(k, 0);
        std::swap(work.slopes_z[0], work.slopes_z[1]);
        slopes_of_row(c + grid.stride, work.slopes_z[1]);
        fluxes_above_row(c, work.flux_z[1]);

        limited_slopes(along_x(p, c - 2), along_x(p, c - 1), along_x(p, c), n + 2, work.slopes_x);
        face_fluxes(along_x(p, c - 1), work.slopes_x, along_x(p, c), shifted(work.slopes_x, 1),
                    world.wall_x.empty() ? nullptr : world.wall_x.data() + c, n + 1, terms.constants, work.flux_x);
        if (world.scene.channel.flow == Flow::emitter) {
            set_inflow(work.flux_x, n, terms.discharge, world.scene.channel.depth, p.h[c + n - 1], p.u[c + n - 1],
                       terms.constants.gravity);
        }
        const auto mix = terms.manning_n > 0 ? mix_row<true> : mix_row<false>;
        world.row_least[k] = mix(terms, grid, n, along_x(p, c), work.slopes_x.eta + 1, work.slopes_z[0].eta,
                                 work.flux_x, work.flux_z[0], work.flux_z[1], row_from(from.water, c),
                                 row_from(from.base, c), world.bed.height.data() + c, row_to(c));
        world.row_inflow[k] = work.flux_x.mass[n];
        world.row_outflow[k] = work.flux_x.mass[0];
        world.row_volume[k] = sum(to.water.h.data() + c, n);
        world.row_momentum[k] = sum(to.water.qx.data() + c, n);
        for (WatchedFace& watched : world.watched) {
            const double mass = work.flux_x.mass[watched.face];
            watched.row_mass[k] = mass;
            watched.row_momentum[k] = mass * p.u[mass > 0 ? c + watched.face - 1 : c + watched.face];
        }
        std::swap(work.flux_z[0], work.flux_z[1]);
    }
}

void find_primitive(const double* h, const double* qx, const double* qz, const double* bed, std::size_t n, double dry,
                    const SlopeRow& primitive) {
    double *const depth = primitive.h, *const eta = primitive.eta, *const u = primitive.normal,
                  *const v = primitive.along;
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) {
        const bool wet = h[i] > dry;
        const double inverse = 1 / (wet ? h[i] : 1.0);
        depth[i] = h[i];
        eta[i] = h[i] + bed[i];
        u[i] = wet ? qx[i] * inverse : 0.0;
        v[i] = wet ? qz[i] * inverse : 0.0;
    }
}

double fastest_of_row(const Cells& cells, std::size_t n, double gravity, double per_dx, double per_dz) {
    const double *const h = cells.h, *const u = cells.normal, *const v = cells.along;
    double fastest = 0, check = 0;
#pragma omp simd reduction(max : fastest) reduction(+ : check)
    for (std::size_t i = 0; i < n; ++i) {
        const double c = std::sqrt(gravity * h[i]);
        const double rate = (std::abs(u[i]) + c) * per_dx + (std::abs(v[i]) + c) * per_dz;
        fastest = rate > fastest ? rate : fastest;
        check += rate;  // a comparison would pass over NaN
    }
    return std::isfinite(check) ? fastest : check;
}

}  // namespace wade::fluid::shallow_water
