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

namespace {

CellWater water_of_column(const WaterBins& bins, const Vector2d& agent, double rest_density) {
    const Vector2d half = 0.5 * bins.column;
    CellWater water;
    for_each_column_near(bins, agent, half.minCoeff(), [&](std::size_t k) {
        const bool holds = std::abs(bins.x[k] - agent.x()) <= half.x() && std::abs(bins.z[k] - agent.y()) <= half.y();
        if (!holds) return;
        const WaterParticle p = bins.particle(k);
        water = {p.mass / (rest_density * bins.column.x() * bins.column.y()), std::sqrt(p.velocity.squaredNorm())};
    });
    return water;
}

}  // namespace

double share_in_disc(const WaterBins& bins, const Rectangle& column, double distance) {
    return disc_over(column) * distance * distance / (bins.column.x() * bins.column.y());
}

Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                     std::vector<WaterParticle>& touching) {
    touching.clear();
    if (bins.has_columns()) {
        for_each_column_near(bins, agent, distance, [&](std::size_t k) {
            WaterParticle part = bins.particle(k);
            part.mass *= share_in_disc(bins, column_seen_from(bins, k, agent, distance), distance);
            if (part.mass > 0) touching.push_back(part);
        });
    } else {
        for_each_particle_near(bins, agent, distance, [&](std::size_t k) { touching.push_back(bins.particle(k)); });
    }
    return contact_momentum(touching);
}

TouchingMean mean_of_touching(const WaterBins& bins, const Vector2d& agent, double distance) {
    assert(bins.with_heights);
    TouchingMean mean;
    const auto add = [&](std::size_t k) {
        ++mean.count;
        mean.height += bins.y[k];
        const Vector2d velocity = bins.particle(k).velocity;
        mean.velocity[0] += velocity.x();
        mean.velocity[1] += bins.vy[k];
        mean.velocity[2] += velocity.y();
    };
    if (bins.has_columns()) {
        for_each_column_near(bins, agent, distance, [&](std::size_t k) {
            if (share_in_disc(bins, column_seen_from(bins, k, agent, distance), distance) > 0) add(k);
        });
    } else {
        for_each_particle_near(bins, agent, distance, add);
    }
    if (mean.count == 0) return mean;
    const double n = static_cast<double>(mean.count);
    mean.height /= n;
    for (double& v : mean.velocity) v /= n;
    return mean;
}

CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density) {
    if (bins.has_columns()) return water_of_column(bins, agent, rest_density);
    const std::size_t cell = bins.grid.cell_of(agent.x(), agent.y());
    const Contact all = bins.use[cell] == WaterBins::summed ? bins.sums[cell] : sum_of_cell(bins, cell);
    if (!(all.mass > 0)) return {};
    constexpr double cell_area = GroundGrid::cell_size * GroundGrid::cell_size;
    return {all.mass / (rest_density * cell_area), std::sqrt(all.momentum.squaredNorm()) / all.mass};
}

}  // namespace wade::crowd
