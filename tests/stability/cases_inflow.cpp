// Water that comes in, goes out, or comes back.

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "stability_case.hpp"
#include "water_run.hpp"

namespace wade::stability {

namespace {

using fluid::FluidWorld;
using fluid::Kind;
using fluid::Particles;
using fluid::StepReport;

// Returns the displacement of the inflow until t, m: the integral of v_F, linear between the points of its history.
double inflow_way(const Channel& channel, double t) {
    const std::vector<VelocityPoint>& history = channel.velocity_history;
    if (history.empty()) return channel.velocity * t;
    double way = history.front().velocity * std::min(t, history.front().time);
    for (std::size_t k = 1; k < history.size(); ++k) {
        const VelocityPoint& a = history[k - 1];
        const VelocityPoint& b = history[k];
        const double end = std::min(t, b.time);
        if (end <= a.time || b.time <= a.time) continue;
        const double v_end = a.velocity + (b.velocity - a.velocity) * (end - a.time) / (b.time - a.time);
        way += 0.5 * (a.velocity + v_end) * (end - a.time);
    }
    return way + history.back().velocity * std::max(0.0, t - history.back().time);
}

// The water that has come in is that of the history within one layer; at the start and at the end of the pause the
// particles are finite and the channel holds.
Result emitter_history(const Request& request) {
    const Scene scene = scene_for(request, "emitter_history", {"/channel/z_max_m=0.4"});
    const double layer = scene.channel->depth * scene.channel->z.length() * scene.fluid->particle_spacing;  // m3
    const double d3 = std::pow(scene.fluid->particle_spacing, 3);
    double worst = 0;
    Hooks hooks;
    hooks.after_frame = [&](const FluidWorld& world, double t, Result&) {
        const Particles& p = world.particles();
        const auto in_channel = static_cast<double>(
            std::count(p.kind.begin(), p.kind.begin() + static_cast<std::ptrdiff_t>(p.count), Kind::fluid));
        const double volume = (in_channel + static_cast<double>(world.emitter().recycled)) * d3;
        const double due = inflow_way(scene.channel, t) * scene.channel->depth * scene.channel->z.length();
        worst = std::max(worst, std::abs(volume - due) / layer);
    };
    Result result = run_water(scene, hooks);
    check_at_most(result, "inflow_error_in_layers", worst, 1.01);
    return result;
}

// No speed but the mean is put in, so velocity fluctuations must die out. 5 % of v_F: a quarter of the turbulence of a
// natural river at its bed, and what a tile of the river may deviate by.
Result recirculating_quiet(const Request& request) {
    const Scene scene = scene_for(request, "recirculating_quiet", {"/duration_s=10"});
    double noise = 0;
    double late = 0;
    Hooks hooks;
    hooks.after_frame = [&](const FluidWorld& world, double t, Result&) {
        if (t < 0.5 * scene.duration) return;
        const Particles& p = world.particles();
        double mean = 0;
        double squares = 0;
        for (std::size_t i = 0; i < p.count; ++i) mean += static_cast<double>(p.vx[i]) / static_cast<double>(p.count);
        for (std::size_t i = 0; i < p.count; ++i) {
            squares += std::pow(static_cast<double>(p.vx[i]) - mean, 2) + std::pow(static_cast<double>(p.vy[i]), 2) +
                       std::pow(static_cast<double>(p.vz[i]), 2);
        }
        const double now = std::sqrt(squares / static_cast<double>(p.count)) / scene.channel->velocity;
        noise = std::max(noise, now);
        late = now;
    };
    Result result = run_water(scene, hooks);
    check_at_most(result, "noise_over_velocity", noise, 0.05);
    note(result, "noise_at_the_end", late);
    return result;
}

// The water in the quarter next to the outlet starts with twice v_F in the wrong direction.
Result backflow(const Request& request) {
    const Scene scene = scene_for(request, "backflow", {"/duration_s=1.5", "/channel/x_max_m=3"});
    const double x = scene.channel->x.lo + 0.25 * scene.channel->x.length();
    Hooks hooks;
    hooks.start = [&](FluidWorld& world) {
        const double v = scene.channel->velocity;
        world.set_velocity([&](const std::array<double, 3>& place) -> std::array<double, 3> {
            return {place[0] < x ? 2 * v : -v, 0, 0};
        });
    };
    return run_water(scene, hooks);
}

// Behind the opening whole layers wait, one pitch apart, deep enough for the support of the last particle in front.
Result rows_behind_inlet(const Request& request) {
    const Scene scene = scene_for(request, "rows_behind_inlet", {"/duration_s=1"});
    const double d = scene.fluid->particle_spacing;
    const double reach = support_radius_of(scene.fluid);
    double widest_gap = 0;    // pitches
    double shallowest = 1e9;  // m
    double uneven = 0;
    // A row of n particles of volume d^3 fills the opening over this length.
    const auto pitch_of = [&](std::size_t in_row) {
        return static_cast<double>(in_row) * d * d * d / (scene.channel->depth * scene.channel->z.length());
    };
    Hooks hooks;
    hooks.after_step = [&](const FluidWorld& world, const StepReport&, Result&) {
        const Particles& p = world.particles();
        std::vector<double> rows;
        for (std::size_t i = 0; i < p.count; ++i) {
            if (p.kind[i] == Kind::inflow) rows.push_back(static_cast<double>(p.x[i]));
        }
        std::sort(rows.begin(), rows.end());
        if (rows.empty()) return;
        double behind = scene.channel->x.hi;
        std::size_t in_row = 0;
        std::size_t first_row = 0;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            ++in_row;
            if (k + 1 < rows.size() && rows[k + 1] - rows[k] < 0.1 * d) continue;
            widest_gap = std::max(widest_gap, (rows[k] - behind) / pitch_of(in_row));
            behind = rows[k];
            first_row = first_row == 0 ? in_row : first_row;
            uneven = std::max(uneven, std::abs(static_cast<double>(in_row) - static_cast<double>(first_row)));
            in_row = 0;
        }
        shallowest = std::min(shallowest, rows.back() + 0.5 * pitch_of(first_row) - scene.channel->x.hi);
    };
    Result result = run_water(scene, hooks);
    check_at_most(result, "widest_gap_over_pitch", widest_gap, 1.02);
    check_at_most(result, "missing_in_a_row", uneven, 0);
    check_at_least(result, "waiting_over_support_radius", shallowest / reach, 1);
    return result;
}

}  // namespace

std::vector<Case> inflow_cases() {
    return {
        {"emitter_history",
         "an emitter cannot change its velocity, stop or restart from zero (SPlisHSPlasH #309, #369)", emitter_history},
        {"recirculating_quiet", "a re-circulating inflow turns to noise (SPlisHSPlasH #83)", recirculating_quiet},
        {"backflow", "backflow at the outlet crashes (TrixiParticles #1221)", backflow},
        {"rows_behind_inlet", "a row of particles is missing behind the inlet (TrixiParticles #827)",
         rows_behind_inlet},
    };
}

}  // namespace wade::stability
