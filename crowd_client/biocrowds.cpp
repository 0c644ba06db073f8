#include "crowd_client/biocrowds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "crowd_client/claims.hpp"

namespace wade::crowd {
namespace {

// Markers that a walker owns in one cell: a piece of a dealt row.
struct Run {
    std::uint32_t begin = 0;
    std::uint16_t count = 0;
    std::uint16_t row = 0;  // of the cell
};

// Markers as their owners see them.
template <typename Real>
struct Offsets {
    std::vector<Real> x, z;       // marker - walker, m
    std::vector<Real> contested;  // 0 or 1; with bodies only
    std::size_t count = 0;

    void make_room_for(std::size_t n, bool with_bodies) {
        // What is there must stay, and a copy of whole vectors may read or write beyond the end.
        const std::size_t places = count + n + 2 * Lanes<Real>::count;
        if (x.size() >= places && (!with_bodies || contested.size() >= places)) return;
        for (std::vector<Real>* v : {&x, &z, &contested}) v->resize(places + places / 2);
    }
};

// Of one thread.
template <typename Real>
struct Band {
    MarkerLanes<Real> markers;
    Candidates<Real> candidates;
    Claims<Real> claims;
    std::vector<std::uint32_t> next;    // by candidate: place of its next marker in the row
    std::array<Offsets<Real>, 3> rows;  // dealt, the last `span` ones
    Offsets<Real> own;                  // of the walker at hand
    std::vector<Real> preference, weight;
    std::uint64_t pair_tests = 0;
};

}  // namespace

struct MarkerWork {
    WalkerCells cells;
    WalkerBodies bodies;
    std::size_t runs_an_entry = 0;  // room for them
    std::vector<Run> runs;
    std::vector<std::uint8_t> run_count;  // by entry
    std::vector<Band<double>> fixed;
    std::vector<Band<float>> drawn;
};

MarkerMemory::MarkerMemory() : work_(std::make_unique<MarkerWork>()) {}
MarkerMemory::~MarkerMemory() = default;
MarkerMemory::MarkerMemory(MarkerMemory&&) noexcept = default;
MarkerMemory& MarkerMemory::operator=(MarkerMemory&&) noexcept = default;

namespace {

template <typename Real>
std::vector<Band<Real>>& bands_of(MarkerWork& work);
template <>
std::vector<Band<double>>& bands_of(MarkerWork& work) {
    return work.fixed;
}
template <>
std::vector<Band<float>>& bands_of(MarkerWork& work) {
    return work.drawn;
}

// Eq. 1-3 in the order of the markers, as marker_preference, marker_weight and motion_vector have it, to the bit.
Vector2d motion_of(Band<double>& band, const Vector2d& goal_offset, double discount, bool with_bodies) {
    const std::size_t n = band.own.count;
    const double* const x = band.own.x.data();
    const double* const z = band.own.z.data();
    make_room(band.preference, n);
    make_room(band.weight, n);
    double* const f = band.preference.data();
    double* const w = band.weight.data();
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
        for (std::size_t i = 0; i < n; ++i) f[i] *= 1 - discount * band.own.contested[i];
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

// Of the lanes, always in one order.
float total(const Lanes<float>::Reals& v) {
    static_assert(Lanes<float>::count == 16);
    std::array<float, 16> s;
    std::memcpy(s.data(), &v, sizeof v);
    for (std::size_t k = 0; k < 8; ++k) s[k] += s[k + 8];
    for (std::size_t k = 0; k < 4; ++k) s[k] += s[k + 4];
    return (s[0] + s[2]) + (s[1] + s[3]);
}

// The same with Eq. 2 left to the end, m = sum f a / sum f, and with one division a marker:
// f = (1 + g.a / |a|) / (1 + |a|) = (|a| + g.a) / (|a| (1 + |a|)), g the direction of the goal. Lane by lane, so that
// the order of the sums is the same everywhere.
Vector2d motion_of(Band<float>& band, const Vector2d& goal_offset, double discount, bool with_bodies) {
    using L = Lanes<float>;
    Offsets<float>& own = band.own;
    const auto way_x = static_cast<float>(goal_offset.x()), way_z = static_cast<float>(goal_offset.y());
    const float square_of_way = way_x * way_x + way_z * way_z;
    const float scale = square_of_way > 0 ? 1 / std::sqrt(square_of_way) : 0;
    const float goal_x = way_x * scale, goal_z = way_z * scale;
    const auto loss = static_cast<float>(discount);
    const std::size_t n = own.count, places = L::padded(n);
    make_room(band.preference, places);
    const float* const x = own.x.data();
    const float* const z = own.z.data();
    float* const f = band.preference.data();
#pragma omp simd
    for (std::size_t i = 0; i < places; ++i) {
        const float square = x[i] * x[i] + z[i] * z[i];
        const float distance = std::sqrt(square > 1e-20F ? square : 1e-20F);
        const float ahead = distance + (goal_x * x[i] + goal_z * z[i]);
        f[i] = (ahead > 0 ? ahead : 0.0F) / (distance + distance * distance);
    }
    L::Reals sum{}, sum_x{}, sum_z{};
    const auto add = [&](std::size_t i, const L::Integers& is_own) {
        L::Reals weight = L::load(f + i);
        if (with_bodies) weight *= 1 - loss * L::load(own.contested.data() + i);
        weight = is_own ? weight : L::Reals{};
        sum += weight;
        sum_x += weight * (is_own ? L::load(x + i) : L::Reals{});
        sum_z += weight * (is_own ? L::load(z + i) : L::Reals{});
    };
    for (std::size_t i = 0; i < places; i += L::count) {
        add(i, L::number() < static_cast<std::int32_t>(n) - static_cast<std::int32_t>(i));
    }
    const float all = total(sum);
    if (!(all > 0)) return Vector2d::Zero();
    return {static_cast<double>(total(sum_x) / all), static_cast<double>(total(sum_z) / all)};
}

template <typename Real>
class BandWalk {
 public:
    BandWalk(Motion& motion, MarkerWork& work, Band<Real>& band, const Markers& markers, const Walkers& walkers,
             double radius)
        : motion_(motion),
          work_(work),
          cells_(work.cells),
          band_(band),
          markers_(markers),
          walkers_(walkers),
          radius_(radius),
          with_bodies_(!walkers.site.empty()) {}

    // The walkers whose corner cells are in the rows [first, last).
    void take(int first, int last) {
        first_ = first;
        last_ = last;
        band_.pair_tests = 0;
        if (first >= last) return;
        const int span = cells_.span;
        for (int row = first; row <= std::min(last + span - 2, cells_.grid.rows - 1); ++row) {
            deal_row(row);
            if (row - span + 1 >= first) sum_up_row(row - span + 1);
        }
        for (int row = std::max(cells_.grid.rows - span + 1, first); row < last; ++row) sum_up_row(row);
    }

 private:
    [[nodiscard]] bool nobody_reaches(int row) const {
        const GroundGrid& grid = cells_.grid;
        const std::size_t from = grid.index(0, std::max(row - cells_.span + 1, 0));
        return cells_.start[from] == cells_.start[grid.index(0, row) + static_cast<std::size_t>(grid.columns)];
    }

    void deal_row(int row) {
        Offsets<Real>& dealt = band_.rows[static_cast<std::size_t>(row % cells_.span)];
        dealt.count = 0;
        if (nobody_reaches(row)) return;
        for (int column = 0; column < cells_.grid.columns; ++column) deal_cell(dealt, column, row);
    }

    [[nodiscard]] bool nobody_reaches(int column, int row) const {
        const int first_column = std::max(column - cells_.span + 1, 0);
        for (int r = std::max(row - cells_.span + 1, 0); r <= row; ++r) {
            const std::size_t first = cells_.grid.index(first_column, r), last = cells_.grid.index(column, r);
            if (cells_.start[first] != cells_.start[last + 1]) return false;
        }
        return true;
    }

    void deal_cell(Offsets<Real>& dealt, int column, int row) {
        if (nobody_reaches(column, row)) return;
        markers_of(band_.markers, markers_, column, row);
        const std::size_t n = band_.markers.count;
        if (n == 0) return;
        Candidates<Real>& candidates = band_.candidates;
        find_candidates(candidates, cells_, with_bodies_ ? &work_.bodies : nullptr, band_.markers, column, row);
        claim(band_.claims, band_.markers, candidates, cells_, radius_);
        if (with_bodies_) find_contested(band_.claims, band_.markers, candidates, walkers_.contest_distance);
        band_.pair_tests += n * (candidates.count - 1);

        deal_markers(dealt, row);
    }

    // Sorts the markers by owner, so that each one's stand side by side, in the order of the cell.
    void deal_markers(Offsets<Real>& dealt, int row) {
        dealt.make_room_for(band_.markers.count, with_bodies_);
        if constexpr (Lanes<Real>::packs_well) {
            deal_by_packing(dealt, row);
        } else {
            deal_by_counting(dealt, row);
        }
    }

    void deal_by_packing(Offsets<Real>& dealt, int row) {
        using L = Lanes<Real>;
        const Candidates<Real>& candidates = band_.candidates;
        const auto* const owners = band_.claims.owner.data();
        const auto* const contested = with_bodies_ ? band_.claims.contested.data() : nullptr;
        const Real* const x = band_.markers.x.data();
        const Real* const z = band_.markers.z.data();
        Real* const to_x = dealt.x.data();
        Real* const to_z = dealt.z.data();
        Real* const to_contested = dealt.contested.data();
        const std::size_t n = band_.markers.count, count = candidates.count;
        auto place = static_cast<std::uint32_t>(dealt.count);
        for (std::size_t c = 1; c < count; ++c) {
            const auto whose = static_cast<typename L::Integer>(c);
            const std::uint32_t first = place;
            const Real own_x = candidates.x[c], own_z = candidates.z[c];
            for (std::size_t m = 0; m < n; m += L::count) {
                typename L::Integers owner;
                std::memcpy(&owner, owners + m, sizeof owner);
                if (contested != nullptr) pack<Real>(to_contested + place, L::load(contested + m), owner, whose);
                pack<Real>(to_x + place, L::load(x + m) - own_x, owner, whose);
                place += pack<Real>(to_z + place, L::load(z + m) - own_z, owner, whose);
            }
            note_run(candidates.entry[c], first, place, row);
        }
        dealt.count = place;
    }

    // The two halves of a cell are counted and dealt side by side, as neighbours often have one owner and its counter would
    // have to wait for itself.
    void deal_by_counting(Offsets<Real>& dealt, int row) {
        Candidates<Real>& candidates = band_.candidates;
        const std::size_t n = band_.markers.count, half = n / 2, owners = candidates.count;
        band_.next.assign(2 * owners, 0);
        std::uint32_t* const lower = band_.next.data();
        std::uint32_t* const upper = lower + owners;
        const auto* const owner = band_.claims.owner.data();
        for (std::size_t m = 0; m < half; ++m) {
            ++lower[static_cast<std::size_t>(owner[m])];
            ++upper[static_cast<std::size_t>(owner[m + half])];
        }
        if (n % 2 != 0) ++upper[static_cast<std::size_t>(owner[n - 1])];

        // Nobody's markers, those of candidate 0, go behind the others, where the next cell writes over them.
        auto place = static_cast<std::uint32_t>(dealt.count);
        for (std::size_t i = 1; i <= owners; ++i) {
            const std::size_t c = i % owners;
            const std::uint32_t first = place, in_lower = lower[c];
            place += in_lower + upper[c];
            lower[c] = first;
            upper[c] = first + in_lower;
            if (c == 0) break;
            note_run(candidates.entry[c], first, place, row);
            dealt.count = place;
        }
        candidates.x[0] = candidates.z[0] = 0;
        const auto deal = [&](std::size_t m, std::uint32_t* next) {
            const auto o = static_cast<std::size_t>(owner[m]);
            const std::uint32_t to = next[o]++;
            dealt.x[to] = band_.markers.x[m] - candidates.x[o];
            dealt.z[to] = band_.markers.z[m] - candidates.z[o];
            if (with_bodies_) dealt.contested[to] = band_.claims.contested[m];
        };
        for (std::size_t m = 0; m < half; ++m) {
            deal(m, lower);
            deal(m + half, upper);
        }
        if (n % 2 != 0) deal(n - 1, upper);
    }

    // Rows of other bands belong to other threads.
    void note_run(std::uint32_t entry, std::uint32_t first, std::uint32_t last, int row) {
        const GroundGrid& grid = cells_.grid;
        if (first == last) return;
        if (entry < cells_.start[grid.index(0, first_)] || entry >= cells_.start[grid.index(0, last_)]) return;
        work_.runs[work_.runs_an_entry * entry + work_.run_count[entry]++] = {
            first, static_cast<std::uint16_t>(last - first), static_cast<std::uint16_t>(row)};
    }

    void append_runs(std::uint32_t entry, int row) {
        Offsets<Real>& own = band_.own;
        const Offsets<Real>& dealt = band_.rows[static_cast<std::size_t>(row % cells_.span)];
        for (std::size_t i = 0; i < work_.run_count[entry]; ++i) {
            const Run& run = work_.runs[work_.runs_an_entry * entry + i];
            if (run.row != static_cast<std::uint16_t>(row)) continue;
            own.make_room_for(run.count, with_bodies_);
            for (std::size_t k = 0; k < run.count; k += Lanes<Real>::count) {
                const std::size_t to = own.count + k, from = run.begin + k;
                std::memcpy(&own.x[to], &dealt.x[from], 64);
                std::memcpy(&own.z[to], &dealt.z[from], 64);
                if (with_bodies_) std::memcpy(&own.contested[to], &dealt.contested[from], 64);
            }
            own.count += run.count;
        }
    }

    void sum_up_row(int corner_row) {
        const GroundGrid& grid = cells_.grid;
        const std::uint32_t end = cells_.start[grid.index(0, corner_row) + static_cast<std::size_t>(grid.columns)];
        for (std::uint32_t e = cells_.start[grid.index(0, corner_row)]; e < end; ++e) {
            const std::uint32_t image = cells_.image.empty() ? WalkerCells::none : cells_.image[e];
            if (image == WalkerCells::second) continue;
            band_.own.count = 0;
            for (int row = corner_row; row < std::min(corner_row + cells_.span, grid.rows); ++row) {
                append_runs(e, row);
                if (image != WalkerCells::none) append_runs(image, row);
            }
            finish(cells_.walker[e]);
        }
    }

    void finish(std::uint32_t k) {
        const std::size_t n = band_.own.count;
        motion_.owned[k] = static_cast<std::uint32_t>(n);
        const double discount = with_bodies_ ? walkers_.discount[k] : 0;
        motion_.vector[k] = n > 0 ? motion_of(band_, walkers_.goal_offset[k], discount, with_bodies_) : Vector2d(0, 0);
        if (!with_bodies_) return;
        std::uint32_t contested = 0;
        for (std::size_t i = 0; i < n; ++i) contested += band_.own.contested[i] != 0 ? 1U : 0U;
        motion_.contested[k] = contested;
    }

    Motion& motion_;
    MarkerWork& work_;
    const WalkerCells& cells_;
    Band<Real>& band_;
    const Markers& markers_;
    const Walkers& walkers_;
    double radius_;
    bool with_bodies_;
    int first_ = 0, last_ = 0;
};

void sort_bodies(WalkerBodies& bodies, const WalkerCells& cells, const Walkers& walkers) {
    const std::size_t n = cells.entries();
    for (std::vector<double>* v : {&bodies.x, &bodies.z, &bodies.vx, &bodies.vz, &bodies.slowness}) v->resize(n);
    for (std::size_t e = 0; e < n; ++e) {
        const std::uint32_t k = cells.walker[e];
        bodies.x[e] = walkers.position[k].x() + (cells.shift.empty() ? 0.0 : cells.shift[e]);
        bodies.z[e] = walkers.position[k].y();
        bodies.vx[e] = walkers.velocity[k].x();
        bodies.vz[e] = walkers.velocity[k].y();
        bodies.slowness[e] = 1 / std::max(walkers.desired_speed[k], 1e-3);
    }
}

// The first row of band b of n: the walkers are shared out evenly, by whole rows.
int first_row(const WalkerCells& cells, int b, int n) {
    if (b == n) return cells.grid.rows;
    const auto before =
        static_cast<std::uint32_t>(cells.entries() * static_cast<std::size_t>(b) / static_cast<std::size_t>(n));
    int row = 0;
    while (row < cells.grid.rows && cells.start[cells.grid.index(0, row)] < before) ++row;
    return b == 0 ? 0 : row;
}

template <typename Real>
void walk_bands(Motion& motion, MarkerWork& work, const Markers& markers, const Walkers& walkers, double radius,
                int threads) {
    std::vector<Band<Real>>& bands = bands_of<Real>(work);
    const int n = std::max(threads, 1);
    if (bands.size() < static_cast<std::size_t>(n)) bands.resize(static_cast<std::size_t>(n));
#pragma omp parallel for num_threads(n) schedule(static, 1) if (n > 1)
    for (int b = 0; b < n; ++b) {
        BandWalk<Real>(motion, work, bands[static_cast<std::size_t>(b)], markers, walkers, radius)
            .take(first_row(work.cells, b, n), first_row(work.cells, b + 1, n));
    }
    motion.pair_tests = 0;
    for (int b = 0; b < n; ++b) motion.pair_tests += bands[static_cast<std::size_t>(b)].pair_tests;
}

}  // namespace

void find_motion(Motion& motion, MarkerMemory& memory, const Markers& markers, const Walkers& walkers,
                 double perception_radius, double period, int threads) {
    MarkerWork& work = *memory;
    const std::size_t n = walkers.position.size();
    const bool with_bodies = !walkers.site.empty();
    sort_walkers(work.cells, markers.grid, with_bodies ? walkers.site : walkers.position, perception_radius, period);
    if (with_bodies) sort_bodies(work.bodies, work.cells, walkers);
    work.runs_an_entry = static_cast<std::size_t>(work.cells.span) * static_cast<std::size_t>(work.cells.span);
    make_room(work.runs, work.runs_an_entry * work.cells.entries());
    work.run_count.assign(work.cells.entries(), 0);
    motion.vector.resize(n);
    motion.owned.resize(n);
    motion.contested.resize(with_bodies ? n : 0);
    if (markers.are_drawn()) {
        walk_bands<float>(motion, work, markers, walkers, perception_radius, threads);
    } else {
        walk_bands<double>(motion, work, markers, walkers, perception_radius, threads);
    }
}

}  // namespace wade::crowd
