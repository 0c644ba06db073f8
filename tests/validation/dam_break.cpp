#include "dam_break.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/world.hpp"

namespace wade::validation {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double first_compared = 4;  // t sqrt(g/H)
constexpr double shallowest = 0.15;   // of H: below it the sheet is thinner than the particles can show

}  // namespace

void check_duration(const DamBreak& dam, double first) {
    const Scene& scene = dam.scene;
    const double seconds = first * std::sqrt(dam.depth / scene.world->gravity);
    const double needed = std::ceil(seconds * scene.frame_rate - 1e-9) / scene.frame_rate;
    if (frames_in(scene, scene.duration) >= needed * scene.frame_rate) return;
    char text[120];
    std::snprintf(text, sizeof text, ": nothing was compared: /duration_s is %g, at least %.4g is needed",
                  scene.duration, needed);
    throw ConfigurationError(scene.name + text);
}

DamBreakErrors run_dam_break(const DamBreak& dam, Water& water, Cost& cost, Curve& last, const OnFrame& on_frame) {
    const Scene& scene = dam.scene;
    const double g = scene.world->gravity;
    const double wave = std::sqrt(g * dam.depth);
    const int frames = frames_in(scene, scene.duration);
    check_duration(dam, first_compared);
    DamBreakErrors errors;
    last = {"profile", {"s_m", "depth_m", "exact_depth_m", "velocity_m_s", "exact_velocity_m_s"}, {}};
    for (int f = 1; f <= frames; ++f) {
        water.advance(cost);
        const double t = f / scene.frame_rate;
        const double scaled = t * std::sqrt(g / dam.depth);
        if (scaled < first_compared || scaled > 8) {
            continue;
        }
        Columns columns = make_columns(scene.channel->x, scene.channel->z.length(), dam.depth / 5);
        water.add_to(columns);
        double depth_error = 0;
        double speed_error = 0;
        int compared = 0;
        last.rows.clear();
        for (std::size_t k = 0; k < columns.count(); ++k) {
            const double s = dam.dam_x - columns.centre(k);
            const FlowState exact = dam.exact(s, t);
            const double shown = columns.volume[k] > 0 ? -columns.velocity(k) : nothing;
            last.rows.push_back({s, columns.depth(k), exact.depth, shown, exact.depth > 0 ? exact.velocity : nothing});
            if (exact.depth > shallowest * dam.depth) {
                depth_error += std::abs(columns.depth(k) - exact.depth) / dam.depth;
                speed_error += std::abs(-columns.velocity(k) - exact.velocity) / wave;
                ++compared;
            }
        }
        std::reverse(last.rows.begin(), last.rows.end());
        errors.last_depth = depth_error / compared;
        errors.depth = std::max(errors.depth, errors.last_depth);
        errors.speed = std::max(errors.speed, speed_error / compared);
        on_frame(t, scaled, columns);
    }
    return errors;
}

}  // namespace wade::validation
