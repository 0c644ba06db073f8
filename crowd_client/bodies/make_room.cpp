// Where people with bodies stand before their first step.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/bodies/bodies.hpp"
#include "crowd_client/bodies/obstacles_near.hpp"

namespace wade::crowd {
namespace {

// What moves one body out of the others and out of obstacles; counts those it is too close to.
Vector2d push_of(const BodyCells& cells, const Walls& walls, const std::vector<Vector2d>& places, std::size_t k,
                 double radius, std::size_t& too_close) {
    const double apart = 2 * radius + 2 * body_slack;
    Vector2d push = Vector2d::Zero();
    cells.visit_near(places[k], apart, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= apart * apart) return;
        ++too_close;
        const double d = std::sqrt(square);
        // Who stands in one place is parted along x, by number.
        const Vector2d n = d > 1e-9 ? Vector2d(dx / d, dz / d) : Vector2d(k < j ? 1 : -1, 0);
        push -= (0.5 * (apart - d) + body_slack) * n;
    });
    for_each_within(walls, places[k], radius + 2 * body_slack, [&](const Vector2d& way, double d) {
        ++too_close;
        push -= (radius + 3 * body_slack - d) * (way / d);
    });
    return push;
}

}  // namespace

void make_room_for_bodies(Agents& agents, const Walls& walls, double radius) {
    constexpr int most_turns = 5000;
    BodyCells cells;
    std::vector<Vector2d> places = agents.position, pushes(places.size());
    std::size_t too_close = 1, worst = 0;
    for (int turn = 0; turn < most_turns && too_close > 0; ++turn) {
        sort_people(cells, walls.world, places, 2 * radius + 1e-2);
        too_close = 0;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const std::size_t before = too_close;
            pushes[k] = push_of(cells, walls, places, k, radius, too_close);
            if (too_close > before) worst = k;
        }
        for (std::size_t k = 0; k < places.size(); ++k) {
            Vector2d& p = places[k];
            p += pushes[k];
            p.y() = std::clamp(p.y(), 0.0, walls.world.width);
            if (const double period = walls.world.period(); period > 0) {
                p.x() -= period * std::floor(p.x() / period);
                if (p.x() >= period) p.x() = 0;
            } else {
                p.x() = std::clamp(p.x(), 0.0, walls.world.length);
            }
        }
    }
    if (too_close == 0) {
        agents.position = places;
        return;
    }
    std::ostringstream message;
    message << "/crowd/groups/" << agents.group[worst] << "/start: bodies of radius " << radius
            << " m (/crowd/body_radius_m) find no room near (" << agents.position[worst].x() << ", "
            << agents.position[worst].y() << ") m, where agent " << worst
            << " starts; allowed: fewer agents, a larger pitch or a smaller radius";
    throw ConfigurationError(message.str());
}

}  // namespace wade::crowd
