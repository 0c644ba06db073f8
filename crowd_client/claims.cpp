#include "crowd_client/claims.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace wade::crowd {
namespace {

// The owner of one marker where two walkers are equally near: the first in the walkers' list. In the same arithmetic as
// the lanes.
template <typename Real>
std::size_t nearest_by_order(const Candidates<Real>& candidates, const WalkerCells& cells, Real x, Real z, Real limit) {
    std::size_t owner = 0;
    Real best = limit;
    for (std::size_t c = 1; c < candidates.count; ++c) {
        const Real dx = x - candidates.site_x[c];
        const Real dz = z - candidates.site_z[c];
        const Real distance = dx * dx + dz * dz;
        if (distance > best) continue;
        const bool ties = distance == best && owner != 0;
        if (ties && cells.walker[candidates.entry[c]] >= cells.walker[candidates.entry[owner]]) continue;
        owner = c;
        best = distance;
    }
    return owner;
}

// Room for `count` candidates in tables, 0 for nobody.
template <typename Real>
void begin_tables(std::initializer_list<std::vector<Real>*> tables, std::size_t count) {
    for (std::vector<Real>* table : tables) {
        make_table(*table, count);
        (*table)[0] = 0;
    }
}

// What the entries [first, last) have, from a place of a table on, counted from an origin.
template <typename Real>
void copy_run(std::vector<Real>& table, std::size_t place, const std::vector<double>& entries, std::uint32_t first,
              std::uint32_t last, double origin) {
    Real* const to = table.data() + place;
    const double* const from = entries.data() + first;
    for (std::uint32_t k = 0; k < last - first; ++k) to[k] = static_cast<Real>(from[k] - origin);
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
    make_room(c.entry, c.count);
    begin_tables({&c.site_x, &c.site_z}, c.count);
    if (c.with_bodies) begin_tables({&c.body_x, &c.body_z, &c.vx, &c.vz, &c.slowness}, c.count);
    for_each_run(cells, column, row, [&](int, std::uint32_t first, std::uint32_t last, std::size_t before) {
        const std::size_t place = 1 + before;
        for (std::uint32_t e = first; e < last; ++e) c.entry[place + e - first] = e;
        copy_run(c.site_x, place, cells.x, first, last, markers.origin_x);
        copy_run(c.site_z, place, cells.z, first, last, markers.origin_z);
        if (bodies == nullptr) return;
        copy_run(c.body_x, place, bodies->x, first, last, markers.origin_x);
        copy_run(c.body_z, place, bodies->z, first, last, markers.origin_z);
        copy_run(c.vx, place, bodies->vx, first, last, 0);
        copy_run(c.vz, place, bodies->vz, first, last, 0);
        copy_run(c.slowness, place, bodies->slowness, first, last, 0);
    });
}

template <typename Real>
void claim(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
           const WalkerCells& cells, double radius) {
    using L = Lanes<Real>;
    using Reals = typename L::Reals;
    using Integers = typename L::Integers;
    using Integer = typename L::Integer;
    const std::size_t places = L::padded(markers.count);
    make_room(claims.owner, places);
    const auto limit = static_cast<Real>(radius * radius);
    const Real above_limit = std::nextafter(limit, 2 * limit);  // a marker at R is claimed
    Integers ties{};
    for (std::size_t m = 0; m < places; m += L::count) {
        const Reals x = L::load(markers.x.data() + m);
        const Reals z = L::load(markers.z.data() + m);
        Reals best = above_limit;
        Integers owner{};
        for (std::size_t c = 1; c < candidates.count; ++c) {
            const Reals dx = x - candidates.site_x[c];
            const Reals dz = z - candidates.site_z[c];
            const Reals distance = dx * dx + dz * dz;
            const Integers nearer = distance < best;
            ties |= distance == best;
            owner = choose<Integer>(nearer, static_cast<Integer>(c), owner);
            best = choose(nearer, distance, best);
        }
        L::store(claims.owner.data() + m, owner);
    }
    Integer any = 0;
    for (std::size_t lane = 0; lane < L::count; ++lane) any |= ties[lane];
    if (any == 0) return;
    for (std::size_t m = 0; m < markers.count; ++m) {
        claims.owner[m] = static_cast<Integer>(nearest_by_order(candidates, cells, markers.x[m], markers.z[m], limit));
    }
}

template <typename Real>
void find_contested(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
                    double distance) {
    using L = Lanes<Real>;
    using Reals = typename L::Reals;
    using Integers = typename L::Integers;
    using Integer = typename L::Integer;
    const std::size_t places = L::padded(markers.count);
    make_room(claims.contested, places);
    const auto limit = static_cast<Real>(distance * distance);
    for (std::size_t m = 0; m < places; m += L::count) {
        const Reals x = L::load(markers.x.data() + m);
        const Reals z = L::load(markers.z.data() + m);
        const Integers owner = L::load(claims.owner.data() + m);
        const Reals own_x = x - look_up(candidates.body_x, candidates.count, owner);
        const Reals own_z = z - look_up(candidates.body_z, candidates.count, owner);
        // Until the owner is there, s.
        const Reals time =
            square_root(own_x * own_x + own_z * own_z) * look_up(candidates.slowness, candidates.count, owner);
        Integers contested{};
        for (std::size_t c = 1; c < candidates.count; ++c) {
            const Reals dx = x - (candidates.body_x[c] + candidates.vx[c] * time);
            const Reals dz = z - (candidates.body_z[c] + candidates.vz[c] * time);
            const Integers close = dx * dx + dz * dz < limit;
            contested |= close & (owner != static_cast<Integer>(c));
        }
        L::store(claims.contested.data() + m, choose<Real>(contested, 1, 0));
    }
}

template void find_candidates(Candidates<double>&, const WalkerCells&, const WalkerBodies*, const MarkerLanes<double>&,
                              int, int);
template void find_candidates(Candidates<float>&, const WalkerCells&, const WalkerBodies*, const MarkerLanes<float>&,
                              int, int);
template void claim(Claims<double>&, const MarkerLanes<double>&, const Candidates<double>&, const WalkerCells&, double);
template void claim(Claims<float>&, const MarkerLanes<float>&, const Candidates<float>&, const WalkerCells&, double);
template void find_contested(Claims<double>&, const MarkerLanes<double>&, const Candidates<double>&, double);
template void find_contested(Claims<float>&, const MarkerLanes<float>&, const Candidates<float>&, double);

}  // namespace wade::crowd
