#include "fluid_server/mixed/window.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/mixed_window.hpp"
#include "configs/scene/obstacle.hpp"
#include "fluid_server/particles/filling.hpp"

namespace wade::fluid::mixed {

namespace {

// People feel the water some way off, as waves of the window's start and end are about as long as it is deep.
constexpr double margin_in_depths = 3;

std::optional<Interval> both(const std::optional<Interval>& a, const std::optional<Interval>& b) {
    if (!a || !b) return a ? a : b;
    return Interval{std::min(a->lo, b->lo), std::max(a->hi, b->hi)};
}

std::ptrdiff_t cells_down(double cells) {
    return static_cast<std::ptrdiff_t>(std::floor(cells + 1e-9));
}
std::ptrdiff_t cells_up(double cells) {
    return static_cast<std::ptrdiff_t>(std::ceil(cells - 1e-9));
}

}  // namespace

WindowRule::WindowRule(const Scene& scene, const shallow_water::Grid& grid)
    : scene_(scene),
      grid_(grid),
      guard_(guard_length(scene, grid.dx)),
      margin_(scene.fluid->mixed.margin.value_or(margin_in_depths * deepest_water(scene))),
      chunk_(std::max(1L, std::lround(scene.fluid->mixed.chunk / grid.dx))),
      ends_are_walls_(scene.channel->flow == Flow::closed) {
    const MixedWindow& keys = scene.fluid->mixed;
    std::optional<Interval> needed;
    if (keys.x_min && keys.x_max) needed = Interval{*keys.x_min, *keys.x_max};
    for (std::size_t i = 0; keys.obstacles && i < scene.obstacles.size(); ++i) {
        const Interval& x = scene.obstacles[i].x;
        needed = both(needed, Interval{x.lo - margin_, x.hi + margin_});
    }
    if (needed) {
        lasting_ =
            with_room(cells_down((needed->lo - grid.x.lo) / grid.dx), cells_up((needed->hi - grid.x.lo) / grid.dx));
    }
}

std::optional<Interval> WindowRule::needed_by(const AgentsView& agents) const {
    const Channel& channel = scene_.channel;
    std::optional<Interval> needed;
    for (std::size_t i = 0; i < agents.px.size(); ++i) {
        if (agents.state[i] != static_cast<float>(shm::agent_walking)) continue;
        const double x = static_cast<double>(agents.px[i]), z = static_cast<double>(agents.pz[i]);
        if (z < channel.z.lo - margin_ || z > channel.z.hi + margin_) continue;
        if (x < channel.x.lo - margin_ || x > channel.x.hi + margin_) continue;
        needed = both(needed, Interval{x - margin_, x + margin_});
    }
    return needed;
}

bool WindowRule::guard_meets_obstacle(double from, double to) const {
    const double d = scene_.fluid->particle_spacing;
    return std::any_of(scene_.obstacles.begin(), scene_.obstacles.end(),
                       [&](const Obstacle& o) { return o.x.lo < to + d && o.x.hi > from - d; });
}

Window WindowRule::with_room(std::ptrdiff_t begin, std::ptrdiff_t end) const {
    const auto n = static_cast<std::ptrdiff_t>(grid_.nx);
    const std::ptrdiff_t room = ends_are_walls_ ? 0 : cells_up(guard_ / grid_.dx);
    begin = std::clamp(begin, room, n - room);
    end = std::clamp(end, room, n - room);
    const auto x_of = [&](std::ptrdiff_t i) { return grid_.x.lo + static_cast<double>(i) * grid_.dx; };
    const auto wall_too_near = [&](std::ptrdiff_t cells) {
        return ends_are_walls_ && cells > 0 && static_cast<double>(cells) * grid_.dx < guard_ + grid_.dx;
    };
    while (begin > room && guard_meets_obstacle(x_of(begin) - guard_, x_of(begin))) --begin;
    while (end < n - room && guard_meets_obstacle(x_of(end), x_of(end) + guard_)) ++end;
    if (wall_too_near(begin)) begin = 0;
    if (wall_too_near(n - end)) end = n;
    if (begin >= end) return {};
    return {static_cast<std::size_t>(begin), static_cast<std::size_t>(end)};
}

Window WindowRule::next(const Window& now, const std::optional<Interval>& agents) const {
    if (!agents) return lasting_;
    const double chunk_length = static_cast<double>(chunk_) * grid_.dx;
    Window wanted = with_room(chunk_ * cells_down((agents->lo - grid_.x.lo) / chunk_length),
                              chunk_ * cells_up((agents->hi - grid_.x.lo) / chunk_length));
    if (wanted.empty()) return lasting_;
    if (!lasting_.empty()) {
        wanted = {std::min(wanted.begin, lasting_.begin), std::max(wanted.end, lasting_.end)};
    }
    if (now.empty() || now.end <= wanted.begin || now.begin >= wanted.end) return wanted;
    const auto two = static_cast<std::size_t>(2 * chunk_);
    if (now.begin < wanted.begin && wanted.begin - now.begin < two) wanted.begin = now.begin;
    if (now.end > wanted.end && now.end - wanted.end < two) wanted.end = now.end;
    return wanted;
}

}  // namespace wade::fluid::mixed
