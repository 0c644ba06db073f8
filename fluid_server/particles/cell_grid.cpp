#include "fluid_server/particles/cell_grid.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "fluid_server/particles/filling.hpp"
#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

namespace {

constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

// Cells above the water at rest, as a multiple of the depth: what is thrown higher counts to the topmost cell.
constexpr double headroom = 3;

// Along a row there are two cells to a spacing of the lattice, so that a run is hardly longer than the box that asks.
constexpr double cells_per_radius_along_row = 4;

// With more cells than this for each particle that there is room for, and more than this in all, those in use are kept alone.
constexpr double dense_cells_per_particle = 8, dense_cells = 65536;

bool is_sparse(const CellLayout& layout, double room) {
    return layout.all() > std::max(dense_cells, dense_cells_per_particle * room);
}

template <typename T>
void gather(std::vector<T>& target, const std::vector<T>& values, const std::vector<std::uint32_t>& source,
            std::size_t n) {
    for_each_particle(n, [&](std::size_t i) { target[i] = values[source[i]]; });
}

}  // namespace

CellLayout layout_of_cells(const Scene& scene, float support_radius) {
    const Channel& channel = scene.channel;
    // An emitter holds its next layers behind the upstream end.
    const double behind = channel.flow == Flow::emitter ? 3 * static_cast<double>(support_radius) : 0;
    const Interval ground = scene.site ? heights_of_ground(scene) : Interval{};
    const std::array<double, 3> lo{channel.x.lo, ground.lo, channel.z.lo};
    const double height = channel.top == Top::open ? headroom * deepest_water(scene) : channel.height;
    const std::array<double, 3> hi{channel.x.hi + behind, ground.hi + height, channel.z.hi};
    CellLayout layout{lo, {}, {}};
    for (std::size_t k = 0; k < 3; ++k) {
        layout.length[k] = hi[k] - lo[k];
        const double width = static_cast<double>(support_radius) / (k == 0 ? cells_per_radius_along_row : 1);
        layout.cells[k] = std::max(1.0, std::floor(layout.length[k] / width));
    }
    return layout;
}

void CellPages::clear() {
    pages_.clear();
    std::fill(slots_.begin(), slots_.end(), none);
}

void CellPages::insert(std::uint64_t page) {
    pages_.push_back(page);
    if (2 * pages_.size() > slots_.size()) {
        slots_.resize(2 * slots_.size());
        --shift_;
        fill_slots();
        return;
    }
    std::size_t slot = slot_of(page);
    while (slots_[slot] != none) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = static_cast<std::uint32_t>(pages_.size() - 1);
}

void CellPages::settle() {
    if (std::is_sorted(pages_.begin(), pages_.end())) return;
    std::sort(pages_.begin(), pages_.end());
    fill_slots();
}

void CellPages::fill_slots() {
    std::fill(slots_.begin(), slots_.end(), none);
    for (std::size_t k = 0; k < pages_.size(); ++k) {
        std::size_t slot = slot_of(pages_[k]);
        while (slots_[slot] != none) slot = (slot + 1) & (slots_.size() - 1);
        slots_[slot] = static_cast<std::uint32_t>(k);
    }
}

double memory_of_cells(const Scene& scene, float support_radius, double particles) {
    const CellLayout layout = layout_of_cells(scene, support_radius);
    if (!is_sparse(layout, scene.fluid->max_particles)) return sizeof(std::uint32_t) * layout.all();
    // Measured, of water that stands together; single particles far from one another take a page each.
    constexpr double bytes_per_particle = 8;
    return bytes_per_particle * particles;
}

CellGrid::CellGrid(const Scene& scene, float support_radius)
    : start_(),
      cell_of_(static_cast<std::size_t>(scene.fluid->max_particles)),
      source_(static_cast<std::size_t>(scene.fluid->max_particles)),
      room_(padded(static_cast<std::size_t>(scene.fluid->max_particles))),
      room_for_kind_(static_cast<std::size_t>(scene.fluid->max_particles)) {
    const Channel& channel = scene.channel;
    periodic_ = {channel.flow == Flow::recirculating || channel.flow == Flow::periodic, channel.top == Top::periodic,
                 channel.sides == Sides::periodic};
    const CellLayout layout = layout_of_cells(scene, support_radius);
    for (std::size_t k = 0; k < 3; ++k) {
        cells_[k] = static_cast<std::uint32_t>(layout.cells[k]);
        origin_[k] = static_cast<float>(layout.lo[k]);
        length_[k] = static_cast<float>(layout.length[k]);
        last_cell_[k] = static_cast<float>(cells_[k] - 1);
        inverse_cell_[k] = static_cast<float>(layout.cells[k] / layout.length[k]);
    }
    sparse_ = is_sparse(layout, scene.fluid->max_particles);
    start_.resize(sparse_ ? 1 : std::size_t{cells_[0]} * cells_[1] * cells_[2] + 1);
}

