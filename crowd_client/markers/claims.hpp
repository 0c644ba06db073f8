#pragma once
// Ownership of the markers of a cell: the walker with the nearest site, within R; ties to the one that comes first.

#include <cstdint>
#include <type_traits>
#include <vector>

#include "crowd_client/markers/marker_lanes.hpp"
#include "crowd_client/markers/walker_cells.hpp"

namespace wade::crowd {

// Data of walkers for a cell, beside their sites, if markers can be contested; by entry of WalkerCells, read by
// copy_four().
struct WalkerBodies {
    std::vector<double> x, z;      // position of the body, m
    std::vector<double> vx, vz;    // displacement of the last step / dt, m/s
    std::vector<double> slowness;  // 1 / desired speed, s/m
    double contest_distance = 0;   // D, m
};

// The walkers that reach the current cell, in the order of for_each_run() from index 1 on; index 0 means no walker.
// Coordinates as in MarkerLanes. Sites, positions and slowness are tables for look_up(), 0 at index 0.
template <typename Real>
struct Candidates {
    std::size_t count = 0;             // with index 0
    std::vector<Real> site_x, site_z;  // m

    bool with_bodies = false;
    std::vector<Real> body_x, body_z, vx, vz, slowness;  // as WalkerBodies; only with bodies

    // Positions of the walkers, m.
    [[nodiscard]] const std::vector<Real>& x() const { return with_bodies ? body_x : site_x; }
    [[nodiscard]] const std::vector<Real>& z() const { return with_bodies ? body_z : site_z; }
};

// By marker of a cell.
template <typename Real>
struct Claims {
    using Integer = typename Lanes<Real>::Integer;
    std::vector<Integer> owner;  // candidate, 0: no owner
    // With bodies only:
    std::vector<Real> contested;               // 0 or 1
    std::vector<Real> way_x, way_z, distance;  // from the owner, of way_to(), m
};

// Offset from a walker to a marker, m. The length is above 0.
template <typename Real>
struct Way {
    typename Lanes<Real>::Reals x, z, length;
};
template <typename Reals>
inline auto way_to(const Reals& x, const Reals& z, const Reals& from_x, const Reals& from_z) {
    using Real = std::remove_cvref_t<decltype(x[0])>;
    constexpr Real least = static_cast<Real>(1e-20);  // m2
    const Reals way_x = x - from_x, way_z = z - from_z;
    const Reals square = way_x * way_x + way_z * way_z;
    return Way<Real>{way_x, way_z, square_root(choose<Real>(Reals(least) < square, square, least))};
}

template <typename Real>
void find_candidates(Candidates<Real>& candidates, const WalkerCells& cells, const WalkerBodies* bodies,
                     const MarkerLanes<Real>& markers, int column, int row);

// Gives each marker to its owner.
template <typename Real>
void claim(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
           const WalkerCells& cells, int column, int row, double radius);

// Marks the owned markers that another candidate j will be within D of when the owner, walking freely, reaches them:
// |a - (p_j + v_j t)| < D with t = |a - p| / v0, p and v0 of the owner.
template <typename Real>
void find_contested(Claims<Real>& claims, const MarkerLanes<Real>& markers, const Candidates<Real>& candidates,
                    double distance);

}  // namespace wade::crowd
