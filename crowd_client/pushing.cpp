#include "crowd_client/pushing.hpp"

#include <algorithm>

#include "crowd_client/people/person.hpp"

namespace wade::crowd {

Pushing start_pushing(const Scene& scene, double spread, Agents& agents) {
    for (std::size_t id = 0; id < agents.size(); ++id) {
        const double width = body_width_share * agents.people.height[id];
        agents.people.drag[id] = drag_on_slowed_stream(body_drag, width, disc_width(scene, spread));
    }
    return {std::vector<Vector2d>(agents.size(), Vector2d::Zero()), std::vector<double>(agents.size(), 0),
            std::vector<bool>(agents.size(), false)};
}

double disc_width(const Scene& scene, double spread) {
    return disc_width_share(scene.fluid.model) * spread;
}

void shelter(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
             std::span<const Vector2d> positions, Shelters& shelters, std::vector<FeltWater>& felt) {
    shelters.stream.clear();
    shelters.drag_width.clear();
    shelters.width.clear();
    for (std::size_t k = 0; k < felt.size(); ++k) {
        const double width = body_width_share * agents.people.height[active[k]];
        shelters.stream.push_back(felt[k].velocity);
        shelters.width.push_back(width);
        shelters.drag_width.push_back(felt[k].depth > 0 ? body_drag * width : 0);
    }
    find_wakes({positions, shelters.stream, shelters.drag_width, shelters.width, scene.world.period()}, shelters.memory,
               shelters.deficit);
    const bool cells_show_wakes = scene.coupling.two_way && scene.fluid.model == ModelKind::shallow_water;
    for (std::size_t k = 0; k < felt.size(); ++k) {
        const double resolved = cells_show_wakes ? shelters.drag_width[k] / (2 * disc_width(scene, felt[k].spread)) : 0;
        felt[k].velocity *= 1 - std::max(0.0, shelters.deficit[k] - resolved);
    }
}

void push_water(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, std::span<const Vector2d> worked_out, double dt, Pushing& pushing) {
    const WaterProperties water{scene.fluid.rest_density, scene.world.gravity};
    const People& people = agents.people;
    for (std::size_t k = 0; k < active.size(); ++k) {
        const std::uint32_t id = active[k];
        const double depth = felt[k].depth;
        pushing.wet[id] = depth > 0;
        if (!(depth > 0)) continue;
        pushing.submerged[id] = std::min(depth, people.height[id]);
        if (people.by_body[id] != 0) {
            pushing.given[id] += worked_out[k];
            continue;
        }
        const PushedWater pushed{felt[k].velocity - agents.velocity[id], felt[k].weight, felt[k].theta};
        pushing.given[id] += push_of_walker(drag_upright(people.height[id], depth, water, people.drag[id]), pushed, dt);
    }
}

}  // namespace wade::crowd
