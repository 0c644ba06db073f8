#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "fluid_server/shallow_water/world.hpp"

namespace wade::fluid::shallow_water {

namespace {

constexpr std::size_t fewest_rows = 4;  // of a band: three that each neighbour may read
constexpr double worth_while = 1.2;     // work of the busiest band over the mean, above which bands are cut anew

std::size_t rank_of(const Band& band, std::size_t row) {
    const auto above = std::upper_bound(band.first_rows.begin(), band.first_rows.end(), row);
    return static_cast<std::size_t>(above - band.first_rows.begin()) - 1;
}

std::size_t row_of(const Grid& grid, std::size_t cell) {
    return cell / grid.stride - Grid::ghosts;
}

// Work by row: cells at the water, and what an empty row costs.
std::vector<double> work_of_rows(const ShallowWater& world) {
    std::vector<double> work(world.grid.nz, 0);
    for (std::size_t k = 0; k < work.size(); ++k) {
        work[k] = 8;
        world.lines.active.for_each_span(k, [&](std::size_t, std::size_t n) { work[k] += static_cast<double>(n); });
    }
    return work;
}

// First rows of bands with equally much to do, and the end.
std::vector<std::size_t> cut(const std::vector<double>& work, std::size_t ranks) {
    std::vector<double> sum(work.size() + 1, 0);
    for (std::size_t k = 0; k < work.size(); ++k) sum[k + 1] = sum[k] + work[k];
    std::vector<std::size_t> first(ranks + 1, 0);
    for (std::size_t r = 1; r < ranks; ++r) {
        const double wanted = sum.back() * static_cast<double>(r) / static_cast<double>(ranks);
        const auto row = static_cast<std::size_t>(std::lower_bound(sum.begin(), sum.end(), wanted) - sum.begin());
        first[r] = std::clamp(row, first[r - 1] + fewest_rows, work.size() - fewest_rows * (ranks - r));
    }
    first[ranks] = work.size();
    return first;
}

double busiest(const std::vector<double>& work, const std::vector<std::size_t>& first) {
    double most = 0;
    for (std::size_t r = 0; r + 1 < first.size(); ++r) {
        double sum = 0;
        for (std::size_t k = first[r]; k < first[r + 1]; ++k) sum += work[k];
        most = std::max(most, sum);
    }
    return most;
}

void take_bands(ShallowWater& world, std::vector<std::size_t> first) {
    Band& band = world.band;
    const auto rank = static_cast<std::size_t>(band.ranks->rank());
    band.begin = first[rank], band.end = first[rank + 1];
    band.first_rows = std::move(first);
    find_shared(world);
}

std::uint64_t* place_in(const RowField& field, std::size_t row) {
    return static_cast<std::uint64_t*>(field.row) + row * field.pitch;
}

RowField by_cell(RowMemory& values, const Grid& grid) {
    return {values.data() + grid.row(0), grid.stride, values.empty() ? 0 : grid.nx};
}

std::vector<RowField> all_fields(ShallowWater& world, std::span<const RowField> others) {
    std::vector<RowField> fields(others.begin(), others.end());
    for (RowMemory* field : {&world.water.h, &world.water.qx, &world.water.qz, &world.primitive.h, &world.primitive.eta,
                             &world.primitive.u, &world.primitive.v}) {
        if (!field->empty()) fields.push_back(by_cell(*field, world.grid));
    }
    return fields;
}

// Calls body(words, n) for the values of some lines in rows [begin, end), in an order that all ranks have.
template <typename Body>
void for_each_part(const Lines& lines, std::span<const RowField> fields, std::size_t begin, std::size_t end,
                   Body&& body) {
    for (std::size_t k = begin; k < end; ++k) {
        lines.for_each_span(k, [&](std::size_t i, std::size_t n) {
            for (const RowField& field : fields) body(place_in(field, k) + i, n);
        });
    }
}

}  // namespace

void spread(ShallowWater& world, Ranks& ranks) {
    const auto count = static_cast<std::size_t>(ranks.count());
    if (world.grid.nz < fewest_rows * count) {
        throw ConfigurationError(world.scene.name + ": " + std::to_string(world.grid.nz) + " rows of cells over " +
                                 std::to_string(count) + " ranks; allowed: " + std::to_string(fewest_rows) +
                                 " rows a rank and more, so " + std::to_string(world.grid.nz / fewest_rows) +
                                 " ranks at most");
    }
    world.band.ranks = &ranks;
    take_bands(world, cut(work_of_rows(world), count));
    world.band.touched = Lines(world.grid, true);
    world.bands.clear();
    if (world.site) find_active(world);
}

void fill_borders(ShallowWater& world, Primitive& state) {
    Band& band = world.band;
    const Grid& grid = world.grid;
    fill_ghosts(state, grid, world.scene.channel, world.constants.gravity, world.lines.active, band.begin, band.end);
    if (band.ranks == nullptr) return;
    std::vector<RowMemory*> fields{&state.h, &state.u, &state.v};
    if (!state.eta.empty()) fields.push_back(&state.eta);
    const std::size_t rows = Grid::ghosts + (world.site ? 1 : 0);  // slopes away from a wall look at one more
    const std::size_t width = grid.nx + 2 * Grid::ghosts;
    const std::size_t size = fields.size() * rows * width;
    const auto copy = [&](std::vector<double>& message, std::ptrdiff_t row, bool out) {
        message.resize(size);
        double* at = message.data();
        for (RowMemory* field : fields) {
            for (std::size_t g = 0; g < rows; ++g, at += width) {
                double* const cells = field->data() + grid.row(row + static_cast<std::ptrdiff_t>(g)) - Grid::ghosts;
                out ? std::copy_n(cells, width, at) : std::copy_n(at, width, cells);
            }
        }
    };
    const int last = band.ranks->count() - 1, rank = band.ranks->rank();
    const bool round = world.scene.channel->sides == Sides::periodic;
    const auto begin = static_cast<std::ptrdiff_t>(band.begin), end = static_cast<std::ptrdiff_t>(band.end);
    const auto read = static_cast<std::ptrdiff_t>(rows);
    Ranks::Neighbour lower, upper;
    lower.rank = rank > 0 ? rank - 1 : round ? last : -1;
    upper.rank = rank < last ? rank + 1 : round ? 0 : -1;
    band.from_lower.resize(size), band.from_upper.resize(size);
    if (lower.rank >= 0) copy(band.to_lower, begin, true);
    if (upper.rank >= 0) copy(band.to_upper, end - read, true);
    lower.to = band.to_lower, lower.from = band.from_lower;
    upper.to = band.to_upper, upper.from = band.from_upper;
    band.ranks->exchange(lower, upper);
    if (lower.rank >= 0) copy(band.from_lower, begin - read, false);
    if (upper.rank >= 0) copy(band.from_upper, end, false);
}

double largest(const Band& band, double value) {
    return band.ranks == nullptr ? value : band.ranks->largest(value);
}

bool all_agree(const Band& band, bool yes) {
    return band.ranks == nullptr ? yes : band.ranks->largest(yes ? 0 : 1) == 0;
}

void merge(Band& band, std::vector<double>& values) {
    if (band.ranks == nullptr || values.empty()) return;
    band.words.resize(values.size());
    std::memcpy(band.words.data(), values.data(), sizeof(double) * values.size());
    band.ranks->merge(band.words);
    std::memcpy(values.data(), band.words.data(), sizeof(double) * values.size());
}

void gather_rows(Band& band, std::span<const RowField> fields, bool for_all) {
    if (band.ranks == nullptr) return;
    std::size_t width = 0;
    for (const RowField& field : fields) width += field.words;
    band.part.clear();
    for (std::size_t k = band.begin; k < band.end; ++k) {
        for (const RowField& field : fields) {
            const std::uint64_t* const row = place_in(field, k);
            band.part.insert(band.part.end(), row, row + field.words);
        }
    }
    std::vector<int> counts;
    for (std::size_t r = 0; r + 1 < band.first_rows.size(); ++r) {
        counts.push_back(static_cast<int>(width * (band.first_rows[r + 1] - band.first_rows[r])));
    }
    const bool gets = for_all || band.ranks->first();
    band.all.resize(gets ? width * band.first_rows.back() : 0);
    band.ranks->gather(band.part, counts, band.all, for_all);
    if (!gets) return;
    const std::uint64_t* at = band.all.data();
    for (std::size_t k = 0; k < band.first_rows.back(); ++k) {
        for (const RowField& field : fields) {
            if (!band.has(k)) std::copy_n(at, field.words, place_in(field, k));
            at += field.words;
        }
    }
}

void find_shared(ShallowWater& world) {
    Band& band = world.band;
    if (band.ranks == nullptr) return;
    const Openings& openings = world.openings;
    const auto rank_of_cell = [&](std::size_t c) { return rank_of(band, row_of(world.grid, c)); };
    band.shared.clear();
    for (const Group& group : openings.groups) {
        const std::size_t rank = rank_of_cell(openings.members_of_groups[group.first]);
        bool several = false;
        for (std::size_t m = group.first; m < group.last; ++m) {
            several = several || rank_of_cell(openings.members_of_groups[m]) != rank;
        }
        if (!several) continue;
        const auto members = openings.members_of_groups.begin();
        band.shared.insert(band.shared.end(), members + static_cast<std::ptrdiff_t>(group.first),
                           members + static_cast<std::ptrdiff_t>(group.last));
    }
    if (!world.site) return;
    for (SiteOutlet& outlet : world.site->outlets) {
        outlet.beside.clear();
        for (const OutletCell& cell : outlet.cells) {
            for (std::size_t n = 0; n < cell.count; ++n) {
                if (rank_of_cell(cell.inside[n]) != rank_of_cell(cell.cell)) outlet.beside.push_back(cell.inside[n]);
            }
        }
    }
}

void share_cells(Band& band, const Grid& grid, const std::array<RowMemory*, 3>& fields,
                 const std::vector<std::size_t>& cells) {
    if (band.ranks == nullptr || cells.empty()) return;
    std::vector<double> values;
    for (const std::size_t c : cells) {
        const bool own = band.has(row_of(grid, c));
        for (const RowMemory* field : fields) values.push_back(own ? (*field)[c] : 0);
    }
    merge(band, values);
    const double* at = values.data();
    for (const std::size_t c : cells) {
        for (RowMemory* field : fields) (*field)[c] = *at++;
    }
}

void share_groups(ShallowWater& world, RowMemory& h, RowMemory& qx, RowMemory& qz) {
    share_cells(world.band, world.grid, {&h, &qx, &qz}, world.band.shared);
}

void share_wet(ShallowWater& world) {
    Band& band = world.band;
    if (band.ranks == nullptr) return;
    std::vector<RowField> marks;
    for (Lines* lines : {&world.lines.wet.own, &world.lines.wet.one}) {
        marks.push_back({lines->row(0), lines->words(), lines->words()});
    }
    gather_rows(band, marks, true);
}

void keep_own_groups(ShallowWater& world) {
    if (world.band.ranks == nullptr) return;
    const Openings& openings = world.openings;
    std::erase_if(world.openings.active_groups, [&](std::size_t g) {
        const auto places = openings.places_of_members.begin();
        return std::none_of(places + static_cast<std::ptrdiff_t>(openings.groups[g].first),
                            places + static_cast<std::ptrdiff_t>(openings.groups[g].last),
                            [&](const MemberPlace& place) { return world.band.has(place.row); });
    });
}

void note_touched(ShallowWater& world) {
    if (world.band.ranks == nullptr) return;
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::uint64_t* const active = world.lines.active.row(static_cast<std::ptrdiff_t>(k));
        std::uint64_t* const touched = world.band.touched.row(static_cast<std::ptrdiff_t>(k));
        for (std::size_t w = 0; w < world.lines.active.words(); ++w) touched[w] |= active[w];
    }
}