std::size_t CellGrid::sort(Particles& p, float outflow_x) {
    const std::size_t n = p.count;
    if (sparse_) {
        find_pages(p, outflow_x);
    } else {
        find_cells(p, outflow_x);
    }
    share_cells(n);
    for_each_share(shares_of(n), [&](std::size_t s) { deal_out(first_cell_[s], first_cell_[s + 1], n); });
    const std::size_t kept = start_.back();
    for (const ParticleArray& array : particle_arrays) {
        gather(room_, p.*array.values, source_, kept);
        std::swap(room_, p.*array.values);
    }
    gather(room_for_kind_, p.kind, source_, kept);
    std::swap(room_for_kind_, p.kind);
    p.count = kept;
    return n - kept;
}

void CellGrid::find_cells(const Particles& p, float outflow_x) {
    for_each_particle(p.count, [&](std::size_t i) {
        const std::uint32_t row = row_of(cell_along(1, p.y[i]), cell_along(2, p.z[i]));
        const std::uint32_t cell = cell_in_row(row, cell_along(0, p.x[i]));
        cell_of_[i] = p.x[i] > outflow_x ? cell : no_cell;
    });
}

// Numbers the cells of pages in use, and sets start_ to their count. Particles of one page often follow one another.
void CellGrid::find_pages(const Particles& p, float outflow_x) {
    const auto cell_of = [&](std::size_t i) {
        const std::uint64_t row = row_of(cell_along(1, p.y[i]), cell_along(2, p.z[i]));
        return cell_in_row(row, cell_along(0, p.x[i]));
    };
    constexpr std::uint64_t no_page = std::numeric_limits<std::uint64_t>::max();
    pages_.clear();
    std::uint64_t last = no_page;
    for (std::size_t i = 0; i < p.count; ++i) {
        if (!(p.x[i] > outflow_x)) continue;
        const std::uint64_t page = cell_of(i) / CellPages::cells_per_page;
        if (page != last) pages_.add(page);
        last = page;
    }
    pages_.settle();
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::uint64_t page = no_page;
        std::uint32_t first = 0;  // cell of the page
        for (std::size_t i = begin; i < end; ++i) {
            cell_of_[i] = no_cell;
            if (!(p.x[i] > outflow_x)) continue;
            const std::uint64_t cell = cell_of(i);
            if (cell / CellPages::cells_per_page != page) {
                page = cell / CellPages::cells_per_page;
                first = pages_.rank(page) * static_cast<std::uint32_t>(CellPages::cells_per_page);
            }
            cell_of_[i] = first + static_cast<std::uint32_t>(cell % CellPages::cells_per_page);
        }
    });
    const std::uint32_t total = start_.back();  // share_cells() wants numbers that ascend
    start_.resize(pages_.count() * CellPages::cells_per_page + 1, total);
}

// Each thread deals out to a stretch of the cells, which had about as many particles in the step before as the others'.
void CellGrid::share_cells(std::size_t n) {
    const std::size_t shares = shares_of(n), before = start_.back();
    for (std::size_t s = 0; s < shares; ++s) {
        const auto at = std::lower_bound(start_.begin(), start_.end() - 1, s * before / shares);
        first_cell_[s] = static_cast<std::uint32_t>(at - start_.begin());
    }
    first_cell_[shares] = static_cast<std::uint32_t>(start_.size());
}

// Deals n particles out to the cells [first, last), those of a cell in their order.
void CellGrid::deal_out(std::uint32_t first, std::uint32_t last, std::size_t n) {
    const auto is_here = [&](std::uint32_t cell) { return cell - first < last - first; };
    std::fill(start_.begin() + first, start_.begin() + last, 0U);
    std::uint32_t sum = 0;  // of the particles of the cells before
    for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t cell = cell_of_[i];
        sum += cell < first ? 1U : 0U;
        if (is_here(cell)) ++start_[cell];
    }
    for (std::uint32_t cell = first; cell < last; ++cell) {
        sum += start_[cell];
        start_[cell] = sum;  // the end of each cell; filling from the back turns it into the start
    }
    for (std::size_t i = n; i-- > 0;) {
        const std::uint32_t cell = cell_of_[i];
        if (is_here(cell)) source_[--start_[cell]] = static_cast<std::uint32_t>(i);
    }
}

}  // namespace wade::fluid
