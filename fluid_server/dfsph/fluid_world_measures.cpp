// Measures of the water that cost a sweep of their own.

#include "fluid_server/dfsph/fluid_world.hpp"

namespace wade::fluid {

double bed_pressure_force(const Particles& p, const NeighbourLists& lists, double particle_mass) {
    BlockSums<double> forces;
    forces.begin(lists.count);
    for_each_block(lists.count, [&](std::size_t, std::size_t, std::size_t b) {
        for_each_pair(lists, b, [&](const ListedPair& pair) {
            if (!pair.in_ground() || p.kind[pair.i] == Kind::inflow) {
                return;
            }
            const float gy = pair.felt()[1];
            forces[b] -= static_cast<double>((p.pressure[pair.i] + p.pressure[pair.j]) * gy) * particle_mass;
        });
    });
    return forces.total([](double& sum, double force) { sum += force; });
}

namespace {

// Water slips along walls of a site: what it pushes against its images is along their normals, once both of a pair are counted.
void add_force_on_house(const Particles& p, const ListedPair& pair, double particle_mass, double viscosity,
                        std::array<double, 3>& force) {
    if (p.kind[pair.i] == Kind::inflow) return;
    const Vec3 felt = pair.felt();
    const Vec3 image = pair.turned->map.turn.back({p.vx[pair.j], p.vy[pair.j], p.vz[pair.j]});
    const Vec3 own{p.vx[pair.i], p.vy[pair.i], p.vz[pair.i]};
    for (std::size_t a = 0; a < 3; ++a) {
        force[a] += static_cast<double>((p.pressure[pair.i] + p.pressure[pair.j]) * felt[a]) * particle_mass;
        force[a] -= 2 * viscosity * static_cast<double>((own[a] - image[a]) * pair.factor) * particle_mass;
    }
}

}  // namespace

std::array<double, 3> obstacle_force(const Particles& p, const NeighbourLists& lists, double particle_mass,
                                     double viscosity, int obstacle) {
    BlockSums<std::array<double, 3>> forces;
    forces.begin(lists.count);
    for_each_block(lists.count, [&](std::size_t, std::size_t, std::size_t b) {
        std::array<double, 3>& force = forces[b];
        for_each_pair(lists, b, [&](const ListedPair& pair) {
            const NeighbourBlock::View& face = pair.view;
            if (pair.turned != nullptr) {
                if (pair.turned->house == obstacle) add_force_on_house(p, pair, particle_mass, viscosity, force);
                return;
            }
            if (face.obstacle != obstacle || p.kind[pair.i] == Kind::inflow) {
                return;
            }
            // The face pushes along its normal; along itself it holds only water that sticks to it.
            const auto normal = static_cast<std::size_t>(face.obstacle_axis);
            const float g = face.map.rotation(pair.gradient)[normal];
            force[normal] += static_cast<double>((p.pressure[pair.i] + p.pressure[pair.j]) * g) * particle_mass;
            const Vec3 own{p.vx[pair.i], p.vy[pair.i], p.vz[pair.i]};
            const Vec3 image = face.viscous.map({p.vx[pair.j], p.vy[pair.j], p.vz[pair.j]});
            for (std::size_t a = 0; a < 3; ++a) {
                const float slip = own[a] - (image[a] + face.viscous.shift[a]);
                force[a] -= 2 * viscosity * static_cast<double>(slip * pair.factor) * particle_mass;
            }
        });
    });
    return forces.total([](std::array<double, 3>& sum, const std::array<double, 3>& force) {
        for (std::size_t a = 0; a < 3; ++a) {
            sum[a] += force[a];
        }
    });
}

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
        add(block.j), add(block.factor), add(block.segments), add(block.views), add(block.turned);
        std::visit(add, block.lanes);
    }
    return bytes;
}

}  // namespace wade::fluid
