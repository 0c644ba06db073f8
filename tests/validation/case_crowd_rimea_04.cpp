// Speed and flow against density in a corridor without ends.

#include <cmath>

#include "cases.hpp"
#include "crowd_corridor.hpp"

namespace wade::validation {

namespace {

constexpr double settling = 30;   // s
constexpr double measuring = 60;  // s

// Numbers of one speed rule over all densities.
struct Diagram {
    std::vector<double> speeds;  // m/s
    double rms = 0;              // of speed minus Weidmann's, m/s
    double largest_flow = 0;     // 1/(m s)
    double density_there = 0;    // 1/m2
    double largest_rise = 0;     // largest rise of the speed from a density to the next, m/s
    Overlaps overlaps;
};

Diagram measure(const Request& request, SpeedRule rule, const std::vector<double>& densities, Result& result) {
    Diagram diagram;
    for (const double density : densities) {
        crowd::CrowdWorld crowd = corridor_crowd(request, rule, density, false);
        Overlaps unused;
        mean_progress(crowd, settling, result, unused);
        const double speed = mean_progress(crowd, measuring, result, diagram.overlaps);
        diagram.rms += std::pow(speed - weidmann_speed(density), 2) / static_cast<double>(densities.size());
        if (!diagram.speeds.empty()) {
            diagram.largest_rise = std::max(diagram.largest_rise, speed - diagram.speeds.back());
        }
        diagram.speeds.push_back(speed);
        if (density * speed > diagram.largest_flow) {
            diagram.largest_flow = density * speed;
            diagram.density_there = density;
        }
    }
    diagram.rms = std::sqrt(diagram.rms);
    return diagram;
}

void report(const Diagram& diagram, const std::string& rule, Result& result) {
    result.metrics.push_back({"weidmann_rms_" + rule, diagram.rms, "m/s"});
    result.metrics.push_back({"largest_flow_" + rule, diagram.largest_flow, "1/(m s)"});
    result.metrics.push_back({"density_of_largest_flow_" + rule, diagram.density_there, "1/m2"});
    result.metrics.push_back({"rise_with_density_" + rule, diagram.largest_rise, "m/s"});
    report_overlaps(diagram.overlaps, "_" + rule, result);
}

Result run(const Request& request) {
    // As people a corridor of 160 m2 can hold: whole numbers of them.
    const std::vector<double> densities{0.1, 0.25, 0.5, 0.75, 1, 1.5, 2, 2.5, 3, 4};
    Result result = crowd_result();
    const Diagram pi = measure(request, SpeedRule::pi, densities, result);
    const Diagram per_frame = measure(request, SpeedRule::per_frame, densities, result);
    report(pi, "pi", result);
    report(per_frame, "per_frame", result);
    // Two simulated columns, each beside Weidmann's.
    const std::string abscissa = "density_per_m2";
    Curve speed{
        "speed",
        {abscissa, "speed_pi_m_s", "measured_speed_pi_m_s", "speed_per_frame_m_s", "measured_speed_per_frame_m_s"},
        {}};
    Curve flow{"flow",
               {abscissa, "specific_flow_pi", "measured_specific_flow_pi", "specific_flow_per_frame",
                "measured_specific_flow_per_frame"},
               {}};
    for (std::size_t k = 0; k < densities.size(); ++k) {
        const double rho = densities[k];
        const double weidmann = weidmann_speed(rho);
        speed.rows.push_back({rho, pi.speeds[k], weidmann, per_frame.speeds[k], weidmann});
        flow.rows.push_back({rho, rho * pi.speeds[k], rho * weidmann, rho * per_frame.speeds[k], rho * weidmann});
    }
    result.curves = {speed, flow};
    return result;
}

}  // namespace

Case crowd_rimea_04_case() {
    return {.name = "crowd_rimea_04",
            .truth =
                "RiMEA guideline 3.0, test 4: speed and flow against density, here in a corridor 8 m wide that repeats "
                "after 20 m, beside Weidmann 1993: v = 1.34 (1 - exp(-1.913 (1/rho - 1/5.4))) m/s. Means of 60 s "
                "after 30 s, flow in 1/(m s). Levels: 16, 32 and 64 markers per m2.",
            .reference = "Weidmann 1993",
            .spacings = marker_spacings,
            .run = run};
}

}  // namespace wade::validation
