// People with bodies in the corridor without ends: speed over density, counterflow, and that no two overlap.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cases.hpp"
#include "crowd_corridor.hpp"

namespace wade::validation {

namespace {

constexpr double settling = 30;   // s
constexpr double measuring = 60;  // s

// Mean speed of the people in the direction that they want, m/s.
double speed_at(const Request& request, double density, bool two_ways, Result& result, Overlaps& overlaps) {
    crowd::CrowdWorld crowd = corridor_crowd(request, SpeedRule::pi, density, two_ways);
    mean_progress(crowd, settling, result, overlaps);
    return mean_progress(crowd, measuring, result, overlaps);
}

std::string percent(double density) {
    char text[8];
    std::snprintf(text, sizeof text, "%03.0f", 100 * density);
    return text;
}

Result run(const Request& request) {
    const std::vector<double> densities{0.5, 1, 2, 3};
    Result result = crowd_result();
    Curve speeds{"speed", {"density_per_m2", "speed_human_m_s", "measured_speed_m_s", "speed_fast_m_s"}, {}};
    for (const double rho : densities) speeds.rows.push_back({rho, 0, weidmann_speed(rho), 0});
    for (const auto& [style, column] : {std::pair{"human", 1}, std::pair{"fast", 3}}) {
        Request with_bodies = request;
        with_bodies.overrides.push_back(std::string("/crowd/bodies=") + style);
        with_bodies.overrides.push_back("/crowd/markers=redrawn");
        Overlaps overlaps;
        double largest = 0;  // difference from Weidmann's curve
        for (std::vector<double>& row : speeds.rows) {
            const double speed = speed_at(with_bodies, row[0], false, result, overlaps);
            row[static_cast<std::size_t>(column)] = speed;
            largest = std::max(largest, std::abs(speed - row[2]));
        }
        result.metrics.push_back({std::string("weidmann_largest_difference_") + style, largest, "m/s"});
        for (const double rho : {0.5, 1.0}) {
            result.metrics.push_back({std::string("counterflow_speed_") + style + "_" + percent(rho),
                                      speed_at(with_bodies, rho, true, result, overlaps), "m/s"});
        }
        report_overlaps(overlaps, std::string("_") + style, result);
    }
    result.curves = {speeds};
    return result;
}

}  // namespace

Case crowd_bodies_case() {
    return {.name = "crowd_bodies",
            .truth =
                "people with bodies of 0.25 m radius in a corridor 8 m wide that repeats after 20 m, beside Weidmann "
                "1993: v = 1.34 (1 - exp(-1.913 (1/rho - 1/5.4))) m/s, at 0.5, 1, 2 and 3 people/m2. Means of 60 s "
                "after 30 s. Half of the people the other way in the counterflow. No two may overlap.",
            .reference = "Weidmann 1993",
            .spacings = {0.25, 2.0 / 11, 0.125},  // redrawn markers come in squares: 64, 121 and 256 a cell
            .quick = true,
            .run = run};
}

}  // namespace wade::validation