void share_all(ShallowWater& world, std::span<const RowField> others) {
    if (world.band.ranks == nullptr) return;
    // A field at a time, as a message holds 2^31 - 1 words at most.
    for (const RowField& field : all_fields(world, others)) gather_rows(world.band, {&field, 1}, true);
    world.stage = world.water;
    world.stage_primitive = world.primitive;
}

void rebalance(ShallowWater& world, std::span<const RowField> others) {
    Band& band = world.band;
    if (band.ranks == nullptr || !world.site) return;
    const std::vector<double> work = work_of_rows(world);
    double all = 0;
    for (const double row : work) all += row;
    const auto count = static_cast<std::size_t>(band.ranks->count());
    const double now = busiest(work, band.first_rows);
    if (now < worth_while * all / static_cast<double>(count)) return;
    std::vector<std::size_t> first = cut(work, count);
    if (busiest(work, first) > 0.9 * now) return;
    share_all(world, others);
    take_bands(world, std::move(first));
    find_active(world);
    fill_borders(world, world.primitive);
}

void collect_frame(ShallowWater& world, std::span<const RowField> others) {
    Band& band = world.band;
    if (band.ranks == nullptr) return;
    std::vector<double> discharges;
    for (const GaugedCell& cell : world.gauged) {
        const bool own = band.has(cell.row);
        discharges.insert(discharges.end(), {own ? cell.qx : 0, own ? cell.qz : 0});
    }
    merge(band, discharges);
    for (std::size_t n = 0; n < world.gauged.size(); ++n) {
        world.gauged[n].qx = discharges[2 * n], world.gauged[n].qz = discharges[2 * n + 1];
    }
    std::vector<RowField> fields(others.begin(), others.end()), twins = fields;
    for (RowMemory* field : {&world.water.h, &world.water.qx, &world.primitive.u, &world.primitive.v}) {
        fields.push_back(by_cell(*field, world.grid));
    }
    // Steps swap two memories, and a line that falls dry is sent once: the first rank needs it in both.
    for (RowMemory* field : {&world.stage.h, &world.stage.qx, &world.stage_primitive.u, &world.stage_primitive.v}) {
        twins.push_back(by_cell(*field, world.grid));
    }
    // What the first rank has itself need not travel.
    const Lines& lines = band.touched;
    std::vector<int> counts(band.first_rows.size() - 1, 0);
    std::size_t size = 0;
    for (std::size_t k = band.first_rows[1]; k < world.grid.nz; ++k) {
        std::size_t count = 0;
        lines.for_each_span(k, [&](std::size_t, std::size_t n) { count += n * fields.size(); });
        counts[rank_of(band, k)] += static_cast<int>(count);
        size += count;
    }
    band.part.resize(static_cast<std::size_t>(counts[static_cast<std::size_t>(band.ranks->rank())]));
    if (!band.part.empty()) {
        std::uint64_t* to = band.part.data();
        for_each_part(lines, fields, band.begin, band.end,
                      [&](const std::uint64_t* words, std::size_t n) { to = std::copy_n(words, n, to); });
    }
    band.all.resize(band.ranks->first() ? size : 0);
    band.ranks->gather(band.part, counts, band.all, false);
    if (band.ranks->first()) {
        for (const std::vector<RowField>* memory : {&fields, &twins}) {
            const std::uint64_t* at = band.all.data();
            for_each_part(lines, *memory, band.end, world.grid.nz, [&](std::uint64_t* words, std::size_t n) {
                std::copy_n(at, n, words);
                at += n;
            });
        }
    }
    band.touched = world.lines.active;
}

}  // namespace wade::fluid::shallow_water
