// Stoker (1957): a dam breaks over a bed under water, and a shock runs ahead.

#include <cmath>
#include <limits>

#include "cases.hpp"
#include "dam_break.hpp"
#include "other_models.hpp"
#include "slice.hpp"

namespace wade::validation {

namespace {

constexpr double first_shock = 6;  // t sqrt(g/H) from which the place of the shock is compared

// Where the depth, seen from downstream, first exceeds the mean of the depths before and behind the shock, between
// columns linearly; NaN if nowhere. m downstream of the dam
double shock_place(const Columns& columns, double dam_x, double threshold) {
    double before = columns.depth(0);
    for (std::size_t k = 1; k < columns.count(); ++k) {
        const double depth = columns.depth(k);
        if (depth >= threshold && before < threshold) {
            const double part = (threshold - before) / (depth - before);
            return dam_x - (columns.centre(k - 1) + part * columns.length());
        }
        before = depth;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

Result run(const Request& request, const char* name) {
    const Scene scene = scene_for(request, name, slice_sizes(request, 2));
    refuse_other_models(scene, {FluidModel::dfsph});
    fluid::FluidWorld world(scene);
    const WaterBlock& reservoir = scene.channel.water_blocks.at(0);
    const WaterBlock& tail = scene.channel.water_blocks.at(1);
    const WetDamBreak exact = solve_wet_dam_break(reservoir.depth, tail.depth, scene.world.gravity);
    const DamBreak dam{scene, reservoir.x.lo, reservoir.depth, [&](double s, double t) { return stoker(exact, s, t); }};
    check_duration(dam, first_shock);
    Result result;
    Cost cost;
    Curve profile;
    Curve shock{"shock", {"t_s", "shock_m", "exact_shock_m"}, {}};
    double worst_shock = 0;
    const auto next_frame = [&]() -> const fluid::Particles& {
        advance_frame(world, cost);
        return world.particles();
    };
    const DamBreakErrors errors =
        run_dam_break(dam, next_frame, profile, [&](double t, double scaled, const Columns& c) {
            const double place = shock_place(c, dam.dam_x, (exact.h_middle + exact.h_right) / 2);
            const double truth = exact.shock_speed * t;
            shock.rows.push_back({t, place, truth});
            if (scaled >= first_shock) {
                const double error = std::abs(place / truth - 1);
                worst_shock = std::isnan(error) ? error : std::max(worst_shock, error);
            }
        });
    note_cost(cost, world, result);
    result.metrics = {
        {"depth_l1", errors.depth, "1"},
        {"speed_l1", errors.speed, "1"},
        {"shock_place", worst_shock, "1"},
        {"depth_l1_last", errors.last_depth, "1"},
        {"max_density_error", cost.max_density_error, "1"},
        {"position_clamps", static_cast<double>(world.position_clamps()), "1"},
    };
    result.curves = {profile, shock};
    return result;
}

Case wet_bed_case(const char* name, const char* ratio) {
    return {
        .name = name,
        .truth = std::string("Dam break over water at rest, h_r/h_l = ") + ratio +
                 ", Stoker (1957). Depth and velocity as for the dry bed; shock_place: the worst distance of the shock "
                 "from its place, of the way that it has made, t sqrt(g/H) = 6 to 8. The exact shock is a step; real "
                 "water, and these particles, make it a bore some depths long.",
        .reference = "Stoker 1957"};
}

}  // namespace

Case wet_bed_01_case() {
    Case c = wet_bed_case("wet_bed_01", "0.1 (only where h_r has four layers of particles)");
    c.spacings = {0.025};
    c.run = [](const Request& request) { return run(request, "validation/wet_bed_01.json"); };
    return c;
}

Case wet_bed_02_case() {
    Case c = wet_bed_case("wet_bed_02", "0.2");
    c.spacings = {0.1, 0.05, 0.025};
    c.quick = true;
    c.run = [](const Request& request) { return run(request, "validation/wet_bed_02.json"); };
    return c;
}

Case wet_bed_05_case() {
    Case c = wet_bed_case("wet_bed_05", "0.5");
    c.spacings = {0.1, 0.05, 0.025};
    c.quick = true;
    c.run = [](const Request& request) { return run(request, "validation/wet_bed_05.json"); };
    return c;
}

}  // namespace wade::validation
