#include "crowd_client/markers/biocrowds.hpp"

#include <algorithm>
#include <cmath>

#include "crowd_client/markers/band_walk.hpp"
#include "crowd_client/markers/drawn_owners.hpp"
#include "crowd_client/markers/fixed_owners.hpp"

namespace wade::crowd {

struct MarkerWork {
    WalkerCells cells;
    WalkerBodies bodies;
    std::vector<FixedOwners> fixed;  // by thread
    std::vector<DrawnOwners> drawn;
};

MarkerMemory::MarkerMemory() : work_(std::make_unique<MarkerWork>()) {}
MarkerMemory::~MarkerMemory() = default;
MarkerMemory::MarkerMemory(MarkerMemory&&) noexcept = default;
MarkerMemory& MarkerMemory::operator=(MarkerMemory&&) noexcept = default;

namespace {

void sort_bodies(WalkerBodies& bodies, const WalkerCells& cells, const Walkers& walkers) {
    const std::size_t n = cells.entries();
    for (std::vector<double>* v : {&bodies.x, &bodies.z, &bodies.vx, &bodies.vz, &bodies.slowness})
        v->resize(n + beyond_fours);
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

template <typename Owners>
void walk_bands(std::vector<Owners>& owners, const Claiming& claiming, int threads) {
    const int n = std::max(threads, 1);
    if (owners.size() < static_cast<std::size_t>(n)) owners.resize(static_cast<std::size_t>(n));
#pragma omp parallel for num_threads(n) schedule(static, 1) if (n > 1)
    for (int b = 0; b < n; ++b) {
        Owners& own = owners[static_cast<std::size_t>(b)];
        own.pair_tests = 0;
        walk_band(own, claiming, {first_row(claiming.cells, b, n), first_row(claiming.cells, b + 1, n)});
    }
    claiming.motion.pair_tests = 0;
    for (int b = 0; b < n; ++b) claiming.motion.pair_tests += owners[static_cast<std::size_t>(b)].pair_tests;
}

}  // namespace

void find_motion(Motion& motion, MarkerMemory& memory, const Markers& markers, const Walkers& walkers,
                 double perception_radius, double period, int threads) {
    MarkerWork& work = *memory;
    const std::size_t n = walkers.position.size();
    const bool with_bodies = !walkers.site.empty();
    sort_walkers(work.cells, markers.grid, with_bodies ? walkers.site : walkers.position, perception_radius, period,
                 markers.drawn.moved);
    if (with_bodies) sort_bodies(work.bodies, work.cells, walkers);
    motion.vector.resize(n);
    motion.owned.resize(n);
    motion.contested.resize(with_bodies ? n : 0);
    const Claiming claiming{work.cells, with_bodies ? &work.bodies : nullptr, markers, walkers, perception_radius,
                            motion};
    if (markers.are_drawn()) {
        walk_bands(work.drawn, claiming, threads);
    } else {
        walk_bands(work.fixed, claiming, threads);
    }
}

}  // namespace wade::crowd
