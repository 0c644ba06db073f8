// Measures of the water that cost a sweep of their own.

#include "fluid_server/dfsph/fluid_world.hpp"

namespace wade::fluid {

std::array<double, 3> FluidWorld::obstacle_force(std::size_t obstacle) const {
    std::array<double, 3> force = fluid::obstacle_force(particles_, lists_, static_cast<double>(particle_mass_),
                                                        viscosity_, static_cast<int>(obstacle));
    for (std::size_t k = 0; k < 3 && obstacle < contact_forces_.size(); ++k) {
        force[k] += contact_forces_[obstacle][k];
    }
    return force;
}

double FluidWorld::bed_pressure_force() const {
    return fluid::bed_pressure_force(particles_, lists_, static_cast<double>(particle_mass_));
}

std::uint64_t FluidWorld::pairs() const {
    std::uint64_t n = 0;
    for (std::size_t b = 0; b < block_count(lists_.count); ++b) {
        for_each_pair(lists_, b, [&](const ListedPair&) { ++n; });
    }
    return n;
}

std::uint64_t FluidWorld::list_bytes() const {
    std::uint64_t bytes = 0;
    for (const NeighbourBlock& block : lists_.blocks) {
        const auto add = [&bytes]<typename T>(const std::vector<T>& list) { bytes += list.capacity() * sizeof(T); };
        add(block.j), add(block.factor), add(block.segments), add(block.views);
        std::visit(add, block.lanes);
    }
    return bytes;
}

}  // namespace wade::fluid
