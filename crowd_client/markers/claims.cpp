#include "crowd_client/markers/claims.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

namespace wade::crowd {
namespace {

// Returns the owner of one marker at equal distance to two walkers: the first in the walkers' list. Uses the same
// arithmetic as the lanes.
template <typename Real>
std::size_t nearest_by_order(const Candidates<Real>& candidates, const std::vector<std::uint32_t>& walkers, Real x,
                             Real z, Real limit) {
    std::size_t owner = 0;
    Real best = limit;
    for (std::size_t c = 1; c < candidates.count; ++c) {
        const Real dx = x - candidates.site_x[c];
        const Real dz = z - candidates.site_z[c];
        const Real distance = dx * dx + dz * dz;
        if (distance > best) continue;
        if (distance == best && owner != 0 && walkers[c] >= walkers[owner]) continue;
        owner = c;
        best = distance;
    }
    return owner;
}

template <typename Real>
void claim_by_order(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
                    const WalkerCells& cells, int column, int row, Real limit) {
    std::vector<std::uint32_t> walkers(candidates.count);
    for_each_run(cells, column, row, [&](int, std::uint32_t first, std::uint32_t last, std::size_t before) {
        std::copy(cells.walker.data() + first, cells.walker.data() + last, walkers.data() + 1 + before);
    });
    for (std::size_t m = 0; m < markers.count; ++m) {
        const std::size_t owner = nearest_by_order(candidates, walkers, markers.x[m], markers.z[m], limit);
        claims.owner[m] = static_cast<typename Lanes<Real>::Integer>(owner);
    }
}

// Makes room for `count` candidates in tables, with 0 at index 0.
template <typename Real>
void begin_tables(std::initializer_list<std::vector<Real>*> tables, std::size_t count) {
    for (std::vector<Real>* table : tables) {
        make_table(*table, count + beyond_fours);
        (*table)[0] = 0;
    }
}

}  // namespace

template <typename Real>
void find_candidates(Candidates<Real>& candidates, const WalkerCells& cells, const WalkerBodies* bodies,
                     const MarkerLanes<Real>& markers, int column, int row) {
    Candidates<Real>& c = candidates;
    c.count = 1;
    for_each_run(cells, column, row,
                 [&](int, std::uint32_t first, std::uint32_t last, std::size_t) { c.count += last - first; });
    c.with_bodies = bodies != nullptr;
    begin_tables({&c.site_x, &c.site_z}, c.count);
    if (c.with_bodies) begin_tables({&c.body_x, &c.body_z, &c.vx, &c.vz, &c.slowness}, c.count);
    for_each_run(cells, column, row, [&](int, std::uint32_t first, std::uint32_t last, std::size_t before) {
        // One loop fills all tables: a loop for each would end at a branch that is hard to predict.
        for (std::size_t from = first, to = 1 + before; from < last; from += 4, to += 4) {
            const auto copy = [&](std::vector<Real>& table, const std::vector<double>& entries, double origin) {
                copy_four(table.data() + to, entries.data() + from, origin);
            };
            copy(c.site_x, cells.x, markers.origin_x);
            copy(c.site_z, cells.z, markers.origin_z);
            if (bodies == nullptr) continue;
            copy(c.body_x, bodies->x, markers.origin_x);
            copy(c.body_z, bodies->z, markers.origin_z);
            copy(c.vx, bodies->vx, 0);
            copy(c.vz, bodies->vz, 0);
            copy(c.slowness, bodies->slowness, 0);
        }
    });
}

namespace {

// Number of marker vectors that loops over candidates process at once: as many as there are registers for. A short loop
// for each vector would end at a branch that is hard to predict.
constexpr std::size_t vectors_at_once = register_bytes == 64 ? 4 : 1;

// Calls many(m) for each block of vectors_at_once vectors of markers from index m on, then one(m) for each vector left.
template <typename Real, typename Many, typename One>
void for_each_block(std::size_t markers, Many&& many, One&& one) {
    using L = Lanes<Real>;
    const std::size_t places = L::padded(markers);
    std::size_t m = 0;
    for (; m + vectors_at_once * L::count <= places; m += vectors_at_once * L::count) many(m);
    for (; m < places; m += L::count) one(m);
}

template <std::size_t vectors, typename Real>
void claim_block(std::size_t first, Claims<Real>& claims, const MarkerLanes<Real>& markers,
                 const Candidates<Real>& candidates, Real above_limit, typename Lanes<Real>::Integers& ties) {
    using L = Lanes<Real>;
    using Reals = typename L::Reals;
    using Integers = typename L::Integers;
    using Integer = typename L::Integer;
    std::array<Reals, vectors> x, z, best;
    std::array<Integers, vectors> owner;
#pragma GCC unroll 4
    for (std::size_t v = 0; v < vectors; ++v) {
        x[v] = L::load(markers.x.data() + first + v * L::count);
        z[v] = L::load(markers.z.data() + first + v * L::count);
        best[v] = above_limit;
        owner[v] = Integers(0);
    }
    Integers equal = ties;
    for (std::size_t c = 1; c < candidates.count; ++c) {
        const Reals site_x = candidates.site_x[c], site_z = candidates.site_z[c];
        const Integers number = static_cast<Integer>(c);
#pragma GCC unroll 4
        for (std::size_t v = 0; v < vectors; ++v) {
            const Reals dx = x[v] - site_x, dz = z[v] - site_z;
            const Reals distance = dx * dx + dz * dz;
            const Integers nearer = distance < best[v];
            equal |= distance == best[v];
            owner[v] = choose<Integer>(nearer, number, owner[v]);
            best[v] = choose(nearer, distance, best[v]);
        }
    }
    ties = equal;
#pragma GCC unroll 4
    for (std::size_t v = 0; v < vectors; ++v) L::store(claims.owner.data() + first + v * L::count, owner[v]);
}

template <std::size_t vectors, typename Real>
void find_contested_block(std::size_t first, Claims<Real>& claims, const MarkerLanes<Real>& markers,
                          const Candidates<Real>& candidates, Real limit) {
    using L = Lanes<Real>;
    using Reals = typename L::Reals;
    using Integers = typename L::Integers;
    const auto of_owner = [&](const std::vector<Real>& table, const Integers& owner) {
        return look_up(table, candidates.count, owner);
    };
    std::array<Reals, vectors> x, z, time;  // until the owner is at the marker, s
    std::array<Integers, vectors> all;      // minus the number of walkers that will be close, without the owner
    const auto close = [&](std::size_t v, const Reals& at_x, const Reals& at_z, const Reals& vx,
                           const Reals& vz) -> Integers {
        const Reals dx = x[v] - (at_x + vx * time[v]);
        const Reals dz = z[v] - (at_z + vz * time[v]);
        return dx * dx + dz * dz < limit;
    };
#pragma GCC unroll 4
    for (std::size_t v = 0; v < vectors; ++v) {
        x[v] = L::load(markers.x.data() + first + v * L::count);
        z[v] = L::load(markers.z.data() + first + v * L::count);
        const Integers owner = L::load(claims.owner.data() + first + v * L::count);
        const Reals own_x = of_owner(candidates.body_x, owner), own_z = of_owner(candidates.body_z, owner);
        const Way<Real> way = way_to(x[v], z[v], own_x, own_z);
        L::store(claims.way_x.data() + first + v * L::count, way.x);
        L::store(claims.way_z.data() + first + v * L::count, way.z);
        L::store(claims.distance.data() + first + v * L::count, way.length);
        time[v] = way.length * of_owner(candidates.slowness, owner);
        all[v] = Integers(0) - close(v, own_x, own_z, of_owner(candidates.vx, owner), of_owner(candidates.vz, owner));
    }
    for (std::size_t c = 1; c < candidates.count; ++c) {
        const Reals at_x = candidates.body_x[c], at_z = candidates.body_z[c];
        const Reals vx = candidates.vx[c], vz = candidates.vz[c];
#pragma GCC unroll 4
        for (std::size_t v = 0; v < vectors; ++v) all[v] += close(v, at_x, at_z, vx, vz);
    }
#pragma GCC unroll 4
    for (std::size_t v = 0; v < vectors; ++v) {
        const Reals contested = choose<Real>(all[v] != Integers(0), 1, 0);
        L::store(claims.contested.data() + first + v * L::count, contested);
    }
}

}  // namespace

template <typename Real>
void claim(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
           const WalkerCells& cells, int column, int row, double radius) {
    using L = Lanes<Real>;
    make_room(claims.owner, L::padded(markers.count));
    const auto limit = static_cast<Real>(radius * radius);
    const Real above_limit = std::nextafter(limit, 2 * limit);  // a marker at R is claimed
    typename L::Integers ties(0);
    for_each_block<Real>(
        markers.count,
        [&](std::size_t m) { claim_block<vectors_at_once>(m, claims, markers, candidates, above_limit, ties); },
        [&](std::size_t m) { claim_block<1>(m, claims, markers, candidates, above_limit, ties); });
    typename L::Integer any = 0;
    for (std::size_t lane = 0; lane < L::count; ++lane) any |= ties[lane];
    if (any != 0) claim_by_order(claims, markers, candidates, cells, column, row, limit);
}

template <typename Real>
void find_contested(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
                    double distance) {
    for (std::vector<Real>* v : {&claims.contested, &claims.way_x, &claims.way_z, &claims.distance}) {
        make_room(*v, Lanes<Real>::padded(markers.count));
    }
    const auto limit = static_cast<Real>(distance * distance);
    for_each_block<Real>(
        markers.count,
        [&](std::size_t m) { find_contested_block<vectors_at_once>(m, claims, markers, candidates, limit); },
        [&](std::size_t m) { find_contested_block<1>(m, claims, markers, candidates, limit); });
}

template void find_candidates(Candidates<double>&, const WalkerCells&, const WalkerBodies*, const MarkerLanes<double>&,
                              int, int);
template void find_candidates(Candidates<float>&, const WalkerCells&, const WalkerBodies*, const MarkerLanes<float>&,
                              int, int);
template void claim(Claims<double>&, const MarkerLanes<double>&, const Candidates<double>&, const WalkerCells&, int,
                    int, double);
template void claim(Claims<float>&, const MarkerLanes<float>&, const Candidates<float>&, const WalkerCells&, int, int,
                    double);
template void find_contested(Claims<double>&, const MarkerLanes<double>&, const Candidates<double>&, double);
template void find_contested(Claims<float>&, const MarkerLanes<float>&, const Candidates<float>&, double);

}  // namespace wade::crowd
