#include "fluid_server/shallow_water/world.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "configs/scene/channel.hpp"
#include "configs/scene/world.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/shallow_water/site/site_ground.hpp"

namespace wade::fluid::shallow_water {

namespace {

// A cell is dry below this share of the deepest water: a film without velocity.
constexpr double dry_share = 1e-5;
// On a site, below this share of a cell's size [A].
constexpr double dry_share_of_cell = 1e-4;

// `step`: from a cell to the one above the face.
Walls find_walls(const Grid& grid, const RowMemory& obstacle, std::size_t step) {
    Walls walls;
    if (obstacle.empty()) return walls;
    walls.side.assign(grid.stored(), 0);
    walls.rows.assign(grid.stored() / grid.stride, 0);
    for (std::size_t c = step; c < grid.stored(); ++c) {
        walls.side[c] = obstacle[c] - obstacle[c - step];
        if (walls.side[c] != 0) walls.rows[c / grid.stride] = 1;
    }
    return walls;
}

// Depth, surface and velocity of n cells; the velocity is 0 up to the depth `dry`.
void find_primitive(const double* h, const double* qx, const double* qz, const double* bed, std::size_t n, double dry,
                    const CellRow& primitive) {
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

// The primitive state of n cells from place c on.
void find_primitives(ShallowWater& world, std::size_t c, std::size_t n) {
    Primitive& p = world.primitive;
    double* const eta = p.eta.empty() ? p.h.data() : p.eta.data();
    find_primitive(world.water.h.data() + c, world.water.qx.data() + c, world.water.qz.data() + c,
                   world.bed.height.data() + c, n, world.constants.dry,
                   {p.h.data() + c, eta + c, p.u.data() + c, p.v.data() + c});
}

// The primitive state of active cells, without ghosts.
void find_primitives(ShallowWater& world) {
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(k));
            world.lines.active.for_each_span(
                k, [&](std::size_t first, std::size_t n) { find_primitives(world, row + first, n); });
        }
    });
}

// What a step reads of cells that it does not work on is the same in all of its memory.
void copy_to_stage(ShallowWater& world, std::size_t c, std::size_t n) {
    const auto copy = [&](const RowMemory& from, RowMemory& to) {
        if (!from.empty()) std::copy_n(from.data() + c, n, to.data() + c);
    };
    copy(world.water.h, world.stage.h);
    copy(world.water.qx, world.stage.qx);
    copy(world.water.qz, world.stage.qz);
    copy(world.primitive.h, world.stage_primitive.h);
    copy(world.primitive.eta, world.stage_primitive.eta);
    copy(world.primitive.u, world.stage_primitive.u);
    copy(world.primitive.v, world.stage_primitive.v);
}

// Bands of rows with equally much to do in each.
void balance_bands(ShallowWater& world) {
    const Lines& active = world.lines.active;
    const std::size_t first = world.band.begin, rows = world.band.end - first;
    std::vector<std::size_t> sum(rows + 1, 0);
    for (std::size_t k = 0; k < rows; ++k) {
        std::size_t n = 0;
        for (std::size_t w = 0; w < active.words(); ++w) {
            n += static_cast<std::size_t>(std::popcount(active.row(static_cast<std::ptrdiff_t>(first + k))[w]));
        }
        sum[k + 1] = sum[k] + n;
    }
    const auto threads = static_cast<std::size_t>(world.grid.cells() >= serial_below ? omp_get_max_threads() : 1);
    world.bands.assign(threads + 1, first);
    for (std::size_t t = 1; t < threads; ++t) {
        const auto row = std::lower_bound(sum.begin(), sum.end(), t * sum.back() / threads);
        world.bands[t] = first + static_cast<std::size_t>(row - sum.begin());
    }
    world.bands[threads] = world.band.end;
}

