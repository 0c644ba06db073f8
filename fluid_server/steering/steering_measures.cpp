// What is measured of a steering water, pair by pair: the slow way through the lists.

#include <algorithm>
#include <cmath>

#include "fluid_server/steering/steering_world.hpp"

namespace wade::fluid::steering {

template <typename OnPair>
void SteeringWorld::for_each_neighbour(OnPair&& on_pair) const {
    const Particles& p = particles_;
    for (std::size_t b = 0; b < block_count(lists_.count); ++b) {
        const NeighbourBlock& block = lists_.blocks[b];
        for (std::size_t c = 0; c < lists_.clusters_per_block(); ++c) {
            const std::size_t begin = b * block_size + c * lists_.cluster_size;
            for_each_segment(block, c, [&](const NeighbourBlock::View& view, std::size_t first, std::size_t last) {
                for (std::size_t i = begin; i < std::min(begin + lists_.cluster_size, lists_.count); ++i) {
                    for (std::size_t k = first; k < last; ++k) {
                        const std::size_t j = block.j[k];
                        const double dx = static_cast<double>(p.x[i] + view.map.shift[0] - p.x[j]);
                        const double dy = static_cast<double>(p.y[i] + view.map.shift[1] - p.y[j]);
                        const double dz = static_cast<double>(p.z[i] + view.map.shift[2] - p.z[j]);
                        const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
                        if (r > 0 && r < settings_.reach) on_pair(i, j, r);
                    }
                }
            });
        }
    }
}

double SteeringWorld::neighbours() const {
    std::uint64_t n = 0;
    for_each_neighbour([&](std::size_t, std::size_t, double) { ++n; });
    return static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(particles_.count, 1));
}

Energies SteeringWorld::energies() const {
    const Particles& p = particles_;
    Energies e;
    for (std::size_t i = 0; i < p.count; ++i) {
        const auto x = static_cast<double>(p.vx[i]), y = static_cast<double>(p.vy[i]), z = static_cast<double>(p.vz[i]);
        e.walls += particle_mass_ * walls_.energy({p.x[i], p.y[i], p.z[i]});
        e.kinetic += 0.5 * mass(i) * (x * x + y * y + z * z);
        e.gravity -= mass(i) * (gravity_y_ * static_cast<double>(p.y[i]) + gravity_x_ * static_cast<double>(p.x[i]));
    }
    // The work of the pair forces from r to the end of their reach; each pair is met twice.
    const Settings& s = settings_;
    const auto pull = static_cast<double>(s.pull), growth = static_cast<double>(s.pull_growth);
    const auto outer = static_cast<double>(s.cohesion_radius);
    for_each_neighbour([&](std::size_t i, std::size_t j, double r) {
        const double mean = 0.5 * static_cast<double>(radius_factors(p)[i] + radius_factors(p)[j]);
        const double radius = mean * static_cast<double>(s.separation_radius);
        double work = static_cast<double>(s.separation) * push_work(radius, r);
        const double from = std::max(r, mean * static_cast<double>(s.no_pull_within));
        if (from < outer) work -= pull * (outer - from) + growth * (std::pow(outer, 3) - std::pow(from, 3)) / 3;
        e.pairs += 0.5 * particle_mass_ * work;
    });
    return e;
}

}  // namespace wade::fluid::steering
