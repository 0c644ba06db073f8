#include "crowd_client/people/push.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace wade::crowd {
namespace {

constexpr double cell = 5;              // m
constexpr double least_deficit = 1e-3;  // of a wake that is still looked for

// Beyond this a wake is less than `least_deficit` on its whole length, m.
double widest_wake(std::span<const double> drag_width) {
    double widest = 0;
    for (const double w : drag_width) widest = std::max(widest, w);
    return std::sqrt(-std::log(least_deficit) / 4.5 * widest * longest_wake);
}

// People sorted by cells of the ground that they stand on.
struct Cells {
    double x0 = 0, z0 = 0;
    std::ptrdiff_t columns = 1, rows = 1;

    [[nodiscard]] std::ptrdiff_t column(double x) const {
        return std::clamp(static_cast<std::ptrdiff_t>(std::floor((x - x0) / cell)), std::ptrdiff_t{0}, columns - 1);
    }
    [[nodiscard]] std::ptrdiff_t row(double z) const {
        return std::clamp(static_cast<std::ptrdiff_t>(std::floor((z - z0) / cell)), std::ptrdiff_t{0}, rows - 1);
    }
    [[nodiscard]] std::size_t of(const Vector2d& place) const {
        return static_cast<std::size_t>(row(place.y()) * columns + column(place.x()));
    }
};

Cells sort_people(std::span<const Vector2d> positions, WakeMemory& memory) {
    Vector2d lo = positions.front(), hi = lo;
    for (const Vector2d& p : positions) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
    Cells cells{lo.x(), lo.y(), static_cast<std::ptrdiff_t>((hi.x() - lo.x()) / cell) + 1,
                static_cast<std::ptrdiff_t>((hi.y() - lo.y()) / cell) + 1};
    memory.start.assign(static_cast<std::size_t>(cells.columns * cells.rows) + 1, 0);
    for (const Vector2d& p : positions) ++memory.start[cells.of(p) + 1];
    std::partial_sum(memory.start.begin(), memory.start.end(), memory.start.begin());
    std::vector<std::uint32_t> next(memory.start.begin(), memory.start.end() - 1);
    memory.order.resize(positions.size());
    for (std::uint32_t k = 0; k < positions.size(); ++k) memory.order[next[cells.of(positions[k])]++] = k;
    return cells;
}

}  // namespace

double disc_width_share(ModelKind model) {
    return model == ModelKind::shallow_water ? 1.5 : 2.05;
}

double drag_on_slowed_stream(double drag, double body_width, double disc_width) {
    constexpr double largest_thrust = 0.8;  // beyond it the stream no longer follows momentum theory
    const double thrust = std::min(largest_thrust, drag * body_width / disc_width);
    const double root = 1 + std::sqrt(1 - thrust);
    return drag * 4 / (root * root);
}

double largest_push(const PushedWater& water) {
    if (!(water.weight > 0)) return 0;
    return 0.5 * std::sqrt(water.relative.squaredNorm()) * water.weight / water.theta;
}

Vector2d push_of_walker(double k, const PushedWater& water, double dt) {
    const double speed = std::sqrt(water.relative.squaredNorm());
    if (!(speed > 0)) return Vector2d::Zero();
    return std::min(k * speed * speed * dt, largest_push(water)) / speed * water.relative;
}

Vector2d push_of_carried(double k, double mass, const PushedWater& water, double dt) {
    const double speed = std::sqrt(water.relative.squaredNorm());
    if (!(speed > 0) || !(water.weight > 0)) return Vector2d::Zero();
    const double ease = water.theta / water.weight + 1 / mass;
    const double rest = speed / (1 + k * ease * speed * dt);
    return (speed - rest) / ease / speed * water.relative;
}

double wake_deficit(double drag_width, double width, double along, double across) {
    if (!(along > width / 2) || along > longest_wake || !(drag_width > 0)) return 0;
    const double spread = drag_width * along;
    return std::min(1.0, std::sqrt(drag_width / along)) * std::exp(-4.5 * across * across / spread);
}

void find_wakes(const WakeMakers& makers, WakeMemory& memory, std::vector<double>& deficit) {
    const std::size_t n = makers.positions.size();
    deficit.assign(n, 0);
    if (n < 2) return;
    const Cells cells = sort_people(makers.positions, memory);
    const double margin = widest_wake(makers.drag_width);
    for (std::size_t k = 0; k < n; ++k) {
        const double speed = std::sqrt(makers.stream[k].squaredNorm());
        if (!(speed > 0)) continue;
        const Vector2d down = makers.stream[k] / speed;  // the wakes in which k may stand lie along its own stream
        const Vector2d far = makers.positions[k] - longest_wake * down;
        const auto look_from = [&](double shift) {
            const Vector2d here = makers.positions[k] + Vector2d(shift, 0), there = far + Vector2d(shift, 0);
            const Vector2d lo = here.cwiseMin(there), hi = here.cwiseMax(there);
            for (std::ptrdiff_t r = cells.row(lo.y() - margin); r <= cells.row(hi.y() + margin); ++r) {
                const std::ptrdiff_t row = r * cells.columns;
                const auto first = static_cast<std::size_t>(row + cells.column(lo.x() - margin));
                const auto last = static_cast<std::size_t>(row + cells.column(hi.x() + margin));
                for (std::size_t i = memory.start[first]; i < memory.start[last + 1]; ++i) {
                    const std::uint32_t who = memory.order[i];
                    const Vector2d offset = here - makers.positions[who];
                    const double along = offset.dot(down), across = offset.y() * down.x() - offset.x() * down.y();
                    deficit[k] =
                        std::max(deficit[k], wake_deficit(makers.drag_width[who], makers.width[who], along, across));
                }
            }
        };
        look_from(0);
        if (makers.period > 0) look_from(makers.period), look_from(-makers.period);
    }
}

}  // namespace wade::crowd
