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
#include "fluid_server/shallow_water/weir_flux.hpp"

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::shallow_water::HWY_NAMESPACE {

// Of n cells 1 / (1 + dt k) and 1 / (1 + dt k/2): k in single precision, of a film that of 1 mm, by Newton's method for
// h^(-1/3) from the exponent's third. n_squared: of each cell, or one of all cells.
template <bool by_cell>
void find_slowing(Cells cells, std::size_t n, double drag_factor, const double* n_squared, double* slowed,
                  double* half_slowed) {
    const hn::RebindToSigned<Floats> whole;
    const V one = all(1.0);
    const F of_all = all(static_cast<float>(by_cell ? drag_factor : drag_factor * *n_squared));
    const F third = all(1.0F / 3), four = all(4.0F), film = all(1e-3F), one_f = all(1.0F), half = all(0.5F);
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
        const F slowed_half = one_f / (one_f + half * slowing);
        store(widen_lower(slowed_half), half_slowed + i);
        store(widen_upper(slowed_half), half_slowed + i + lanes);
    }
}

// What is known of a row of cells before its water is new.
struct RowAhead {
    CellRow half{};              // h*, its surface, u*, v*
    CellRow rise_x{}, rise_z{};  // of cells -1 to nx; across with v as the velocity normal to the faces
    FluxRow flux_x{};            // faces 0 to nx
    double *slowed = nullptr, *half_slowed = nullptr;
};

// Rows of a thread's own, carved from one buffer.
struct Workspace {
    std::array<RowAhead, 2> rows;   // the row at hand and the one above
    std::array<FluxRow, 2> flux_z;  // below and above the row at hand

    Workspace(RowMemory& buffer, std::size_t nx, bool level_bed) {
        const std::size_t length = line_values + whole_lines(nx + 2) + line_values;
        buffer.resize(44 * length);
        double* next = buffer.data() + line_values;
        const auto take = [&] { return std::exchange(next, next + length); };
        for (RowAhead& row : rows) {
            for (CellRow* cells : {&row.half, &row.rise_x, &row.rise_z}) {
                *cells = {take(), take(), take(), take()};
                if (level_bed) cells->eta = cells->h;  // the surface is as high as the water is deep
            }
            row.flux_x = {take(), take(), take(), take()};
            row.slowed = take(), row.half_slowed = take();
        }
        for (FluxRow& flux : flux_z) flux = {take(), take(), take(), take()};
    }
};

// The same cells as those of a column.
inline CellRow across(const CellRow& row) {
    return {row.h, row.eta, row.along, row.normal};
}

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
        rise.h[i] = std::clamp(side * rise_on_one_side(h, away), -h[0], h[0]);
        rise.normal[i] = side * rise_on_one_side(cells.normal + i, away);
        rise.along[i] = side * rise_on_one_side(cells.along + i, away);
    });
}

