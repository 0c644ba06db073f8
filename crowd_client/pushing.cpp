#include "crowd_client/pushing.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/coupling.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/people/person.hpp"

namespace wade::crowd {

namespace {

void note_disc(const Scene& scene, double radius, const Stream& stream, People& people, std::size_t id) {
    people.disc_width[id] = disc_width_share(scene.fluid->model, stream) * radius;
    people.drag[id] = drag_on_slowed_stream(body_drag, body_width_share * people.height[id], people.disc_width[id]);
}

}  // namespace

Pushing start_pushing(const Scene& scene, const Feeling& feeling, Agents& agents) {
    const Stream usual{1, 1, scene.world->gravity};  // until the agent has been in water
    for (std::size_t id = 0; id < agents.size(); ++id) note_disc(scene, feeling.disc_radius, usual, agents.people, id);
    return {std::vector<Vector2d>(agents.size(), Vector2d::Zero()), std::vector<double>(agents.size(), 0),
            std::vector<bool>(agents.size(), false)};
}

void note_discs(const Scene& scene, const Feeling& feeling, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, Agents& agents) {
    for (std::size_t k = 0; k < active.size(); ++k) {
        if (!(felt[k].depth > 0)) continue;
        const Stream stream{std::sqrt(felt[k].velocity.squaredNorm()), felt[k].depth, scene.world->gravity};
        note_disc(scene, feeling.disc_radius, stream, agents.people, active[k]);
    }
}

void find_wakes(const World& world, const WakeMakers& makers, BodyCells& cells, std::vector<double>& deficit) {
    const std::size_t n = makers.positions.size();
    deficit.assign(n, 0);
    if (n < 2) return;
    const double margin = widest_wake(*std::max_element(makers.drag_width.begin(), makers.drag_width.end()));
    sort_people(cells, world, makers.positions, longest_wake + margin);
    for (std::size_t k = 0; k < n; ++k) {
        const double speed = std::sqrt(makers.stream[k].squaredNorm());
        if (!(speed > 0)) continue;
        const Vector2d down = makers.stream[k] / speed;  // wakes that reach k lie along its own stream
        const auto range = [&](double furthest) {
            return Interval{std::min(0.0, furthest) - margin, std::max(0.0, furthest) + margin};
        };
        cells.visit_box(makers.positions[k], range(-longest_wake * down.x()), range(-longest_wake * down.y()),
                        [&](std::uint32_t who, double dx, double dz) {
                            const double along = -dx * down.x() - dz * down.y();
                            const double across = dx * down.y() - dz * down.x();
                            const double one = wake_deficit(makers.drag_width[who], makers.width[who], along, across);
                            deficit[k] = std::max(deficit[k], one);
                        });
    }
}

void shelter(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
             std::span<const Vector2d> positions, Shelters& shelters, std::vector<FeltWater>& felt) {
    shelters.stream.clear();
    shelters.passing.clear();
    shelters.drag_width.clear();
    shelters.width.clear();
    for (std::size_t k = 0; k < felt.size(); ++k) {
        const double width = body_width_share * agents.people.height[active[k]];
        shelters.stream.push_back(felt[k].velocity);
        shelters.passing.push_back(felt[k].velocity - agents.velocity[active[k]]);
        shelters.width.push_back(width);
        shelters.drag_width.push_back(felt[k].depth > 0 ? body_drag * width : 0);
    }
    find_wakes(scene.world, {positions, shelters.stream, shelters.drag_width, shelters.width}, shelters.cells,
               shelters.deficit);
    find_wakes(scene.world, {positions, shelters.passing, shelters.drag_width, shelters.width}, shelters.cells,
               shelters.lee);
    const bool cells_show_wakes = scene.coupling->two_way && scene.fluid->model == ModelKind::shallow_water;
    for (std::size_t k = 0; k < felt.size(); ++k) {
        const double disc = agents.people.disc_width[active[k]];
        const double resolved = cells_show_wakes ? shelters.drag_width[k] / (2 * disc) : 0;
        felt[k].velocity *= 1 - std::max(0.0, shelters.deficit[k] - resolved);
        shelters.lee[k] = std::max(0.0, shelters.lee[k] - resolved);
    }
}

void push_water(const Scene& scene, const Agents& agents, std::span<const std::uint32_t> active,
                std::span<const FeltWater> felt, std::span<const Vector2d> worked_out, double dt, Pushing& pushing) {
    const WaterProperties water{scene.fluid->rest_density, scene.world->gravity};
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
