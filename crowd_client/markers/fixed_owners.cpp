#include "crowd_client/markers/fixed_owners.hpp"

#include <algorithm>
#include <cmath>

namespace wade::crowd {

void OwnedMarkers::make_room_for(std::size_t n, bool with_bodies) {
    // Entries in use must stay, and a copy of whole vectors may read or write beyond the end.
    const std::size_t places = count + n + 2 * Lanes<double>::count;
    if (x.size() >= places && (!with_bodies || contested.size() >= places)) return;
    for (std::vector<double>* v : {&x, &z, &contested}) v->resize(places + places / 2);
}

void FixedOwners::begin_row(const Claiming& claiming, const RowBand& band, int row) {
    const auto place = static_cast<std::size_t>(row % claiming.cells.span);
    dealt_[place].count = 0;
    if (!band.has(row)) return;
    const RowEntries entries = entries_of(claiming.cells, row);
    const std::size_t n = entries.last - entries.first;
    const auto span = static_cast<std::size_t>(claiming.cells.span);
    runs_[place].first = entries.first;
    make_room(runs_[place].runs, span * span * n);
    runs_[place].count.assign(n, 0);
}

void FixedOwners::expect_cell(const Claiming& claiming, int column, int row) {
    const Markers& markers = claiming.markers;
    const std::size_t cell = markers.grid.index(column, row), last = markers.cell_start[cell + 1];
    constexpr std::size_t of_a_line = 64 / sizeof(double);
    for (std::size_t m = markers.cell_start[cell]; m < last; m += of_a_line) {
        __builtin_prefetch(&markers.x[m]);
        __builtin_prefetch(&markers.z[m]);
    }
}

void FixedOwners::deal_cell(const Claiming& claiming, const RowBand& band, int column, int row) {
    read_markers(markers_, claiming.markers, column, row);
    if (markers_.count == 0) return;
    find_candidates(candidates_, claiming.cells, claiming.bodies, markers_, column, row);
    claim(claims_, markers_, candidates_, claiming.cells, column, row, claiming.radius);
    if (claiming.bodies != nullptr) {
        find_contested(claims_, markers_, candidates_, claiming.walkers.contest_distance);
    }
    pair_tests += markers_.count * (candidates_.count - 1);
    deal_markers(claiming, band, column, row);
}

void FixedOwners::note_run(const Claiming& claiming, const RowBand& band, std::uint32_t entry, int corner_row, int row,
                           std::uint32_t begin, std::uint32_t end) {
    // Rows of other bands belong to other threads.
    if (begin == end || !band.has(corner_row)) return;
    const auto span = static_cast<std::size_t>(claiming.cells.span);
    Runs& runs = runs_[static_cast<std::size_t>(corner_row) % span];
    const std::size_t i = entry - runs.first;
    runs.runs[span * span * i + runs.count[i]++] = {begin, static_cast<std::uint16_t>(end - begin),
                                                    static_cast<std::uint16_t>(row)};
}

// Groups the markers by owner, each group in the order of the cell.
void FixedOwners::deal_markers(const Claiming& claiming, const RowBand& band, int column, int row) {
    OwnedMarkers& dealt = dealt_[static_cast<std::size_t>(row % claiming.cells.span)];
    dealt.make_room_for(markers_.count, claiming.bodies != nullptr);
    constexpr std::size_t few = 4;
    if (candidates_.count <= few) {
        deal_to_few(dealt, claiming, band, column, row);
    } else {
        deal_to_many(dealt, claiming, band, column, row);
    }
}

// Deals owner by owner; the next marker overwrites a marker of another owner.
void FixedOwners::deal_to_few(OwnedMarkers& dealt, const Claiming& claiming, const RowBand& band, int column, int row) {
    const bool with_bodies = claiming.bodies != nullptr;
    list_owned();
    const std::size_t n = owned_.count;
    const std::uint32_t* const owner = owned_.owner.data();
    const std::uint32_t* const marker = owned_.marker.data();
    auto place = static_cast<std::uint32_t>(dealt.count);
    for_each_run(claiming.cells, column, row, [&](int r, std::uint32_t first, std::uint32_t last, std::size_t before) {
        for (std::uint32_t e = first; e < last; ++e) {
            const std::size_t c = 1 + before + e - first;
            const std::uint32_t begin = place;
            const double x = candidates_.x()[c], z = candidates_.z()[c];
            double* const at_x = dealt.x.data();
            double* const at_z = dealt.z.data();
            for (std::size_t i = 0; i < n; ++i) {
                at_x[place] = markers_.x[marker[i]] - x;
                at_z[place] = markers_.z[marker[i]] - z;
                if (with_bodies) dealt.contested[place] = claims_.contested[marker[i]];
                place += owner[i] == c ? 1U : 0U;
            }
            note_run(claiming, band, e, r, row, begin, place);
        }
    });
    dealt.count = place;
}

// Counts and deals the two halves of a cell side by side: neighbours often have one owner, and its counter would have
// to wait for itself.
void FixedOwners::deal_to_many(OwnedMarkers& dealt, const Claiming& claiming, const RowBand& band, int column,
                               int row) {
    const bool with_bodies = claiming.bodies != nullptr;
    const std::size_t n = markers_.count, half = n / 2, owners = candidates_.count;
    next_.assign(2 * owners, 0);
    std::uint32_t* const lower = next_.data();
    std::uint32_t* const upper = lower + owners;
    const auto* const owner = claims_.owner.data();
    for (std::size_t m = 0; m < half; ++m) {
        ++lower[static_cast<std::size_t>(owner[m])];
        ++upper[static_cast<std::size_t>(owner[m + half])];
    }
    if (n % 2 != 0) ++upper[static_cast<std::size_t>(owner[n - 1])];

    auto place = static_cast<std::uint32_t>(dealt.count);
    const auto first_place = [&](std::size_t c) {
        const std::uint32_t first = place, in_lower = lower[c];
        place += in_lower + upper[c];
        lower[c] = first;
        upper[c] = first + in_lower;
        return first;
    };
    for_each_run(claiming.cells, column, row, [&](int r, std::uint32_t first, std::uint32_t last, std::size_t before) {
        for (std::uint32_t e = first; e < last; ++e) {
            const std::uint32_t begin = first_place(1 + before + e - first);
            note_run(claiming, band, e, r, row, begin, place);
        }
    });
    dealt.count = place;
    // Markers without an owner (candidate 0) go behind the others, where the next cell overwrites them.
    first_place(0);

    const double* const owner_x = candidates_.x().data();
    const double* const owner_z = candidates_.z().data();
    const auto deal = [&](std::size_t m, std::uint32_t* next) {
        const auto o = static_cast<std::size_t>(owner[m]);
        const std::uint32_t to = next[o]++;
        dealt.x[to] = markers_.x[m] - owner_x[o];
        dealt.z[to] = markers_.z[m] - owner_z[o];
        if (with_bodies) dealt.contested[to] = claims_.contested[m];
    };
    for (std::size_t m = 0; m < half; ++m) {
        deal(m, lower);
        deal(m + half, upper);
    }
    if (n % 2 != 0) deal(n - 1, upper);
}

// Lists the owned markers without branches: a walker alone owns a random few of the markers of a cell.
void FixedOwners::list_owned() {
    make_room(owned_.marker, markers_.count);
    make_room(owned_.owner, markers_.count);
    std::uint32_t* const marker = owned_.marker.data();
    std::uint32_t* const owner = owned_.owner.data();
    const auto* const claimed = claims_.owner.data();
    std::uint32_t count = 0;
    for (std::uint32_t m = 0; m < markers_.count; ++m) {
        const auto o = static_cast<std::uint32_t>(claimed[m]);
        marker[count] = m;
        owner[count] = o;
        count += o != 0 ? 1U : 0U;
    }
    owned_.count = count;
}

// Appends the markers of an entry in a row of cells.
void FixedOwners::append_runs(const Claiming& claiming, std::uint32_t entry, int corner_row, int row) {
    const bool with_bodies = claiming.bodies != nullptr;
    const auto span = static_cast<std::size_t>(claiming.cells.span);
    const OwnedMarkers& dealt = dealt_[static_cast<std::size_t>(row) % span];
    const Runs& runs = runs_[static_cast<std::size_t>(corner_row) % span];
    const std::size_t of_entry = entry - runs.first;
    for (std::size_t i = 0; i < runs.count[of_entry]; ++i) {
        const Run& run = runs.runs[span * span * of_entry + i];
        if (run.row != static_cast<std::uint16_t>(row)) continue;
        own_.make_room_for(run.count, with_bodies);
        double* const x = own_.x.data() + own_.count;
        double* const z = own_.z.data() + own_.count;
        const double* const from_x = dealt.x.data() + run.begin;
        const double* const from_z = dealt.z.data() + run.begin;
        for (std::size_t k = 0; k < run.count; k += Lanes<double>::count) {
            std::memcpy(x + k, from_x + k, 64);
            std::memcpy(z + k, from_z + k, 64);
            if (with_bodies) std::memcpy(&own_.contested[own_.count + k], &dealt.contested[run.begin + k], 64);
        }
        own_.count += run.count;
    }
}

void FixedOwners::finish(const Claiming& claiming, std::uint32_t entry, std::uint32_t image, int row) {
    own_.count = 0;
    for (int r = row; r < std::min(row + claiming.cells.span, claiming.cells.grid.rows); ++r) {
        append_runs(claiming, entry, row, r);
        if (image != WalkerCells::none) append_runs(claiming, image, row, r);
    }
    const std::uint32_t k = claiming.cells.walker[entry];
    const std::size_t n = own_.count;
    const bool with_bodies = claiming.bodies != nullptr;
    const double discount = with_bodies ? claiming.walkers.discount[k] : 0;
    claiming.motion.owned[k] = static_cast<std::uint32_t>(n);
    claiming.motion.vector[k] =
        n > 0 ? motion_of_own(claiming.walkers.goal_offset[k], discount, with_bodies) : Vector2d(0, 0);
    if (!with_bodies) return;
    std::uint32_t contested = 0;
    for (std::size_t i = 0; i < n; ++i) contested += own_.contested[i] != 0 ? 1U : 0U;
    claiming.motion.contested[k] = contested;
}

Vector2d FixedOwners::motion_of_own(const Vector2d& goal_offset, double discount, bool with_bodies) {
    const std::size_t n = own_.count;
    const double* const x = own_.x.data();
    const double* const z = own_.z.data();
    make_room(preference_, n);
    make_room(weight_, n);
    double* const f = preference_.data();
    double* const w = weight_.data();
    const double goal_x = goal_offset.x(), goal_z = goal_offset.y();
    const double goal_distance = std::sqrt(goal_x * goal_x + goal_z * goal_z);
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) {
        const double distance = std::sqrt(x[i] * x[i] + z[i] * z[i]);
        const double norms = distance * goal_distance;
        double cosine = (goal_x * x[i] + goal_z * z[i]) / (norms > 0 ? norms : 1.0);
        cosine = cosine < -1 ? -1.0 : cosine > 1 ? 1.0 : cosine;
        f[i] = (1 + (norms > 0 ? cosine : 0.0)) / (1 + distance);
    }
    if (with_bodies) {
        for (std::size_t i = 0; i < n; ++i) f[i] *= 1 - discount * own_.contested[i];
    }
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += f[i];
    if (!(sum > 0)) return Vector2d::Zero();
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) w[i] = f[i] / sum;
    Vector2d m = Vector2d::Zero();
    for (std::size_t i = 0; i < n; ++i) m += w[i] * Vector2d(x[i], z[i]);
    return m;
}

}  // namespace wade::crowd