// Groups with a cell in an active line, and the lines of all of their cells.
void find_active_groups(ShallowWater& world) {
    Openings& openings = world.openings;
    Lines& active = world.lines.active;
    openings.active_groups.clear();
    for (std::size_t g = 0; g < openings.groups.size(); ++g) {
        const Lines::Position* const begin = openings.lines_of_groups.data() + openings.groups[g].first_line;
        const Lines::Position* const end = openings.lines_of_groups.data() + openings.groups[g].last_line;
        if (std::none_of(begin, end, [&](const Lines::Position& line) { return active.has(line); })) continue;
        openings.active_groups.push_back(g);
        std::for_each(begin, end, [&](const Lines::Position& line) { active.set(line); });
    }
}

// Lines with a cell that is not closed.
Lines open_lines(const Openings& openings, const Grid& grid) {
    if (!openings.any()) return Lines(grid, true);
    Lines open(grid, false);
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const double* const share = openings.share.data() + grid.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t i = 0; i < grid.nx; ++i) {
            if (share[i] > 0) open.set(k, i);
        }
    }
    return open;
}

void mark_always(ShallowWater& world) {
    world.lines.always = Lines(world.grid, false);
    const auto mark = [&](std::size_t c) {
        world.lines.always.set(c / world.grid.stride - Grid::ghosts, c % world.grid.stride - line_values);
    };
    for (const SiteSource& source : world.site->sources) {
        for (const SourceCell& cell : source.cells) mark(cell.cell);
    }
    for (const SiteOutlet& outlet : world.site->outlets) {
        if (outlet.kind == OutletKind::free) continue;  // dry where no water is beside it
        for (const OutletCell& cell : outlet.cells) mark(cell.cell);
    }
}

}  // namespace

ShallowWater::ShallowWater(const Scene& its_scene)
    : scene(its_scene),
      grid(make_grid(scene)),
      bed(scene.site ? site_bed(*scene.site, grid) : make_bed(scene, grid)),
      water(initial_water(scene, grid, bed)),
      primitive(grid, bed),
      stage(grid),
      stage_primitive(grid, bed),
      walls_x(find_walls(grid, bed.obstacle, 1)),
      walls_z(find_walls(grid, bed.obstacle, grid.stride)),
      row_fastest(grid.nz, 0),
      row_least(grid.nz, 0),
      row_volume(grid.nz, 0),
      row_momentum(grid.nz, 0),
      row_inflow(grid.nz, 0),
      row_outflow(grid.nz, 0) {
    const double tilt = std::atan(scene.channel->slope);
    constants.gravity = scene.world->gravity * std::cos(tilt);
    constants.dry = dry_share * deepest_water(scene);
    acceleration = -scene.world->gravity * std::sin(tilt);
    manning_n = scene.site ? scene.site->roughness.n : scene.channel->manning_n;
    lines.active = Lines(grid, true);
    band.end = grid.nz;
    if (scene.site) {
        constants.dry = dry_share_of_cell * std::min(grid.dx, grid.dz);
        constants.films_rest = true;
        set_openings(*this, 0);
        fill_site(*scene.site, grid, bed.height, openings.share, water.h);
        site = make_site_water(*scene.site, grid, openings);
        site->groups = groups_of(*site, openings);
        lines.wet = WetMarks(grid);
        lines.before = Lines(grid, false);
        mark_always(*this);
        exchange(*this, 0);
    }
    update_primitive(*this);
}

Passed exchange(ShallowWater& world, double dt) {
    const SiteCells cells{world.grid,          world.bed,          world.openings, world.water, world.constants.gravity,
                          world.constants.dry, world.lines.active, &world.band};
    return exchange(*world.site, cells, world.time, dt);
}

void set_openings(ShallowWater& world, double time) {
    std::vector<Barrier> closed;
    std::ranges::copy_if(world.scene.site->barriers, std::back_inserter(closed),
                         [time](const Barrier& barrier) { return barrier.opens_at > time; });
    world.openings = find_openings(world.grid, world.scene.site->houses, world.bed.ground, closed);
    world.bed.height = world.bed.ground;
    std::replace_if(
        world.bed.height.begin(), world.bed.height.end(), [](double b) { return std::isnan(b); }, 0.0);
    level_groups(world.openings, world.bed.height);
    world.lines.open = open_lines(world.openings, world.grid);
    if (!world.bed.n_squared.empty()) {
        world.bed.n_squared = squares_of_manning(world.scene.site->roughness, world.grid);
        level_groups(world.openings, world.bed.n_squared);
    }
    if (world.site) world.site->groups = groups_of(*world.site, world.openings);
    find_shared(world);
}

