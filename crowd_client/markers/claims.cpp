#include "crowd_client/markers/claims.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace wade::crowd {
namespace {

// The owner of one marker where two walkers are equally near: the first in the walkers' list. In the same arithmetic as
// the lanes.
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

// Room for `count` candidates in tables, 0 for nobody.
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
        const std::size_t place = 1 + before, n = last - first;
        const auto copy = [&](std::vector<Real>& table, const std::vector<double>& entries, double origin) {
            copy_in_fours(table.data() + place, entries.data() + first, n, origin);
        };
        copy(c.site_x, cells.x, markers.origin_x);
        copy(c.site_z, cells.z, markers.origin_z);
        if (bodies == nullptr) return;
        copy(c.body_x, bodies->x, markers.origin_x);
        copy(c.body_z, bodies->z, markers.origin_z);
        copy(c.vx, bodies->vx, 0);
        copy(c.vz, bodies->vz, 0);
        copy(c.slowness, bodies->slowness, 0);
    });
}

template <typename Real>
void claim(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
           const WalkerCells& cells, int column, int row, double radius) {
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
    if (any != 0) claim_by_order(claims, markers, candidates, cells, column, row, limit);
}

template <typename Real>
void find_contested(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
                    double distance) {
    using L = Lanes<Real>;
    using Reals = typename L::Reals;
    using Integers = typename L::Integers;
    const std::size_t places = L::padded(markers.count);
    make_room(claims.contested, places);
    const auto limit = static_cast<Real>(distance * distance);
    const auto of_owner = [&](const std::vector<Real>& table, const Integers& owner) {
        return look_up(table, candidates.count, owner);
    };
    for (std::size_t m = 0; m < places; m += L::count) {
        const Reals x = L::load(markers.x.data() + m);
        const Reals z = L::load(markers.z.data() + m);
        const Integers owner = L::load(claims.owner.data() + m);
        const Reals own_x = of_owner(candidates.body_x, owner), own_z = of_owner(candidates.body_z, owner);
        const Reals way_x = x - own_x, way_z = z - own_z;
        // Until the owner is there, s.
        const Reals time = square_root(way_x * way_x + way_z * way_z) * of_owner(candidates.slowness, owner);
        const auto close = [&](const Reals& at_x, const Reals& at_z, const Reals& vx, const Reals& vz) -> Integers {
            const Reals dx = x - (at_x + vx * time);
            const Reals dz = z - (at_z + vz * time);
            return dx * dx + dz * dz < limit;
        };
        Integers all{};  // minus how many will be close, with the owner
        for (std::size_t c = 1; c < candidates.count; ++c) {
            all += close(candidates.body_x[c], candidates.body_z[c], candidates.vx[c], candidates.vz[c]);
        }
        const Integers own = close(own_x, own_z, of_owner(candidates.vx, owner), of_owner(candidates.vz, owner));
        L::store(claims.contested.data() + m, choose<Real>(all != own, 1, 0));
    }
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
