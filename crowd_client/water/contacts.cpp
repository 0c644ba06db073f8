#include "crowd_client/water/contacts.hpp"

#include <cassert>
#include <cmath>

#include "configs/scene/coupling.hpp"
#include "crowd_client/water/near_water.hpp"

namespace wade::crowd {

double contact_distance(const Coupling& coupling) {
    return coupling.contact_rule == ContactRule::sum ? coupling.agent_radius + coupling.particle_radius
                                                     : std::abs(coupling.agent_radius - coupling.particle_radius);
}

Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                     std::vector<WaterParticle>& touching) {
    touching.clear();
    for_each_particle_near(bins, agent, distance, [&](std::size_t k) { touching.push_back(bins.particle(k)); });
    return contact_momentum(touching);
}

TouchingMean mean_of_touching(const WaterBins& bins, const Vector2d& agent, double distance) {
    assert(bins.with_heights);
    TouchingMean mean;
    for_each_particle_near(bins, agent, distance, [&](std::size_t k) {
        ++mean.count;
        mean.height += bins.y[k];
        const Vector2d velocity = bins.particle(k).velocity;
        mean.velocity[0] += velocity.x();
        mean.velocity[1] += bins.vy[k];
        mean.velocity[2] += velocity.y();
    });
    if (mean.count == 0) return mean;
    const double n = static_cast<double>(mean.count);
    mean.height /= n;
    for (double& v : mean.velocity) v /= n;
    return mean;
}

CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density) {
    const std::size_t cell = bins.grid.cell_of(agent.x(), agent.y());
    const Contact all = bins.use[cell] == WaterBins::summed ? bins.sums[cell] : sum_of_cell(bins, cell);
    if (!(all.mass > 0)) return {};
    constexpr double cell_area = GroundGrid::cell_size * GroundGrid::cell_size;
    return {all.mass / (rest_density * cell_area), std::sqrt(all.momentum.squaredNorm()) / all.mass};
}

}  // namespace wade::crowd
