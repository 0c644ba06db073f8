#include "crowd_client/claims.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

template <typename Real>
void find_candidates(Candidates<Real>& candidates, const WalkerCells& cells, const WalkerBodies* bodies,
                     const MarkerLanes<Real>& markers, int column, int row) {
    std::size_t n = 1;
    for (std::vector<Real>* v : {&candidates.x, &candidates.z, &candidates.slowness}) {
        make_table(*v, n);
        (*v)[0] = 0;
    }
    const int first_column = std::max(column - cells.span + 1, 0);
    for (int r = std::max(row - cells.span + 1, 0); r <= row; ++r) {
        const std::uint32_t first = cells.start[cells.grid.index(first_column, r)];
        const std::uint32_t last = cells.start[cells.grid.index(column, r) + 1];
        const std::size_t count = last - first;
        make_room(candidates.entry, n + count);
        for (std::vector<Real>* v : {&candidates.site_x, &candidates.site_z}) make_room(*v, n + count);
        for (std::vector<Real>* v : {&candidates.x, &candidates.z}) make_table(*v, n + count);
        for (std::size_t i = 0; i < count; ++i) {
            candidates.entry[n + i] = first + static_cast<std::uint32_t>(i);
            candidates.x[n + i] = candidates.site_x[n + i] = static_cast<Real>(cells.x[first + i] - markers.origin_x);
            candidates.z[n + i] = candidates.site_z[n + i] = static_cast<Real>(cells.z[first + i] - markers.origin_z);
        }
        if (bodies != nullptr) {
            for (std::vector<Real>* v : {&candidates.vx, &candidates.vz}) make_room(*v, n + count);
            make_table(candidates.slowness, n + count);
            for (std::size_t i = 0; i < count; ++i) {
                candidates.x[n + i] = static_cast<Real>(bodies->x[first + i] - markers.origin_x);
                candidates.z[n + i] = static_cast<Real>(bodies->z[first + i] - markers.origin_z);
                candidates.vx[n + i] = static_cast<Real>(bodies->vx[first + i]);
                candidates.vz[n + i] = static_cast<Real>(bodies->vz[first + i]);
                candidates.slowness[n + i] = static_cast<Real>(bodies->slowness[first + i]);
            }
        }
        n += count;
    }
    candidates.count = n;
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
        const Reals own_x = x - look_up(candidates.x, candidates.count, owner);
        const Reals own_z = z - look_up(candidates.z, candidates.count, owner);
        // Until the owner is there, s.
        const Reals time =
            square_root(own_x * own_x + own_z * own_z) * look_up(candidates.slowness, candidates.count, owner);
        Integers contested{};
        for (std::size_t c = 1; c < candidates.count; ++c) {
            const Reals dx = x - (candidates.x[c] + candidates.vx[c] * time);
            const Reals dz = z - (candidates.z[c] + candidates.vz[c] * time);
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
