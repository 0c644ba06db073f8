#include "fluid_server/shallow_water/site/site_water.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/numbers/portable.hpp"
#include "fluid_server/shallow_water/site/map_cover.hpp"

namespace wade::fluid::shallow_water {

namespace {

constexpr double metres_per_second = 1 / 3.6e6;  // of rain, a mm/h

struct Area {
    std::vector<std::size_t> cells;  // k * nx + i
    std::vector<double> share;       // of each cell
};

Area area_of(const Grid& grid, const MapPolygon& polygon, const MapLine& line) {
    Area area;
    if (polygon.rings.empty()) {
        area.cells = cells_on(grid, line);
        area.share.assign(area.cells.size(), 1);
        return area;
    }
    const std::vector<double> covered = cover_of_cells(grid, {&polygon});
    for (std::size_t n = 0; n < covered.size(); ++n) {
        if (covered[n] <= 0) continue;
        area.cells.push_back(n);
        area.share.push_back(covered[n]);
    }
    return area;
}

std::size_t memory_place(const Grid& grid, std::size_t number) {
    return grid.row(static_cast<std::ptrdiff_t>(number / grid.nx)) + number % grid.nx;
}

// `taken`: cells of outlets, by place in the grid's memory.
SiteSource make_source(const Source& source, const Grid& grid, const Openings& openings,
                       const std::vector<bool>& taken) {
    SiteSource result{source.discharge, {}};
    const Area area = area_of(grid, source.polygon, source.line);
    double open = 0;
    for (std::size_t n = 0; n < area.cells.size(); ++n) {
        const std::size_t c = memory_place(grid, area.cells[n]);
        if (openings.share_of(c) <= 0 || taken[c]) continue;
        open += area.share[n] * openings.share_of(c) * grid.cell_area();
        result.cells.push_back({c, area.share[n]});
    }
    if (result.cells.empty()) {
        throw ConfigurationError(source.label +
                                 ": the source lies on no open ground: it is inside houses, beyond the "
                                 "ground, in an outlet or too small for a cell. Remedy: move it.");
    }
    for (SourceCell& cell : result.cells) cell.per_volume /= open;
    return result;
}

// Returns the cells of an outlet, in ascending order, and marks them in `taken`; cells of outlets before it stay theirs.
std::vector<std::size_t> cells_of_outlet(const Outlet& outlet, const Grid& grid, const Openings& openings,
                                         std::vector<bool>& taken) {
    const Area area = area_of(grid, outlet.polygon, outlet.line);
    std::vector<std::size_t> cells;
    for (std::size_t n = 0; n < area.cells.size(); ++n) {
        const std::size_t c = memory_place(grid, area.cells[n]);
        if (openings.share_of(c) > 0 && area.share[n] >= 0.5) cells.push_back(c);
    }
    std::sort(cells.begin(), cells.end());
    for (const Group& group : openings.groups) {  // one state: all of them or none
        const auto first = openings.members_of_groups.begin() + static_cast<std::ptrdiff_t>(group.first);
        const auto last = openings.members_of_groups.begin() + static_cast<std::ptrdiff_t>(group.last);
        if (std::any_of(first, last,
                        [&](std::size_t c) { return std::binary_search(cells.begin(), cells.end(), c); })) {
            cells.insert(cells.end(), first, last);
            std::sort(cells.begin(), cells.end());
        }
    }
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    std::erase_if(cells, [&](std::size_t c) { return taken[c]; });
    if (cells.empty()) {
        throw ConfigurationError(outlet.label +
                                 ": the outlet lies on no open ground: it is inside houses, beyond the "
                                 "ground, in another outlet or too small for a cell. Remedy: move it.");
    }
    for (const std::size_t c : cells) taken[c] = true;
    return cells;
}

SiteOutlet make_outlet(const Outlet& outlet, const std::vector<std::size_t>& cells, const Grid& grid,
                       const Openings& openings, const std::vector<bool>& taken) {
    SiteOutlet result{outlet.kind, outlet.stage, {}, {}, {}};
    for (const std::size_t c : cells) {
        OutletCell cell;
        cell.cell = c;
        const std::size_t i = c % grid.stride - line_values, k = c / grid.stride - Grid::ghosts;
        const auto look = [&](bool exists, std::size_t other, std::size_t face, bool along_x, double sign) {
            if (!exists || taken[other]) return;
            if (openings.any() && (along_x ? openings.face_x : openings.face_z)[face] <= 0) return;
            cell.inside[cell.count++] = other;
            (along_x ? cell.normal_x : cell.normal_z) += sign;
        };
        look(i > 0, c - 1, c, true, -1);
        look(i + 1 < grid.nx, c + 1, c + 1, true, 1);
        look(k > 0, c - grid.stride, c, false, -1);
        look(k + 1 < grid.nz, c + grid.stride, c + grid.stride, false, 1);
        const double length = length_of(cell.normal_x, cell.normal_z);
        if (length > 0) cell.normal_x /= length, cell.normal_z /= length;
        const bool same_line = !result.lines.empty() && result.lines.back().row == k &&
                               result.lines.back().column / line_values == i / line_values;
        if (!same_line) result.lines.push_back({k, i, result.cells.size(), result.cells.size()});
        result.cells.push_back(cell);
        ++result.lines.back().end;
    }
    return result;
}

struct State {
    double h = 0, qx = 0, qz = 0;
};

// Flow at the boundary: depth, m, and velocity along the normal into the site, m/s.
struct BoundaryFlow {
    double h = 0, u = 0;
};

// Returns the speed at which the level outside moves in, relative to the water inside, m/s: that of a bore, from the
// momentum balance, if the level outside is higher, else the celerity inside. inside, outside: celerities sqrt(g h) and
// sqrt(g d).
double fastest_inwards(double inside, double outside) {
    if (!(outside > inside)) return inside;
    return outside * std::sqrt((outside * outside + inside * inside) / 2) / inside;
}

// Returns the flow at a `stage`. d: depth of the water outside over the bed, m, > 0. leaving: the invariant u - 2 c inside, m/s.
BoundaryFlow flow_at_stage(double gravity, double d, double leaving) {
    const double head = gravity * d, at_rest = std::sqrt(head);
    if (leaving + 2 * at_rest <= 0) return {d, leaving + 2 * at_rest};
    const double root = 3 * head - 0.5 * leaving * leaving;
    const double subcritical = root > 0 ? (std::sqrt(root) - leaving) / 3 : 0;
    const double c = std::max(subcritical, std::sqrt(2 * head / 3));
    return {c * c / gravity, std::clamp(leaving + 2 * c, 0.0, c)};
}

// Returns the flow at a `wave`. wave, rest: celerities under the incoming wave and at rest, m/s. leaving: as at a stage.
BoundaryFlow flow_at_wave(double gravity, double wave, double rest, double leaving) {
    const double velocity = std::min(2 * (wave - rest), wave);            // at most critical
    const double entering = std::max(velocity + 2 * wave, -leaving / 3);  // at most critical outflow
    const double inner = std::min(leaving, -entering / 3);                // at most critical inflow
    const double c = std::max(0.0, 0.25 * (entering - inner));
    return {c * c / gravity, 0.5 * (entering + inner)};
}

// Returns depth and discharge in the cell of an outlet. level: of its surface or its incoming wave, m.
State outlet_state(const SiteCells& cells, const SiteOutlet& outlet, const OutletCell& cell, double level) {
    const double g = cells.gravity, bed = cells.bed.height[cell.cell], d = std::max(0.0, level - bed);
    const bool wave = outlet.kind == OutletKind::wave;
    if (d == 0 && !wave) return {};
    if (cell.normal_x == 0 && cell.normal_z == 0) return {d, 0, 0};
    const double c_outside = std::sqrt(g * d);
    double u = 0, along = 0, c_inside = 0, h_inside = 0;
    for (std::size_t n = 0; n < cell.count; ++n) {
        const std::size_t c = cell.inside[n];
        const double h = cells.water.h[c], over_bed = std::max(0.0, h + cells.bed.height[c] - bed);
        const bool wet = h > cells.dry;
        const double ux = wet ? cells.water.qx[c] / h : 0, uz = wet ? cells.water.qz[c] / h : 0;
        u += ux * cell.normal_x + uz * cell.normal_z;
        along += uz * cell.normal_x - ux * cell.normal_z;
        c_inside += wet ? std::sqrt(g * over_bed) : std::min(c_outside, std::sqrt(g * over_bed));
        h_inside += h;
    }
    const auto n = static_cast<double>(cell.count);
    u /= n, along /= n, c_inside /= n, h_inside /= n;
    double h = h_inside;
    if (u + fastest_inwards(c_inside, c_outside) > 0) {
        const double leaving = u - 2 * c_inside, rest = std::sqrt(g * std::max(0.0, outlet.stage.front().value - bed));
        const BoundaryFlow flow = wave ? flow_at_wave(g, c_outside, rest, leaving) : flow_at_stage(g, d, leaving);
        h = flow.h;
        u = flow.u;
    }
    if (u > 0) along = 0;
    return {h, h * (u * cell.normal_x - along * cell.normal_z), h * (u * cell.normal_z + along * cell.normal_x)};
}

}  // namespace

SiteWater make_site_water(const Site& site, const Grid& grid, const Openings& openings) {
    SiteWater result;
    std::vector<bool> taken(grid.stored(), false);
    std::vector<std::vector<std::size_t>> cells;
    for (const Outlet& outlet : site.outlets) cells.push_back(cells_of_outlet(outlet, grid, openings, taken));
    for (const Source& source : site.sources) result.sources.push_back(make_source(source, grid, openings, taken));
    result.rain = site.rain;
    for (SeriesPoint& p : result.rain) p.value *= metres_per_second;
    for (std::size_t n = 0; n < cells.size(); ++n)
        result.outlets.push_back(make_outlet(site.outlets[n], cells[n], grid, openings, taken));
    for (const Barrier& barrier : site.barriers) {
        if (std::isfinite(barrier.opens_at)) result.openings_of_gates.push_back(barrier.opens_at);
    }
    std::sort(result.openings_of_gates.begin(), result.openings_of_gates.end());
    return result;
}

double until_gate_opens(const SiteWater& site, double time, double remaining) {
    for (const double opens : site.openings_of_gates) {
        if (opens > time + gate_slack) return std::min(remaining, opens - time);
    }
    return remaining;
}

double longest_with_inflow(const SiteWater& site, double time, double longest, double gravity, double way) {
    const auto largest = [&](const Series& series) {
        double most = std::max(value_at(series, time), value_at(series, time + longest));
        for (const SeriesPoint& p : series) {
            if (p.time > time && p.time < time + longest) most = std::max(most, p.value);
        }
        return most;
    };
    double rate = largest(site.rain);  // m/s
    for (const SiteSource& source : site.sources) {
        double per_volume = 0;
        for (const SourceCell& cell : source.cells) per_volume = std::max(per_volume, cell.per_volume);
        rate = std::max(rate, per_volume * largest(source.discharge));
    }
    if (!(rate > 0)) return longest;
    return std::min(longest, cube_root(way * way / (gravity * rate)));
}

std::vector<std::size_t> groups_of(const SiteWater& site, const Openings& openings) {
    std::vector<std::size_t> cells, groups;
    for (const SiteSource& source : site.sources) {
        for (const SourceCell& cell : source.cells) cells.push_back(cell.cell);
    }
    for (const SiteOutlet& outlet : site.outlets) {
        for (const OutletCell& cell : outlet.cells) cells.push_back(cell.cell);
    }
    std::sort(cells.begin(), cells.end());
    for (std::size_t g = 0; g < openings.groups.size(); ++g) {
        const auto members = openings.members_of_groups.begin();
        const bool touched =
            std::any_of(members + static_cast<std::ptrdiff_t>(openings.groups[g].first),
                        members + static_cast<std::ptrdiff_t>(openings.groups[g].last),
                        [&](std::size_t c) { return std::binary_search(cells.begin(), cells.end(), c); });
        if (touched) groups.push_back(g);
    }
    return groups;
}

Passed exchange(SiteWater& site, const SiteCells& cells, double time, double dt) {
    Passed passed;
    const double begin = time, end = time + dt, area = cells.grid.cell_area();
    const auto own = [&](std::size_t cell) { return cells.band->has(cell / cells.grid.stride - Grid::ghosts); };
    for (const SiteSource& source : site.sources) {
        const double volume = integral_of(source.discharge, begin, end);
        if (volume == 0) continue;
        for (const SourceCell& cell : source.cells) {
            if (own(cell.cell)) cells.water.h[cell.cell] += volume * cell.per_volume;
        }
        passed.inflow += volume;
    }
    if (const double depth = integral_of(site.rain, begin, end); depth > 0) {
        passed.rained = true;
        for (std::size_t k = 0; k < cells.grid.nz; ++k) {
            const std::size_t row = cells.grid.row(static_cast<std::ptrdiff_t>(k));
            double shares = 0;
            if (!cells.band->has(k) && !cells.band->counts()) continue;
            const double rained = cells.band->has(k) ? depth : 0;
            for (std::size_t c = row; c < row + cells.grid.nx; ++c) {
                const double share = cells.openings.share_of(c);
                if (share <= 0) continue;
                cells.water.h[c] += rained;
                shares += share;
            }
            passed.inflow += depth * shares * area;
        }
    }
    site.volumes.clear();
    for (SiteOutlet& outlet : site.outlets) {
        const double level = value_at(outlet.stage, end);
        share_cells(*cells.band, cells.grid, {&cells.water.h, &cells.water.qx, &cells.water.qz}, outlet.beside);
        const auto set = [&](const OutletCell& cell) {
            State state;
            site.volumes.push_back(0);
            if (!own(cell.cell)) return;
            if (outlet.kind != OutletKind::free) state = outlet_state(cells, outlet, cell, level);
            site.volumes.back() = (state.h - cells.water.h[cell.cell]) * cells.openings.share_of(cell.cell) * area;
            cells.water.h[cell.cell] = state.h;
            cells.water.qx[cell.cell] = state.qx;
            cells.water.qz[cell.cell] = state.qz;
        };
        if (passed.rained) {
            std::for_each(outlet.cells.begin(), outlet.cells.end(), set);
        } else {
            for_each_cell_in(cells.active, outlet, set);
        }
    }
    merge(*cells.band, site.volumes);
    for (const double volume : site.volumes) (volume > 0 ? passed.inflow : passed.outflow) += std::abs(volume);
    return passed;
}

bool gates_open(SiteWater& site, double time) {
    const auto opened = std::erase_if(site.openings_of_gates, [&](double opens) { return opens <= time + gate_slack; });
    return opened > 0;
}

}  // namespace wade::fluid::shallow_water
