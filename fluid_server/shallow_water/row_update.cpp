#include "fluid_server/shallow_water/row_update.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/shallow_water/row_update.cpp"
#include <hwy/foreach_target.h>

#include "configs/scene/channel.hpp"
#include "fluid_server/shallow_water/face_flux-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::shallow_water::HWY_NAMESPACE {

// h^(-4/3) in single precision, of a film that of 1 mm: Newton's method for h^(-1/3) from h^(-3/8); for h up to 1e4.
HWY_INLINE F friction_of_depth(F h) {
    const F x = hn::Max(h, all(1e-3F));
    const F root = hn::Sqrt(x), fourth = hn::Sqrt(root), eighth = hn::Sqrt(fourth);
    F y = all(1.0F) / (fourth * eighth);
    for (int k = 0; k < 5; ++k) y = y * (all(4.0F) - x * (y * y * y)) * all(1.0F / 3);
    const F y2 = y * y;
    return y2 * y2;
}

// 1 / (1 + dt k) of n cells.
void find_slowing(Cells cells, std::size_t n, double drag_factor, double* slowed) {
    const V one = all(1.0), drag = all(drag_factor);
    const auto put = [&](std::size_t i, V friction) {
        const V u = load(cells.normal + i), v = load(cells.along + i);
        store(one / (one + drag * hn::Sqrt(u * u + v * v) * friction), slowed + i);
    };
    for (std::size_t i = 0; i < n; i += float_lanes) {
        const F friction = friction_of_depth(narrow(load(cells.h + i), load(cells.h + i + lanes)));
        put(i, widen_lower(friction));
        put(i + lanes, widen_upper(friction));
    }
}

// Rows of a thread's own, carved from one buffer: rises and fluxes.
struct Workspace {
    CellRow rise_x{};                 // cells -1 to nx
    std::array<CellRow, 2> rise_z{};  // of the row at hand and of the one above
    FluxRow flux_x{};                 // faces 0 to nx
    std::array<FluxRow, 2> flux_z{};  // below and above the row at hand

    Workspace(RowMemory& buffer, std::size_t nx, bool level_bed) {
        const std::size_t length = line_values + whole_lines(nx + 2) + line_values;
        buffer.resize(24 * length);
        double* next = buffer.data() + line_values;
        const auto take = [&] { return std::exchange(next, next + length); };
        for (CellRow* row : {&rise_x, &rise_z[0], &rise_z[1]}) *row = {take(), take(), take(), take()};
        if (level_bed) {  // the surface rises as the depth does
            for (CellRow* row : {&rise_x, &rise_z[0], &rise_z[1]}) row->eta = row->h;
        }
        for (FluxRow* row : {&flux_x, &flux_z[0], &flux_z[1]}) *row = {take(), take(), take(), take()};
    }
};

struct RowOf {
    const double *h, *qx, *qz;
};
struct RowTo {
    double *h, *qx, *qz;          // h null: only the depth
    double *depth, *eta, *u, *v;  // eta null: on a level bed
};

// Returns the smallest depth. What is taken by value is the function's own, so that no store changes its pointers.
template <bool friction>
double mix_row(StageTerms terms, double dx, double dz, std::size_t n, const double* slowed, const double* rise_x,
               const double* rise_z, FluxRow x, FluxRow below, FluxRow above, RowOf from, RowOf base, const double* bed,
               RowTo to) {
    const V per_x = all(terms.dt / dx), per_z = all(terms.dt / dz), push = all(terms.dt * terms.acceleration);
    const V share = all(terms.share), kept = all(1 - terms.share), dry = all(terms.constants.dry);
    const V twice_g = all(2 * terms.constants.gravity);
    const V zero = all(0.0), one = all(1.0);
    V least = zero;
    for (std::size_t i = 0; i < n; i += lanes) {
        const V h = load(from.h + i), weight = twice_g * h;  // times a rise, which is half of the change over the cell
        V new_h = h - per_x * (load(x.mass + i + 1) - load(x.mass + i)) -
                  per_z * (load(above.mass + i) - load(below.mass + i));
        V qx = load(from.qx + i) -
               per_x * (load(x.into_lower + i + 1) - load(x.into_upper + i) + weight * load(rise_x + i)) -
               per_z * (load(above.along + i) - load(below.along + i)) + push * h;
        V qz = load(from.qz + i) - per_x * (load(x.along + i + 1) - load(x.along + i)) -
               per_z * (load(above.into_lower + i) - load(below.into_upper + i) + weight * load(rise_z + i));
        if constexpr (friction) {
            qx = qx * load(slowed + i);
            qz = qz * load(slowed + i);
        }
        new_h = kept * load(base.h + i) + share * new_h;
        qx = kept * load(base.qx + i) + share * qx;
        qz = kept * load(base.qz + i) + share * qz;
        // Rounding may leave a dry cell at -1e-20 m; a film has no velocity.
        const auto wet = new_h > dry;
        least = hn::Min(first(n - i, new_h, zero), least);
        new_h = hn::Max(new_h, zero);
        qx = hn::IfThenElseZero(wet, qx);
        qz = hn::IfThenElseZero(wet, qz);
        const V inverse = one / hn::IfThenElse(wet, new_h, one);
        if (to.h != nullptr) store(new_h, to.h + i);
        store(qx, to.qx + i);
        store(qz, to.qz + i);
        store(new_h, to.depth + i);
        if (to.eta != nullptr) store(new_h + load(bed + i), to.eta + i);
        store(qx * inverse, to.u + i);
        store(qz * inverse, to.v + i);
    }
    return hn::GetLane(hn::MinOfLanes(doubles, least));
}

