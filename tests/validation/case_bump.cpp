// Steady flow over a bump: subcritical, transcritical, and with a jump on the lee side.

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cases.hpp"
#include "channel_run.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/interval.hpp"
#include "open_channel.hpp"
#include "slice.hpp"

namespace wade::validation {

namespace {

constexpr double column_spacings = 2;  // length of a column, spacings: the support radius
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The water flows towards -x, and s counts downstream: s = origin - x.
using DepthOfPlace = std::function<double(double x)>;

DepthOfPlace depth_over(const BumpFlow& flow, double origin) {
    return [flow, origin](double x) { return flow.depth(origin - x); };
}

// Gives each particle the velocity that the exact flow has at its position, so that less has to settle.
void start_as(Water& water, const BumpFlow& flow, double origin) {
    water.set_velocity([&](const std::array<double, 3>& place) {
        return std::array<double, 3>{-flow.q / flow.depth(origin - place[0]), 0, 0};
    });
}

Curve profile(const Columns& columns, double origin, const DepthOfPlace& exact) {
    Curve depth{"depth", {"s_m", "surface_m", "exact_surface_m", "bed_m"}, {}};
    for (std::size_t k = columns.count(); k-- > 0;) {
        const double x = columns.centre(k);
        const double bed = bump_height(origin - x);
        depth.rows.push_back({origin - x, columns.depth(k) + bed, exact(x) + bed, bed});
    }
    return depth;
}

Curve discharge_curve(const Columns& columns, double origin, double q) {
    Curve curve{"discharge", {"s_m", "discharge_m2_s", "exact_discharge_m2_s"}, {}};
    for (std::size_t k = columns.count(); k-- > 0;) {
        curve.rows.push_back({origin - columns.centre(k), discharge(columns, k), q});
    }
    return curve;
}

// Returns what all three cases report. `compared`: the range of x that the ends of the channel do not influence.
Result result_of(const Water& water, const Columns& columns, const Cost& cost, const Interval& compared, double origin,
                 double q, const DepthOfPlace& exact) {
    Result result;
    water.note(cost, result);
    result.metrics = {{"depth_l2", depth_error(columns, compared, exact), "1"},
                      {"discharge_variation", discharge_variation(columns, compared), "1"},
                      {"discharge", std::abs(mean_discharge(columns, compared) / q - 1), "1"},
                      {"max_density_error", cost.max_density_error, "1"}};
    result.curves = {profile(columns, origin, exact), discharge_curve(columns, origin, q)};
    return result;
}

// The channel is a loop: the bulk speed times the mean depth is q exactly, and the mean depth is that of the exact flow.
Result run_subcritical(const Request& request) {
    constexpr double origin = 25;  // m, as in SWASHES; also the length of the loop
    constexpr double q = 4.42;
    const BumpFlow flow = subcritical_bump_flow(q, 2, standard_gravity);
    double mean_depth_exact = 0;
    constexpr int points = 10000;
    for (int i = 0; i < points; ++i) {
        mean_depth_exact += flow.depth((i + 0.5) * origin / points) / points;
    }
    std::vector<std::string> sizes = channel_slice(request);
    sizes.push_back(assign("/channel/depth_m", mean_surface(flow, 0, origin)));
    sizes.push_back(assign("/channel/velocity_m_s", q / mean_depth_exact));
    const Scene scene = scene_for(request, "validation/bump_subcritical.json", sizes);
    const std::unique_ptr<Water> water = make_water(scene);
    start_as(*water, flow, origin);
    Cost cost;
    // A long wave needs 3.8 s downstream and 11.2 s upstream round the loop: the mean is over a whole turn of the slow one.
    const Columns columns =
        average_columns(*water, scene.duration - 11.2, scene.duration, column_spacings * request.spacing, cost);
    // The columns at the joint miss what the particles beyond it would add to them.
    const Interval compared{columns.length(), origin - columns.length()};
    return result_of(*water, columns, cost, compared, origin, q, depth_over(flow, origin));
}

// The emitter gives q; the depth upstream follows from the critical flow over the crest.
Result run_transcritical(const Request& request) {
    constexpr double origin =
        16;  // m: the channel is 12 m of SWASHES' 25 m, s from 4 to 16 m; the rest is uniform flow
    constexpr double q = 1.53;
    const BumpFlow flow = transcritical_bump_flow(q, standard_gravity);
    std::vector<std::string> sizes = channel_slice(request);
    sizes.push_back(assign("/channel/depth_m", flow.depth(0)));
    sizes.push_back(assign("/channel/velocity_m_s", q / flow.depth(0)));
    const Scene scene = scene_for(request, "validation/bump_transcritical.json", sizes);
    const std::unique_ptr<Water> water = make_water(scene);
    Cost cost;
    const Columns columns =
        average_columns(*water, 0.5 * scene.duration, scene.duration, column_spacings * request.spacing, cost);
    const Interval compared{scene.channel->x.lo + 1, scene.channel->x.hi - 1};
    Result result = result_of(*water, columns, cost, compared, origin, q, depth_over(flow, origin));
    const CurvedBumpFlow curved = curved_transcritical_bump_flow(q, standard_gravity);
    const auto curved_depth = [&](double x) { return curved.depth(origin - x); };
    result.metrics.push_back({"depth_l2_curved", depth_error(columns, compared, curved_depth), "1"});
    result.metrics.push_back({"missed_layers", water->missed_layers(), "1"});
    Curve& surface = result.curves.front();
    surface.columns.emplace_back("exact_curved_surface_m");
    for (auto& row : surface.rows) {
        row.push_back(curved.depth(row[0]) + bump_height(row[0]));
    }
    return result;
}

// Returns the position s of the jump, m: where the depth, followed downstream from the crest, first exceeds the mean of
// the supercritical and the subcritical depth there. NaN if it does not.
double jump_place(const Columns& columns, double origin, const BumpFlow& flow) {
    const auto surplus = [&](std::size_t k) {
        const double z = bump_height(origin - columns.centre(k));
        return columns.depth(k) - 0.5 * (supercritical_depth(flow.q, flow.energy_upstream - z, standard_gravity) +
                                         subcritical_depth(flow.q, flow.energy_downstream - z, standard_gravity));
    };
    for (std::size_t k = columns.count(); k-- > 1;) {
        if (origin - columns.centre(k) > bump_crest && surplus(k) <= 0 && surplus(k - 1) > 0) {
            return origin - columns.centre(k) + columns.length() * surplus(k) / (surplus(k) - surplus(k - 1));
        }
    }
    return nan;
}

// A sill at the end holds the depth behind the jump. How high the water stands before a sill depends on details of the
// flow over it, so the truth is that of the discharge and of the depth downstream as they are measured.
Result run_with_jump(const Request& request) {
    constexpr double origin = 17;  // m: the channel is 13 m long, s from 4 to 17 m
    constexpr double q = 0.18;
    constexpr double depth_downstream = 0.33;
    const Interval plateau{2, 4};  // x where the depth downstream is measured, m: s 13 to 15, the sill begins at s 15.9
    const BumpFlow nominal = bump_flow_with_jump(q, depth_downstream, standard_gravity);
    std::vector<std::string> sizes = channel_slice(request);
    sizes.push_back(assign("/channel/depth_m", nominal.depth(0)));
    sizes.push_back(assign("/channel/velocity_m_s", q / nominal.depth(0)));
    sizes.push_back(assign("/obstacles/0/z_max_m", slice_width(request)));
    // A broad-crested sill carries critical flow: its height is E - 3/2 h_c.
    sizes.push_back(
        assign("/obstacles/0/height_m", nominal.energy_downstream - 1.5 * critical_depth(q, standard_gravity)));
    const Scene scene = scene_for(request, "validation/bump_jump.json", sizes);
    const std::unique_ptr<Water> water = make_water(scene);
    Cost cost;
    const Columns columns =
        average_columns(*water, 0.6 * scene.duration, scene.duration, column_spacings * request.spacing, cost);
    const Interval compared{plateau.lo, scene.channel->x.hi - 1};
    const double measured_q = mean_discharge(columns, compared);
    const double measured_depth = mean_depth(columns, plateau);
    // Without a jump on the bump there is nothing to compare with: the depths are then judged against the nominal flow.
    BumpFlow flow = nominal;
    double place = nan;
    try {
        flow = bump_flow_with_jump(measured_q, measured_depth, standard_gravity);
        place = std::abs(jump_place(columns, origin, flow) - flow.jump) / request.spacing;
    } catch (const std::invalid_argument&) {
    }
    Result result = result_of(*water, columns, cost, compared, origin, flow.q, depth_over(flow, origin));
    result.metrics.push_back({"jump_place", place, "spacings"});
    result.metrics.push_back({"emitter_discharge", std::abs(measured_q / q - 1), "1"});
    result.metrics.push_back({"depth_downstream_measured", measured_depth, "m"});
    result.metrics.push_back({"missed_layers", water->missed_layers(), "1"});
    return result;
}

Case bump_case(const std::string& name, const std::string& what, std::vector<double> spacings,
               Result (*run)(const Request&)) {
    Case c;
    c.name = "bump_" + name;
    c.truth =
        what +
        " Energy is conserved and the pressure hydrostatic (Goutal and Maurel 1997; SWASHES, Delestre et al. 2013). "
        "Water that is not hydrostatic differs: the bump is twice as long as the water is deep.";
    c.reference = "Bernoulli (SWASHES)";
    c.spacings = std::move(spacings);
    c.run = run;
    return c;
}

}  // namespace

Case bump_subcritical_case() {
    Case c = bump_case("subcritical", "Subcritical flow, q 4.42 m2/s, 2 m deep, in a loop of 25 m.", {0.2, 0.1, 0.05},
                       run_subcritical);
    c.quick = true;
    c.long_from = 2;
    return c;
}

Case bump_transcritical_case() {
    Case c = bump_case("transcritical",
                       "Flow that turns supercritical over the crest, q 1.53 m2/s, from an emitter to a free outfall. "
                       "depth_l2_curved compares with Serre's equation, which knows the curvature of the streamlines.",
                       {0.1, 1.0 / 15, 0.05}, run_transcritical);
    c.quick = true;
    return c;
}

Case bump_jump_case() {
    Case c =
        bump_case("jump",
                  "Transcritical flow with a jump on the lee side, q 0.18 m2/s, a sill holds the depth at the end; "
                  "exact for the measured discharge and depth downstream, and a jump by the momentum function.",
                  {0.05, 1.0 / 30, 0.025}, run_with_jump);
    c.long_from = 2;
    return c;
}

}  // namespace wade::validation
