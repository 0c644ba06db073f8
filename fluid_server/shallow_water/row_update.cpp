#include "fluid_server/shallow_water/row_update.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/shallow_water/row_update.cpp"
#include <hwy/foreach_target.h>

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

// The same on a place: k in single precision, with Newton's method from the exponent's third. n_squared: of each cell, or one
// of all cells.
template <bool by_cell>
void find_slowing_on_place(Cells cells, std::size_t n, double drag_factor, const double* n_squared, double* slowed) {
    const hn::RebindToSigned<Floats> whole;
    const V one = all(1.0);
    const F of_all = all(static_cast<float>(by_cell ? drag_factor : drag_factor * *n_squared));
    const F third = all(1.0F / 3), four = all(4.0F), film = all(1e-3F);
    for (std::size_t i = 0; i < n; i += float_lanes) {
        const F x = hn::Max(load_narrow(cells.h + i), film);
        F y = hn::BitCast(floats, hn::Set(whole, 0x54a2fa8c) -
                                      hn::ConvertTo(whole, hn::ConvertTo(floats, hn::BitCast(whole, x)) * third));
        for (int k = 0; k < 3; ++k) y = y * (four - x * (y * y * y)) * third;
        const F u = load_narrow(cells.normal + i), v = load_narrow(cells.along + i), y2 = y * y;
        F slowing = of_all * hn::Sqrt(u * u + v * v) * (y2 * y2);
        if constexpr (by_cell) slowing = slowing * load_narrow(n_squared + i);
        store(one / (one + widen_lower(slowing)), slowed + i);
        store(one / (one + widen_upper(slowing)), slowed + i + lanes);
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

// From place i of a row on.
inline CellRow part(const CellRow& row, std::ptrdiff_t i) {
    return {row.h + i, row.eta + i, row.normal + i, row.along + i};
}
inline CellRow part(const CellRow& row, std::size_t i) {
    return part(row, static_cast<std::ptrdiff_t>(i));
}
inline FluxRow part(const FluxRow& row, std::size_t i) {
    return {row.mass + i, row.along + i, row.into_lower + i, row.into_upper + i};
}

// Cells from place c on, with u or v as the velocity normal to the faces.
inline Cells along_x(const Primitive& p, std::size_t c) {
    return {p.h.data() + c, p.surface().data() + c, p.u.data() + c, p.v.data() + c};
}
inline Cells across(const Primitive& p, std::size_t c) {
    return {p.h.data() + c, p.surface().data() + c, p.v.data() + c, p.u.data() + c};
}

struct RowOf {
    const double *h, *qx, *qz;
};
struct RowTo {
    double *h, *qx, *qz;          // h null: only the depth
    double *depth, *eta, *u, *v;  // eta null: on a level bed
};

// Calls body(entry) for the entries of row k within [begin, end); they are in order.
template <typename Entry, typename Body>
void for_each_in(const EntriesByRow<Entry>& entries, std::size_t k, std::size_t begin, std::size_t end, Body&& body) {
    const Entry* entry = entries.entries.data() + entries.begin[k];
    const Entry* const last = entries.entries.data() + entries.begin[k + 1];
    while (entry < last && entry->column < begin) ++entry;
    for (; entry < last && entry->column < end; ++entry) body(*entry);
}

// Half of what a value rises over the two cells on the side away from a wall, by the smaller difference, if it goes on.
double rise_on_one_side(const double* values, std::ptrdiff_t step) {
    const double near = values[step] - values[0], far = values[2 * step] - values[step];
    const double up = std::max(0.0, std::min(near, far)), down = std::min(0.0, std::max(near, far));
    return 0.5 * (up + down);
}

// Rises of the cells with a wall on one side, of row k within [begin, end). cells: by column; step: to the next one along the
// rises' direction.
void mend_rises(const EntriesByRow<OneSided>& slopes, std::size_t k, std::size_t begin, std::size_t end,
                const Cells& cells, std::ptrdiff_t step, double dry, const CellRow& rise) {
    for_each_in(slopes, k, begin, end, [&](const OneSided& entry) {
        const std::size_t i = entry.column;
        const std::ptrdiff_t away = entry.away * step;
        const double* const h = cells.h + i;
        const bool wet = away != 0 && std::min({h[0], h[away], h[2 * away]}) > dry;
        const double side = wet ? entry.away : 0.0;
        rise.eta[i] = side * rise_on_one_side(cells.eta + i, away);
        if (rise.h != rise.eta) rise.h[i] = side * rise_on_one_side(h, away);
        rise.h[i] = std::clamp(rise.h[i], -h[0], h[0]);
        rise.normal[i] = side * rise_on_one_side(cells.normal + i, away);
        rise.along[i] = side * rise_on_one_side(cells.along + i, away);
    });
}

// Adds what the walls push to the momentum fluxes of their cells: see openings.hpp.
void push_of_walls(const EntriesByRow<WallCell>& walls, std::size_t k, std::size_t begin, std::size_t end,
                   const Cells& cells, double gravity, double* into_x, double* into_z) {
    for_each_in(walls, k, begin, end, [&](const WallCell& wall) {
        const std::size_t i = wall.column;
        const double h = cells.h[i], u = (cells.normal[i] * wall.x + cells.along[i] * wall.z) / wall.length;
        const double c = std::sqrt(gravity * h);
        const double push = std::max(h * u * (u + std::max(c + 0.5 * u, c - u)), -0.5 * gravity * h * h);
        into_x[i] += wall.x * push;
        into_z[i] += wall.z * push;
    });
}

// Returns the smallest depth; cells in groups may have any, before they get the mean of their group (step.cpp). What is
// taken by value is the function's own, so that no store changes its pointers.
template <bool friction, bool walls>
double mix_row(StageTerms terms, double dx, double dz, std::size_t n, const double* slowed, const double* per_share,
               const double* rise_x, const double* rise_z, FluxRow x, FluxRow below, FluxRow above, RowOf from,
               RowOf base, const double* bed, RowTo to) {
    const V per_x = all(terms.dt / dx), per_z = all(terms.dt / dz), push = all(terms.dt * terms.acceleration);
    const V share = all(terms.share), kept = all(1 - terms.share), dry = all(terms.constants.dry);
    const V twice_g = all(2 * terms.constants.gravity);
    const V zero = all(0.0), one = all(1.0);
    V least = zero;
    for (std::size_t i = 0; i < n; i += lanes) {
        const V h = load(from.h + i), weight = twice_g * h;  // times a rise, which is half of the change over the cell
        V new_h, qx, qz;
        auto grouped = zero < zero;
        if constexpr (walls) {
            grouped = load(per_share + i) < zero;
            const V open = hn::Abs(load(per_share + i)), of_x = open * per_x, of_z = open * per_z;
            new_h = h - of_x * (load(x.mass + i + 1) - load(x.mass + i)) -
                    of_z * (load(above.mass + i) - load(below.mass + i));
            qx = load(from.qx + i) - of_x * (load(x.into_lower + i + 1) - load(x.into_upper + i)) -
                 per_x * weight * load(rise_x + i) - of_z * (load(above.along + i) - load(below.along + i)) + push * h;
            qz = load(from.qz + i) - of_x * (load(x.along + i + 1) - load(x.along + i)) -
                 of_z * (load(above.into_lower + i) - load(below.into_upper + i)) - per_z * weight * load(rise_z + i);
        } else {
            new_h = h - per_x * (load(x.mass + i + 1) - load(x.mass + i)) -
                    per_z * (load(above.mass + i) - load(below.mass + i));
            qx = load(from.qx + i) -
                 per_x * (load(x.into_lower + i + 1) - load(x.into_upper + i) + weight * load(rise_x + i)) -
                 per_z * (load(above.along + i) - load(below.along + i)) + push * h;
            qz = load(from.qz + i) - per_x * (load(x.along + i + 1) - load(x.along + i)) -
                 per_z * (load(above.into_lower + i) - load(below.into_upper + i) + weight * load(rise_z + i));
        }
        if constexpr (friction) {
            qx = qx * load(slowed + i);
            qz = qz * load(slowed + i);
        }
        new_h = kept * load(base.h + i) + share * new_h;
        qx = kept * load(base.qx + i) + share * qx;
        qz = kept * load(base.qz + i) + share * qz;
        // Rounding may leave a dry cell at -1e-20 m; a film has no velocity.
        const auto wet = new_h > dry;
        if constexpr (walls) {
            least = hn::Min(first(n - i, hn::IfThenElse(grouped, zero, new_h), zero), least);
            new_h = hn::IfThenElse(grouped, new_h, hn::Max(new_h, zero));
            qx = hn::IfThenElseZero(hn::Or(grouped, wet), qx);
            qz = hn::IfThenElseZero(hn::Or(grouped, wet), qz);
        } else {
            least = hn::Min(first(n - i, new_h, zero), least);
            new_h = hn::Max(new_h, zero);
            qx = hn::IfThenElseZero(wet, qx);
            qz = hn::IfThenElseZero(wet, qz);
        }
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
    const Lines& active = world.lines.active;
    Openings& openings = world.openings;
    bool walls = openings.any();

    [[nodiscard]] std::size_t place(std::ptrdiff_t k) const { return grid.row(k); }

    // Rises across of row k, needed by the faces on both sides of it.
    void rises_of_row(std::ptrdiff_t k, const CellRow& rise) const {
        const std::size_t row = place(k);
        const bool ghosts = k < 0 || static_cast<std::size_t>(k) >= grid.nz;
        active.for_each_span_near(k, ghosts ? -1 : 0, ghosts ? 1 : 0, [&](std::size_t i, std::size_t n) {
            const std::size_t c = row + i;
            find_rises(across(p, c - grid.stride), across(p, c), across(p, c + grid.stride), n, part(rise, i));
            if (!walls || ghosts) return;
            mend_rises(openings.slopes_z, static_cast<std::size_t>(k), i, i + n, across(p, row),
                       static_cast<std::ptrdiff_t>(grid.stride), terms.constants.dry, rise);
        });
    }
    // Fluxes across from row k to the next one. Beside a line that is worked on, one that is not is dry, and so is it itself.
    void fluxes_above_row(std::ptrdiff_t k, const FluxRow& flux) const {
        const std::size_t row = place(k);
        const auto find = [&](std::size_t i, std::size_t n) {
            const std::size_t c = row + i, up = c + grid.stride;
            find_fluxes(across(p, c), Cells(work.rise_z[0]).from(i), across(p, up), Cells(work.rise_z[1]).from(i),
                        world.walls_z.from(up, grid), openings.narrowed_z.from(openings.face_z, up, grid), n,
                        terms.constants, part(flux, i));
        };
        if (k < 0 || static_cast<std::size_t>(k) + 1 == grid.nz) return active.for_each_span_near(k, 0, 1, find);
        active.for_each_span_in_both(k, find);
        active.for_each_span_in_one(k, [&](std::size_t i, std::size_t n) {
            for (double* const value : {flux.mass, flux.along, flux.into_lower, flux.into_upper})
                std::fill_n(value + i, n, 0);
        });
    }
    // Rises and fluxes along x of cells i to i + n of row k.
    void fluxes_along(std::size_t k, std::size_t i, std::size_t n) const {
        const std::size_t row = place(static_cast<std::ptrdiff_t>(k)), c = row + i;
        const auto first = static_cast<std::ptrdiff_t>(i), end = first + static_cast<std::ptrdiff_t>(n);
        const auto rises = [&](std::ptrdiff_t cell, std::size_t cells) {
            const std::size_t at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(row) + cell);
            find_rises(along_x(p, at - 1), along_x(p, at), along_x(p, at + 1), cells, part(work.rise_x, cell));
        };
        rises(first, n);
        // Nothing passes between dry cells, which those on both sides of a span's ends are (wet_lines.hpp).
        const bool whole = !terms.constants.films_rest, from_edge = whole || i == 0,
                   to_edge = whole || i + n == grid.nx;
        if (from_edge) rises(first - 1, 1);
        if (to_edge) rises(end, 1);
        if (walls) {
            mend_rises(openings.slopes_x, k, i > 0 ? i - 1 : 0, i + n + 1, along_x(p, row), 1, terms.constants.dry,
                       work.rise_x);
        }
        find_fluxes(along_x(p, c - 1), Cells(part(work.rise_x, first - 1)), along_x(p, c), Cells(part(work.rise_x, i)),
                    world.walls_x.from(c, grid), openings.narrowed_x.from(openings.face_x, c, grid),
                    to_edge ? n + 1 : n, terms.constants, part(work.flux_x, i));
        if (!to_edge) {
            for (double* const value :
                 {work.flux_x.mass, work.flux_x.along, work.flux_x.into_lower, work.flux_x.into_upper})
                value[i + n] = 0;
        }
    }
    // The smallest depth of cells i to i + n of row k.
    double mix(std::size_t k, std::size_t i, std::size_t n) {
        const std::size_t row = place(static_cast<std::ptrdiff_t>(k)), c = row + i;
        const bool by_cell = !world.bed.n_squared.empty(), friction = terms.manning_n > 0 || by_cell;
        double* const slowed = work.rise_x.normal + i;  // which is no longer needed
        if (friction) {
            const double drag = terms.dt * terms.constants.gravity, n_squared = terms.manning_n * terms.manning_n;
            if (by_cell) {
                find_slowing_on_place<true>(along_x(p, c), n, drag, world.bed.n_squared.data() + c, slowed);
            } else if (world.place) {
                find_slowing_on_place<false>(along_x(p, c), n, drag, &n_squared, slowed);
            } else {
                find_slowing(along_x(p, c), n, drag * n_squared, slowed);
            }
        }
        const RowOf from_row{p.h.data() + c, from.qx.data() + c, from.qz.data() + c};
        const RowOf base{world.primitive.h.data() + c, world.water.qx.data() + c, world.water.qz.data() + c};
        Primitive& q = to.primitive;
        const RowTo to_row{
            to.h == nullptr ? nullptr : to.h->data() + c, to.qx.data() + c, to.qz.data() + c, q.h.data() + c,
            q.eta.empty() ? nullptr : q.eta.data() + c,   q.u.data() + c,   q.v.data() + c};
        if (walls) {
            push_of_walls(openings.walls, k, i, i + n, along_x(p, row), terms.constants.gravity,
                          work.flux_x.into_lower + 1, work.flux_z[1].into_lower);
        }
        const auto mix = walls ? (friction ? mix_row<true, true> : mix_row<false, true>)
                               : (friction ? mix_row<true, false> : mix_row<false, false>);
        return mix(terms, grid.dx, grid.dz, n, slowed, walls ? openings.per_share.data() + c : nullptr,
                   work.rise_x.eta + i, work.rise_z[0].eta + i, part(work.flux_x, i), part(work.flux_z[0], i),
                   part(work.flux_z[1], i), from_row, base, world.bed.height.data() + c, to_row);
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
        double least = 0;
        world.lines.active.for_each_span(k, [&](std::size_t i, std::size_t n) {
            band.fluxes_along(k, i, n);
            if (world.scene.channel.flow == Flow::emitter) {
                const std::size_t last = grid.row(row) + grid.nx - 1;
                set_inflow(work.flux_x, grid.nx, terms.discharge, world.scene.channel.depth, from.primitive.h[last],
                           from.primitive.u[last], terms.constants.gravity);
            }
            least = std::min(least, band.mix(k, i, n));
        });
        world.row_least[k] = least;
        if (!world.place) band.note_flow(k);
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