// h*, its surface, u* and v* of n cells. Rises are half of the change over a cell. half_push: a dt/2.
template <bool friction, bool tilted>
void move_half_a_step(Cells cells, CellRow x, CellRow z, const double* half_slowed, std::size_t n, double per_x,
                      double per_z, double half_push, const FluxConstants& constants, CellRow half) {
    const V a = all(-per_x), b = all(-per_z), push = all(half_push);
    const V g = all(constants.gravity), dry = all(constants.dry);
    for (std::size_t i = 0; i < n; i += lanes) {
        const V h = load(cells.h + i), u = load(cells.normal + i), v = load(cells.along + i);
        const V h_x = load(x.h + i), h_z = load(z.h + i), u_x = load(x.normal + i), v_z = load(z.normal + i);
        const V room = h - hn::Max(hn::Abs(h_x), hn::Abs(h_z));
        const V more = a * (u * h_x + h * u_x) + b * (v * h_z + h * v_z);
        const auto wet = h > dry;
        const V change = hn::IfThenElseZero(wet, hn::Min(hn::Max(more, hn::Neg(room)), room));
        V u_half = u + (a * (u * u_x + g * load(x.eta + i)) + b * (v * load(z.along + i)));
        if constexpr (tilted) u_half = u_half + push;
        V v_half = v + (a * (u * load(x.along + i)) + b * (v * v_z + g * load(z.eta + i)));
        if constexpr (friction) {
            const V slowed = load(half_slowed + i);
            u_half = u_half * slowed, v_half = v_half * slowed;
        }
        store(h + change, half.h + i);
        store(load(cells.eta + i) + change, half.eta + i);
        store(hn::IfThenElseZero(wet, u_half), half.normal + i);
        store(hn::IfThenElseZero(wet, v_half), half.along + i);
    }
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

// Replaces the flux through the faces of flood walls of row k within (begin, end). lower, upper: cells below and above the faces,
// by column of the upper one.
void flow_over_walls(const EntriesByRow<WeirFace>& weirs, std::size_t k, std::size_t begin, std::size_t end,
                     const Cells& lower, const Cells& lower_rise, const Cells& upper, const Cells& upper_rise,
                     const FluxConstants& constants, double per_length, const FluxRow& flux) {
    for_each_in(weirs, k, begin, end, [&](const WeirFace& weir) {
        const std::size_t i = weir.column;
        const auto side = [i](const Cells& cells, const Cells& rise, double sign) {
            return WeirSide{cells.h[i] + sign * rise.h[i], cells.eta[i] + sign * rise.eta[i],
                            cells.normal[i] + sign * rise.normal[i], cells.along[i] + sign * rise.along[i]};
        };
        const WeirFlux over = weir_flux(side(lower, lower_rise, 1), side(upper, upper_rise, -1), weir.crest,
                                        weir.length, constants.gravity, constants.dry, per_length);
        flux.mass[i] = weir.open * over.mass, flux.along[i] = weir.open * over.along;
        flux.into_lower[i] = weir.open * over.into_lower, flux.into_upper[i] = weir.open * over.into_upper;
    });
}

struct OldRow {
    const double *h, *qx, *qz;
};
struct NewRow {
    double *h, *qx, *qz, *depth, *eta, *u, *v;  // eta: depth on a level bed
};

// Returns the smallest depth; cells in groups may have any, before they get the mean of their group (step.cpp). What is
// taken by value is the function's own, so that no store changes its pointers.
template <bool friction, bool walls, bool tilted>
double update_row(FluxConstants constants, double per_x_length, double per_z_length, double push_of_depth,
                  std::size_t n, const double* per_share, const double* slowed, const double* half_h,
                  const double* rise_x, const double* rise_z, FluxRow x, FluxRow below, FluxRow above, OldRow from,
                  const double* bed, NewRow to) {
    const V per_x = all(per_x_length), per_z = all(per_z_length), dry = all(constants.dry);
    const V push = all(push_of_depth), twice_g = all(2 * constants.gravity), zero = all(0.0), one = all(1.0);
    V least = zero;
    for (std::size_t i = 0; i < n; i += lanes) {
        const V depth = load(half_h + i), weight = twice_g * depth;  // times a rise: half of the change over the cell
        V of_x = per_x, of_z = per_z;
        auto grouped = zero < zero;
        if constexpr (walls) {
            const V open = load(per_share + i);
            grouped = open < zero;
            of_x = hn::Abs(open) * per_x, of_z = hn::Abs(open) * per_z;
        }
        V h = load(from.h + i) - of_x * (load(x.mass + i + 1) - load(x.mass + i)) -
              of_z * (load(above.mass + i) - load(below.mass + i));
        V qx = load(from.qx + i) - of_x * (load(x.into_lower + i + 1) - load(x.into_upper + i)) -
               per_x * weight * load(rise_x + i) - of_z * (load(above.along + i) - load(below.along + i));
        if constexpr (tilted) qx = qx + push * depth;
        V qz = load(from.qz + i) - of_x * (load(x.along + i + 1) - load(x.along + i)) -
               of_z * (load(above.into_lower + i) - load(below.into_upper + i)) - per_z * weight * load(rise_z + i);
        if constexpr (friction) {
            qx = qx * load(slowed + i);
            qz = qz * load(slowed + i);
        }
        // Rounding may leave a dry cell at -1e-20 m; a film has no velocity.
        const auto wet = h > dry;
        if constexpr (walls) {
            least = hn::Min(first(n - i, hn::IfThenElse(grouped, zero, h), zero), least);
            h = hn::IfThenElse(grouped, h, hn::Max(h, zero));
            qx = hn::IfThenElseZero(hn::Or(grouped, wet), qx);
            qz = hn::IfThenElseZero(hn::Or(grouped, wet), qz);
        } else {
            least = hn::Min(first(n - i, h, zero), least);
            h = hn::Max(h, zero);
            qx = hn::IfThenElseZero(wet, qx);
            qz = hn::IfThenElseZero(wet, qz);
        }
        const V inverse = one / hn::IfThenElse(wet, h, one);
        store(h, to.h + i);
        store(qx, to.qx + i);
        store(qz, to.qz + i);
        store(h, to.depth + i);
        store(h + load(bed + i), to.eta + i);
        store(qx * inverse, to.u + i);
        store(qz * inverse, to.v + i);
    }
    return hn::GetLane(hn::MinOfLanes(doubles, least));
}

// The rows of a band, one after the other, with what was found of the row above kept for the next one.
struct BandUpdate {
    ShallowWater& world;
    const double dt, discharge;
    Workspace work;
    const Grid& grid = world.grid;
    const Primitive& p = world.primitive;
    const Lines& active = world.lines.active;
    const Openings& openings = world.openings;
    const FluxConstants& constants = world.constants;
    const Flow flow = world.scene.channel->flow;
    const bool periodic_sides = world.scene.channel->sides == Sides::periodic;
    const bool walls = openings.any();
    const bool weirs_x = !openings.weirs_x.empty(), weirs_z = !openings.weirs_z.empty();
    const bool friction = world.manning_n > 0 || !world.bed.n_squared.empty();
    const bool tilted = world.acceleration != 0;
    const double per_x = dt / grid.dx, per_z = dt / grid.dz;

    BandUpdate(ShallowWater& of, double step, double inflow, RowMemory& buffer)
        : world(of), dt(step), discharge(inflow), work(buffer, of.grid.nx, of.bed.level) {}

    // The row of the grid that row k is, or is the image of.
    [[nodiscard]] std::size_t in_grid(std::ptrdiff_t k) const {
        const auto rows = static_cast<std::ptrdiff_t>(grid.nz);
        return static_cast<std::size_t>(k < 0 ? k + rows : k < rows ? k : k - rows);
    }
    void slow(std::size_t c, std::size_t i, std::size_t n, const RowAhead& row) const {
        const double drag = dt * constants.gravity, n_squared = world.manning_n * world.manning_n;
        if (world.bed.n_squared.empty()) {
            find_slowing<false>(along_x(p, c), n, drag, &n_squared, row.slowed + i, row.half_slowed + i);
        } else {
            find_slowing<true>(along_x(p, c), n, drag, world.bed.n_squared.data() + c, row.slowed + i,
                               row.half_slowed + i);
        }
    }
    // Half a step of row k, and what flows along it. Rows beyond periodic sides are images.
    void look_ahead(std::ptrdiff_t k, const RowAhead& row) const {
        const std::size_t start = grid.row(k), up = grid.stride, of = in_grid(k);
        active.for_each_span(of, [&](std::size_t i, std::size_t n) {
            const std::size_t c = start + i;
            const CellRow x = row.rise_x.from(i), z = row.rise_z.from(i), half = row.half.from(i);
            find_rises(along_x(p, c - 1), along_x(p, c), along_x(p, c + 1), n, x);
            find_rises(across(p, c - up), across(p, c), across(p, c + up), n, z);
            if (walls) {
                mend_rises(openings.slopes_x, of, i, i + n, along_x(p, start), 1, constants.dry, row.rise_x);
                mend_rises(openings.slopes_z, of, i, i + n, across(p, start), static_cast<std::ptrdiff_t>(up),
                           constants.dry, row.rise_z);
            }
            if (friction) slow(c, i, n, row);
            constexpr std::array moves{move_half_a_step<false, false>, move_half_a_step<true, false>,
                                       move_half_a_step<false, true>, move_half_a_step<true, true>};
            moves[(friction ? 1U : 0U) + (tilted ? 2U : 0U)](along_x(p, c), x, z, row.half_slowed + i, n, per_x, per_z,
                                                             0.5 * dt * world.acceleration, constants, half);
            flow_along(of, c, i, n, row);
        });
    }
    void flow_along(std::size_t of, std::size_t c, std::size_t i, std::size_t n, const RowAhead& row) const {
        const auto first = static_cast<std::ptrdiff_t>(i), last = first + static_cast<std::ptrdiff_t>(n) - 1;
        look_beyond(row, first, last);
        find_fluxes(row.half.from(first - 1), row.rise_x.from(first - 1), row.half.from(first), row.rise_x.from(first),
                    world.walls_x.from(c, grid), openings.narrowed_x.from(openings.face_x, c, grid), n + 1, constants,
                    row.flux_x.from(i));
        if (weirs_x)
            flow_over_walls(openings.weirs_x, of, i + 1, i + n, row.half.from(-1), row.rise_x.from(-1), row.half,
                            row.rise_x, constants, per_x, row.flux_x);
        if (flow == Flow::emitter) {
            set_inflow(row.flux_x, grid.nx, discharge, world.scene.channel->depth, row.half.h[last],
                       row.half.normal[last], constants.gravity);
        }
    }
    // The cells beyond both ends of a span. Those of a channel are whole rows; beyond those of a site lies a wall, or the water is
    // dry on both sides.
    void look_beyond(const RowAhead& row, std::ptrdiff_t first, std::ptrdiff_t last) const {
        if (flow == Flow::closed) {
            mirror(row.half, row.rise_x, first, row.half, row.rise_x, first - 1, 1);
            mirror(row.half, row.rise_x, last, row.half, row.rise_x, last + 1, 1);
            return;
        }
        const bool open = flow == Flow::emitter;
        const auto copy = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
            for (double* const value : {row.half.h, row.half.eta, row.half.normal, row.half.along})
                value[to] = value[from];
            for (double* const value : {row.rise_x.h, row.rise_x.eta, row.rise_x.normal, row.rise_x.along})
                value[to] = open ? 0 : value[from];
        };
        copy(open ? first : last, first - 1);
        copy(open ? last : first, last + 1);
        if (!open) return;
        double &h = row.half.h[first - 1], &eta = row.half.eta[first - 1];
        const double bed = eta - h;
        fall(h, row.half.normal[first - 1], constants.gravity);
        if (!world.bed.level) eta = bed + h;
    }
    // The images of n cells from place i on in a wall, from place `to` on. normal: to the wall.
    static void mirror(const CellRow& cells, const CellRow& rises, std::ptrdiff_t i, const CellRow& images,
                       const CellRow& image_rises, std::ptrdiff_t to, std::size_t n) {
        const auto copy = [&](const double* from, double* into, double sign) {
            for (std::size_t m = 0; m < n; ++m)
                into[to + static_cast<std::ptrdiff_t>(m)] = sign * from[i + static_cast<std::ptrdiff_t>(m)];
        };
        copy(cells.h, images.h, 1), copy(cells.eta, images.eta, 1);
        copy(cells.normal, images.normal, -1), copy(cells.along, images.along, 1);
        copy(rises.h, image_rises.h, -1), copy(rises.eta, image_rises.eta, -1);
        copy(rises.normal, image_rises.normal, 1), copy(rises.along, image_rises.along, -1);
    }
    // A row beyond a side, from the one before it, which is row k.
    void look_aside(std::ptrdiff_t beyond, std::size_t k, const RowAhead& row, const RowAhead& image) const {
        if (periodic_sides) return look_ahead(beyond, image);
        active.for_each_span(k, [&](std::size_t i, std::size_t n) {
            const auto at = static_cast<std::ptrdiff_t>(i);
            mirror(across(row.half), row.rise_z, at, across(image.half), image.rise_z, at, n);
        });
    }
    // Fluxes across from row k to the next one. Beside a line that is worked on, one that is not is dry, and so is it itself.
    void flow_above(std::ptrdiff_t k) const {
        const std::size_t up = grid.row(k + 1);
        const FluxRow& flux = work.flux_z[1];
        const auto find = [&](std::size_t i, std::size_t n) {
            const auto of = [&](const RowAhead& row) { return across(row.half).from(i); };
            find_fluxes(of(work.rows[0]), work.rows[0].rise_z.from(i), of(work.rows[1]), work.rows[1].rise_z.from(i),
                        world.walls_z.from(up + i, grid), openings.narrowed_z.from(openings.face_z, up + i, grid), n,
                        constants, flux.from(i));
            if (weirs_z)
                flow_over_walls(openings.weirs_z, in_grid(k + 1), i, i + n, across(work.rows[0].half),
                                work.rows[0].rise_z, across(work.rows[1].half), work.rows[1].rise_z, constants, per_z,
                                flux);
        };
        if (k < 0) return active.for_each_span(0, find);
        if (static_cast<std::size_t>(k) + 1 == grid.nz) return active.for_each_span(grid.nz - 1, find);
        active.for_each_span_in_both(k, find);
        active.for_each_span_in_one(k, [&](std::size_t i, std::size_t n) {
            for (double* const value : {flux.mass, flux.along, flux.into_lower, flux.into_upper})
                std::fill_n(value + i, n, 0);
        });
    }
    // Reads the discharge of the gauged cells of row k that lie within cells i to i + n.
    void read_gauges(std::size_t k, std::size_t i, std::size_t n) const {
        for (GaugedCell& cell : world.gauged) {
            if (cell.row != k || cell.column < i || cell.column >= i + n) continue;
            const std::size_t m = cell.column, c = grid.row(static_cast<std::ptrdiff_t>(k)) + m;
            const auto mean = [&](double lower, bool from_lower, double upper, bool from_upper) {
                const int open = int{from_lower} + int{from_upper};
                return open == 0 ? 0 : ((from_lower ? lower : 0) + (from_upper ? upper : 0)) / open;
            };
            const auto is_open = [&](const RowMemory& faces, std::size_t face) { return !walls || faces[face] > 0; };
            const RowAhead& row = work.rows[0];
            cell.qx = mean(row.flux_x.mass[m], m > 0 && is_open(openings.face_x, c), row.flux_x.mass[m + 1],
                           m + 1 < grid.nx && is_open(openings.face_x, c + 1));
            cell.qz = mean(work.flux_z[0].mass[m], k > 0 && is_open(openings.face_z, c), work.flux_z[1].mass[m],
                           k + 1 < grid.nz && is_open(openings.face_z, c + grid.stride));
        }
    }
    // The smallest depth of cells i to i + n of row k.
    double update(std::size_t k, std::size_t i, std::size_t n) const {
        const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)) + i;
        const RowAhead& row = work.rows[0];
        if (walls) {
            push_of_walls(openings.walls, k, i, i + n, row.half, constants.gravity, row.flux_x.into_lower + 1,
                          work.flux_z[1].into_lower);
        }
        Water& to = world.stage;
        Primitive& q = world.stage_primitive;
        constexpr std::array new_rows{update_row<false, false, false>, update_row<true, false, false>,
                                      update_row<false, true, false>,  update_row<true, true, false>,
                                      update_row<false, false, true>,  update_row<true, false, true>,
                                      update_row<false, true, true>,   update_row<true, true, true>};
        return new_rows[(friction ? 1U : 0U) + (walls ? 2U : 0U) + (tilted ? 4U : 0U)](
            constants, per_x, per_z, dt * world.acceleration, n, walls ? openings.per_share.data() + c : nullptr,
            row.slowed + i, row.half.h + i, row.rise_x.eta + i, row.rise_z.eta + i, row.flux_x.from(i),
            work.flux_z[0].from(i), work.flux_z[1].from(i),
            {world.water.h.data() + c, world.water.qx.data() + c, world.water.qz.data() + c},
            world.bed.height.data() + c,
            {to.h.data() + c, to.qx.data() + c, to.qz.data() + c, q.h.data() + c,
             (q.eta.empty() ? q.h : q.eta).data() + c, q.u.data() + c, q.v.data() + c});
    }
    // What flows through the ends and the watched faces of row k of a channel.
    void note_flow(std::size_t k) const {
        const RowAhead& row = work.rows[0];
        world.row_inflow[k] = row.flux_x.mass[grid.nx];
        world.row_outflow[k] = row.flux_x.mass[0];
        for (WatchedFace& watched : world.watched) {
            const double mass = row.flux_x.mass[watched.face];
            watched.row_mass[k] = mass;
            watched.row_momentum[k] = mass * row.half.normal[mass > 0 ? watched.face - 1 : watched.face];
        }
    }
};