// One Euler step of a band: row by row, with what was found for the row below kept for the next one.
struct BandUpdate {
    ShallowWater& world;
    const BandFrom& from;
    const StageTerms& terms;
    const BandTo& to;
    Workspace work;
    const Grid& grid = world.grid;
    const Primitive& p = from.primitive;

    [[nodiscard]] std::size_t place(std::ptrdiff_t k) const { return grid.row(k); }

    // Rises across of row k, needed by the faces on both sides of it.
    void rises_of_row(std::ptrdiff_t k, const CellRow& rise) const {
        const std::size_t c = place(k);
        find_rises(across(p, c - grid.stride), across(p, c), across(p, c + grid.stride), grid.nx, rise);
    }
    // Fluxes across from row k to the next one.
    void fluxes_above_row(std::ptrdiff_t k, const FluxRow& flux) const {
        const std::size_t c = place(k), up = c + grid.stride;
        find_fluxes(across(p, c), work.rise_z[0], across(p, up), work.rise_z[1], world.walls_z.from(up, grid), nullptr,
                    grid.nx, terms.constants, flux);
    }
    // Rises and fluxes along x of row k.
    void fluxes_along(std::ptrdiff_t k) const {
        const std::size_t c = place(k);
        const CellRow& rise = work.rise_x;
        find_rises(along_x(p, c - 1), along_x(p, c), along_x(p, c + 1), grid.nx, rise);
        find_rises(along_x(p, c - 2), along_x(p, c - 1), along_x(p, c), 1, rise.from(-1));
        const std::size_t end = c + grid.nx;
        find_rises(along_x(p, end - 1), along_x(p, end), along_x(p, end + 1), 1, rise.from(grid.nx));
        find_fluxes(along_x(p, c - 1), rise.from(-1), along_x(p, c), rise, world.walls_x.from(c, grid), nullptr,
                    grid.nx + 1, terms.constants, work.flux_x);
    }
    // The smallest depth of row k.
    double mix(std::ptrdiff_t k) const {
        const std::size_t c = place(k);
        const bool friction = terms.manning_n > 0;
        double* const slowed = work.rise_x.normal;  // which is no longer needed
        if (friction) {
            find_slowing(along_x(p, c), grid.nx, terms.dt * terms.constants.gravity * terms.manning_n * terms.manning_n,
                         slowed);
        }
        const RowOf from_row{p.h.data() + c, from.qx.data() + c, from.qz.data() + c};
        const RowOf base{world.primitive.h.data() + c, world.water.qx.data() + c, world.water.qz.data() + c};
        Primitive& q = to.primitive;
        const RowTo to_row{
            to.h == nullptr ? nullptr : to.h->data() + c, to.qx.data() + c, to.qz.data() + c, q.h.data() + c,
            q.eta.empty() ? nullptr : q.eta.data() + c,   q.u.data() + c,   q.v.data() + c};
        const auto mix = friction ? mix_row<true> : mix_row<false>;
        return mix(terms, grid.dx, grid.dz, grid.nx, slowed, work.rise_x.eta, work.rise_z[0].eta, work.flux_x,
                   work.flux_z[0], work.flux_z[1], from_row, base, world.bed.height.data() + c, to_row);
    }
    void note_flow(std::size_t k) {
        const std::size_t c = place(static_cast<std::ptrdiff_t>(k));
        world.row_inflow[k] = work.flux_x.mass[grid.nx];
        world.row_outflow[k] = work.flux_x.mass[0];
        for (WatchedFace& watched : world.watched) {
            const double mass = work.flux_x.mass[watched.face];
            watched.row_mass[k] = mass;
            watched.row_momentum[k] = mass * p.u[mass > 0 ? c + watched.face - 1 : c + watched.face];
        }
    }
};

void UpdateBand(ShallowWater& world, const BandFrom& from, const StageTerms& terms, std::size_t begin, std::size_t end,
                RowMemory& buffer, const BandTo& to) {
    if (begin == end) return;
    const Grid& grid = world.grid;
    BandUpdate band{world, from, terms, to, Workspace(buffer, grid.nx, world.bed.level)};
    Workspace& work = band.work;
    const auto first_row = static_cast<std::ptrdiff_t>(begin), end_row = static_cast<std::ptrdiff_t>(end);
    band.rises_of_row(first_row - 1, work.rise_z[0]);
    band.rises_of_row(first_row, work.rise_z[1]);
    band.fluxes_above_row(first_row - 1, work.flux_z[0]);
    for (std::ptrdiff_t row = first_row; row < end_row; ++row) {
        const auto k = static_cast<std::size_t>(row);
        std::swap(work.rise_z[0], work.rise_z[1]);
        band.rises_of_row(row + 1, work.rise_z[1]);
        band.fluxes_above_row(row, work.flux_z[1]);
        band.fluxes_along(row);
        if (world.scene.channel->flow == Flow::emitter) {
            const std::size_t last = grid.row(row) + grid.nx - 1;
            set_inflow(work.flux_x, grid.nx, terms.discharge, world.scene.channel->depth, from.primitive.h[last],
                       from.primitive.u[last], terms.constants.gravity);
        }
        world.row_least[k] = band.mix(row);
        band.note_flow(k);
        std::swap(work.flux_z[0], work.flux_z[1]);
    }
}

}  // namespace wade::fluid::shallow_water::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid::shallow_water {

HWY_EXPORT(UpdateBand);

void update_band(ShallowWater& world, const BandFrom& from, const StageTerms& terms, std::size_t begin, std::size_t end,
                 RowMemory& buffer, const BandTo& to) {
    HWY_DYNAMIC_DISPATCH(UpdateBand)(world, from, terms, begin, end, buffer, to);
}

}  // namespace wade::fluid::shallow_water
#endif
