#include "crowd_client/responses/sampled_coupling.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/near_water.hpp"

namespace wade::crowd {

Sampling sampling_of(const Scene& scene) {
    constexpr double rounding = 1e-9;  // of rates that divide one another
    const double samples = scene.coupling->sampling_rate / scene.crowd->step_rate;
    const bool given = scene.fluid->model == ModelKind::kinematic;
    return {std::max(1, static_cast<int>(std::ceil(samples - rounding))),
            given ? scene.fluid->kinematic.transport_factor : 1};
}

Contact contact_after(const WaterBins& bins, const World& world, const Vector2d& place, double distance, double time,
                      double transport) {
    const Vector2d at(std::clamp(place.x(), 0.0, world.length), std::clamp(place.y(), 0.0, world.width));
    const int column = GroundGrid::line_of(at.x()), row = GroundGrid::line_of(at.y());
    const double ahead = transport * time;
    Contact sum;
    for (int r = row - 1; r <= row + 1; ++r) {
        const std::size_t first = bins.cell_start[bins.grid.index(column - 1, r)];
        const std::size_t end = bins.cell_start[bins.grid.index(column + 1, r) + 1];
        for (std::size_t k = first; k < end; ++k) {
            WaterParticle particle = bins.particle(k);
            const Vector2d moved = ahead * particle.velocity, offset = Vector2d(bins.x[k], bins.z[k]) + moved - at;
            if (bins.has_columns()) {
                particle.mass *= share_in_disc(bins, column_seen_from(bins, k, at - moved, distance), distance);
                if (!(particle.mass > 0)) continue;
            } else if (!(offset.squaredNorm() < distance * distance)) {
                continue;
            }
            sum.mass += particle.mass;
            sum.momentum += particle.mass * particle.velocity;
        }
    }
    return sum;
}

RelaxedVelocity sampled_velocity(const WaterBins& bins, const Scene& scene, const Sampling& sampling,
                                 const Walker& walker, double dt) {
    const double distance = contact_distance(scene.coupling);
    const double part = dt / sampling.samples;
    Vector2d way = Vector2d::Zero(), velocity = walker.velocity;
    for (int i = 0; i < sampling.samples; ++i) {
        const Contact water =
            contact_after(bins, scene.world, walker.position + way, distance, i * part, sampling.transport);
        const RelaxedVelocity relaxed =
            relaxed_velocity(walker.mass, velocity, walker.walking, walker.tau, water, part);
        way += relaxed.mean * part;
        velocity = relaxed.at_end;
    }
    return {way / dt, velocity};
}

}  // namespace wade::crowd