void UpdateBand(ShallowWater& world, double dt, double discharge, std::size_t begin, std::size_t end,
                RowMemory& buffer) {
    if (begin == end) return;
    BandUpdate band(world, dt, discharge, buffer);
    auto& rows = band.work.rows;
    const auto first = static_cast<std::ptrdiff_t>(begin), last = static_cast<std::ptrdiff_t>(end) - 1;
    band.look_ahead(first, rows[1]);
    begin > 0 ? band.look_ahead(first - 1, rows[0]) : band.look_aside(-1, 0, rows[1], rows[0]);
    band.flow_above(first - 1);
    for (std::ptrdiff_t row = first; row <= last; ++row) {
        const auto k = static_cast<std::size_t>(row);
        std::swap(rows[0], rows[1]);
        std::swap(band.work.flux_z[0], band.work.flux_z[1]);
        k + 1 < world.grid.nz ? band.look_ahead(row + 1, rows[1]) : band.look_aside(row + 1, k, rows[0], rows[1]);
        band.flow_above(row);
        double least = 0;
        world.lines.active.for_each_span(k, [&](std::size_t i, std::size_t n) {
            if (!world.gauged.empty()) band.read_gauges(k, i, n);
            least = std::min(least, band.update(k, i, n));
        });
        world.row_least[k] = least;
        if (!world.site) band.note_flow(k);
    }
}

}  // namespace wade::fluid::shallow_water::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wade::fluid::shallow_water {

HWY_EXPORT(UpdateBand);

void update_band(ShallowWater& world, double dt, double discharge, std::size_t begin, std::size_t end,
                 RowMemory& buffer) {
    HWY_DYNAMIC_DISPATCH(UpdateBand)(world, dt, discharge, begin, end, buffer);
}

}  // namespace wade::fluid::shallow_water
#endif
