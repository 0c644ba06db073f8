// Overlap removal: start positions of agents with bodies before their first step.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "crowd_client/bodies/bodies.hpp"
#include "crowd_client/bodies/obstacles_near.hpp"

namespace wade::crowd {
namespace {

// Returns the displacement that moves body k out of other bodies and obstacles. Calls meet(j) for each body that is too
// close, and counts obstacles that are too close.
template <typename Meet>
Vector2d push_of(const BodyCells& cells, const Walls& walls, const std::vector<Vector2d>& places, std::size_t k,
                 double radius, std::size_t& walls_met, const Meet& meet) {
    const double apart = 2 * radius + 2 * body_slack;
    Vector2d push = Vector2d::Zero();
    cells.visit_near(places[k], apart, [&](std::uint32_t j, double dx, double dz) {
        const double square = dx * dx + dz * dz;
        if (j == k || square >= apart * apart) return;
        meet(j);
        const double d = std::sqrt(square);
        // Bodies at the same position part along x, by index.
        const Vector2d n = d > 1e-9 ? Vector2d(dx / d, dz / d) : Vector2d(k < j ? 1 : -1, 0);
        push -= (0.5 * (apart - d) + body_slack) * n;
    });
    for_each_within(walls, places[k], radius + 2 * body_slack, [&](const Vector2d& way, double d) {
        ++walls_met;
        push -= (radius + 3 * body_slack - d) * (way / d);
    });
    return push;
}

Vector2d put_in_world(Vector2d p, const World& world) {
    p.y() = std::clamp(p.y(), 0.0, world.width);
    if (const double period = world.period(); period > 0) {
        p.x() -= period * std::floor(p.x() / period);
        if (p.x() >= period) p.x() = 0;
    } else {
        p.x() = std::clamp(p.x(), 0.0, world.length);
    }
    return p;
}

// Bodies that may overlap: all at first, then the bodies that overlapped in the turn before and the neighbours they
// meet.
class Crowded {
 public:
    explicit Crowded(std::size_t count) : listed_(count, true), list_(count) {
        std::iota(list_.begin(), list_.end(), 0U);
    }

    // The list may grow by add() during the loop over it.
    [[nodiscard]] const std::vector<std::uint32_t>& list() const { return list_; }
    void add(std::uint32_t k) {
        if (listed_[k]) return;
        listed_[k] = true;
        list_.push_back(k);
    }
    void keep(const std::vector<std::uint32_t>& only) {
        for (const std::uint32_t k : list_) listed_[k] = false;
        for (const std::uint32_t k : only) listed_[k] = true;
        list_ = only;
    }

 private:
    std::vector<bool> listed_;
    std::vector<std::uint32_t> list_;
};

}  // namespace

void make_room_for_bodies(Agents& agents, const Walls& walls, double radius) {
    constexpr int most_turns = 5000;
    // Limit on bodies visited plus a tenth of the bodies sorted [A]: about 4 s. Up to 3,600 people without room get all
    // turns.
    constexpr std::size_t most_work = 20'000'000;
    const std::size_t count = agents.size();
    BodyCells cells;
    Crowded crowded(count);
    std::vector<Vector2d> places = agents.position, pushes(count, Vector2d::Zero());
    std::vector<std::uint32_t> close;
    std::size_t work = 0;
    for (int turn = 0; turn == 0 || (!close.empty() && turn < most_turns && work < most_work); ++turn) {
        sort_people(cells, walls.world, places, 2 * radius + 1e-2);
        close.clear();
        for (std::size_t n = 0; n < crowded.list().size(); ++n) {
            const std::uint32_t k = crowded.list()[n];
            std::size_t met = 0;
            pushes[k] = push_of(cells, walls, places, k, radius, met, [&](std::uint32_t j) {
                ++met;
                crowded.add(j);
            });
            if (met > 0) close.push_back(k);
        }
        work += crowded.list().size() + count / 10;
        if (turn == 0) {
            for (std::size_t k = 0; k < count; ++k) places[k] = put_in_world(places[k] + pushes[k], walls.world);
        } else {
            for (const std::uint32_t k : close) places[k] = put_in_world(places[k] + pushes[k], walls.world);
        }
        crowded.keep(close);
    }
    if (close.empty()) {
        agents.position = places;
        return;
    }
    const std::size_t worst = *std::ranges::max_element(close);
    std::ostringstream message;
    message << "/crowd/groups/" << agents.group[worst] << "/start: bodies of radius " << radius
            << " m (/crowd/body_radius_m) find no room near (" << agents.position[worst].x() << ", "
            << agents.position[worst].y() << ") m, where agent " << worst
            << " starts; allowed: fewer agents, a larger pitch or a smaller radius";
    throw ConfigurationError(message.str());
}

}  // namespace wade::crowd
