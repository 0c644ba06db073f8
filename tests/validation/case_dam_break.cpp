// Ritter (1892): a dam breaks over a dry, smooth bed.

#include <cmath>

#include "cases.hpp"
#include "dam_break.hpp"
#include "other_models.hpp"
#include "slice.hpp"

namespace wade::validation {

namespace {

// next_frame: of the water of the scene. Metrics that every model has.
Result run(const Scene& scene, const NextFrame& next_frame) {
    const WaterBlock& reservoir = scene.channel.water_blocks.at(0);
    const double g = scene.world.gravity;
    const DamBreak dam{scene, reservoir.x.lo, reservoir.depth,
                       [&](double s, double t) { return ritter(s, t, reservoir.depth, g); }};
    Result result;
    Curve profile;
    Curve tip{"tip", {"t_s", "tip_m", "exact_tip_m"}, {}};
    const fluid::Particles* particles = nullptr;
    const NextFrame watched = [&]() -> const fluid::Particles& {
        particles = &next_frame();
        return *particles;
    };
    const DamBreakErrors errors = run_dam_break(dam, watched, profile, [&](double t, double, const Columns&) {
        const double reached = reservoir.x.lo - leading_x(*particles, reservoir.x.hi);
        tip.rows.push_back({t, reached, 2 * std::sqrt(g * reservoir.depth) * t});
    });
    result.metrics = {{"depth_l1", errors.depth, "1"},
                      {"speed_l1", errors.speed, "1"},
                      {"depth_l1_last", errors.last_depth, "1"},
                      {"tip_lag", 1 - tip.rows.back()[1] / tip.rows.back()[2], "1"}};
    result.curves = {profile, tip};
    return result;
}

Result run(const Request& request) {
    const Scene scene = scene_for(request, "validation/dam_break.json", slice_sizes(request, 1));
    refuse_other_models(scene, {FluidModel::dfsph, FluidModel::steering});
    Cost cost;
    if (scene.fluid.model == FluidModel::steering) {
        fluid::steering::SteeringWorld world(scene);
        Result result = run(scene, [&]() -> const fluid::Particles& {
            advance_frame(world, cost);
            return world.particles();
        });
        note_cost(cost, world, result);
        result.metrics.push_back({"position_clamps", static_cast<double>(world.position_clamps()), "1"});
        return result;
    }
    fluid::FluidWorld world(scene);
    Result result = run(scene, [&]() -> const fluid::Particles& {
        advance_frame(world, cost);
        return world.particles();
    });
    note_cost(cost, world, result);
    result.metrics.push_back({"max_density_error", cost.max_density_error, "1"});
    result.metrics.push_back({"position_clamps", static_cast<double>(world.position_clamps()), "1"});
    return result;
}

}  // namespace

Case dam_break_case() {
    return {
        .name = "dam_break",
        .truth =
            "Dam break over a dry bed without friction, Ritter (1892). The worst frame of t sqrt(g/H) = 4 to 8: L1 of "
            "the depth over H and of the mean velocity over sqrt(g H), by columns of H/5, where the exact depth is "
            "above 0.15 H. tip_lag: how far the foremost particle is behind Ritter's front, of the way that the "
            "front has made.",
        .reference = "Ritter 1892",
        .spacings = {0.1, 0.05, 0.025},
        .quick = true,
        .run = run};
}

}  // namespace wade::validation