void watch_faces(ShallowWater& world, const std::vector<std::size_t>& faces) {
    world.watched.clear();
    for (const std::size_t face : faces) {
        WatchedFace& watched = world.watched.emplace_back();
        watched.face = face;
        watched.row_mass.assign(world.grid.nz, 0);
        watched.row_momentum.assign(world.grid.nz, 0);
    }
}

void update_active(ShallowWater& world) {
    share_groups(world, world.water.h, world.water.qx, world.water.qz);
    for (RowMemory* q : {&world.water.h, &world.water.qx, &world.water.qz}) level_active_groups(world.openings, *q);
    find_primitives(world);
    fill_borders(world, world.primitive);
}

void update_exchanged(ShallowWater& world) {
    Openings& openings = world.openings;
    share_groups(world, world.water.h, world.water.qx, world.water.qz);
    for (const std::size_t g : world.site->groups) {
        const Group& group = openings.groups[g];
        for (RowMemory* q : {&world.water.h, &world.water.qx, &world.water.qz}) level_group(openings, group, *q);
        for (std::size_t m = group.first; m < group.last; ++m) find_primitives(world, openings.members_of_groups[m], 1);
    }
    for (const SiteSource& source : world.site->sources) {
        for (const SourceCell& cell : source.cells) find_primitives(world, cell.cell, 1);
    }
    for (const SiteOutlet& outlet : world.site->outlets) {
        for_each_cell_in(world.lines.active, outlet,
                         [&](const OutletCell& cell) { find_primitives(world, cell.cell, 1); });
    }
    fill_borders(world, world.primitive);
}

void find_active(ShallowWater& world) {
    WetLines& lines = world.lines;
    const Grid& grid = world.grid;
    note_touched(world);
    std::swap(lines.active, lines.before);
    if (lines.active.words() != lines.before.words()) lines.active = Lines(grid, false);
    for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
        for (std::size_t k = begin; k < end; ++k) {
            const double* const h = world.primitive.h.data() + grid.row(static_cast<std::ptrdiff_t>(k));
            mark_wet(h, k, world.constants.dry, lines.before, lines.wet);
        }
    });
    share_wet(world);
    const auto by_rows = [&](auto&& body) {
        // Which lines are active all ranks know of all rows.
        for (std::size_t k = 0; world.band.ranks != nullptr && k < grid.nz; ++k) body(k);
        if (world.band.ranks != nullptr) return;
        for_each_band(world, [&](std::size_t begin, std::size_t end, RowMemory&) {
            for (std::size_t k = begin; k < end; ++k) body(k);
        });
    };
    by_rows([&](std::size_t k) { mark_active(static_cast<std::ptrdiff_t>(k), lines); });
    find_active_groups(world);
    by_rows([&](std::size_t k) {
        const std::size_t row = grid.row(static_cast<std::ptrdiff_t>(k));
        lines.before.for_each_span_less(
            k, lines.active, [&](std::size_t first, std::size_t n) { copy_to_stage(world, row + first, n); });
    });
    keep_own_groups(world);
    note_touched(world);
    balance_bands(world);
}

std::size_t active_cells(const ShallowWater& world) {
    if (!world.site) return world.grid.cells();
    std::size_t cells = 0;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        world.lines.active.for_each_span(k, [&](std::size_t, std::size_t n) { cells += n; });
    }
    return cells;
}

void update_primitive(ShallowWater& world) {
    world.lines.active = Lines(world.grid, true);
    world.openings.active_groups.resize(world.openings.groups.size());
    std::iota(world.openings.active_groups.begin(), world.openings.active_groups.end(), std::size_t{0});
    update_active(world);
    if (world.site) find_active(world);
}

}  // namespace wade::fluid::shallow_water
