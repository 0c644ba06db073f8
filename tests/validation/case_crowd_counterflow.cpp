// Two streams meet in a corridor: do lanes form, or does the crowd stop?

#include <cmath>

#include "cases.hpp"
#include "crowd_corridor.hpp"

namespace wade::validation {

namespace {

constexpr double window = 10;  // s
constexpr int windows = 12;

// Order of lanes, 0 mixed to 1 separated: the mean of ((same - opposite) / (same + opposite))^2 over all agents, where
// the others within 3/4 of rho^-1/2 across the corridor count. M. Rex, H. Loewen, Phys. Rev. E 75, 051402 (2007).
double lane_order(const crowd::CrowdWorld& crowd, double density) {
    const double reach = 0.75 / std::sqrt(density);
    double sum = 0;
    for (const std::uint32_t i : crowd.active) {
        double same = 0;
        double opposite = 0;
        for (const std::uint32_t j : crowd.active) {
            if (std::abs(crowd.agents.position[i].y() - crowd.agents.position[j].y()) > reach || i == j) continue;
            (crowd.agents.goal[i].x() * crowd.agents.goal[j].x() > 0 ? same : opposite) += 1;
        }
        const double all = same + opposite;
        sum += all > 0 ? std::pow((same - opposite) / all, 2) : 0;
    }
    return sum / static_cast<double>(crowd.active.size());
}

// Share of the people who move at less than a tenth of their desired speed.
double stuck_share(const crowd::CrowdWorld& crowd) {
    double stuck = 0;
    for (const std::uint32_t id : crowd.active) {
        stuck += crowd.agents.velocity[id].norm() < 0.1 * crowd.agents.desired_speed[id] ? 1 : 0;
    }
    return stuck / static_cast<double>(crowd.active.size());
}

Result run(const Request& request) {
    Result result = crowd_result();
    struct Setting {
        SpeedRule rule;
        const char* name;
    };
    for (const Setting& setting : {Setting{SpeedRule::pi, "pi"}, Setting{SpeedRule::per_frame, "per_frame"}}) {
        const std::string rule = setting.name;
        Curve speed{"speed_" + rule, {"time_s"}, {}};
        Curve order{"lane_order_" + rule, {"time_s"}, {}};
        for (int w = 0; w < windows; ++w) {
            speed.rows.push_back({(w + 1) * window});
            order.rows.push_back({(w + 1) * window});
        }
        for (const auto& [density, label] : {std::pair{0.25, "025"}, std::pair{0.5, "050"}, std::pair{1.0, "100"}}) {
            crowd::CrowdWorld crowd = corridor_crowd(request, setting.rule, density, true);
            const double mixed = lane_order(crowd, density);
            Overlaps overlaps;
            double last = 0;
            double lanes = 0;
            const bool drawn = density >= 0.5;
            if (drawn) {
                const std::string people = density < 1 ? "_at_half_a_person_m2" : "_at_one_person_m2";
                speed.columns.push_back("speed_" + rule + people + "_m_s");
                order.columns.push_back("lane_order_" + rule + people);
            }
            for (std::size_t w = 0; w < windows; ++w) {
                last = mean_progress(crowd, window, result, overlaps);
                lanes = lane_order(crowd, density);
                if (!drawn) continue;
                speed.rows[w].push_back(last);
                order.rows[w].push_back(lanes);
            }
            const std::string suffix = "_" + rule + "_" + label;
            result.metrics.push_back({"flow" + suffix, density * last, "1/(m s)"});
            result.metrics.push_back({"speed" + suffix, last, "m/s"});
            result.metrics.push_back({"lane_order" + suffix, lanes, "1"});
            result.metrics.push_back({"lane_order_at_start" + suffix, mixed, "1"});
            result.metrics.push_back({"stuck_share" + suffix, stuck_share(crowd), "1"});
            report_overlaps(overlaps, suffix, result);
        }
        result.curves.push_back(speed);
        result.curves.push_back(order);
    }
    return result;
}

}  // namespace

Case crowd_counterflow_case() {
    return {.name = "crowd_counterflow",
            .truth =
                "Half of the people in a corridor walk one way, half the other, 120 s. Real people form lanes "
                "(order parameter of Rex and Loewen 2007, 0 mixed to 1 separated) and keep walking. Flow and speed "
                "of the last 10 s, at 0.25, 0.5 and 1 per m2. Levels: 16, 32 and 64 markers per m2.",
            .reference = "lanes form",
            .spacings = marker_spacings,
            .run = run};
}

}  // namespace wade::validation
