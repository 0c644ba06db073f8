// Measured floods among houses: Merewether and Seaside, as configs/sites ships them.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "cases.hpp"
#include "fluid_server/shallow_water/step.hpp"
#include "run.hpp"

namespace wade::validation {

namespace {

using fluid::shallow_water::ShallowWater;

Scene flood(const Request& request, const std::string& name) {
    return scene_for(request, name, {assign("/fluid/shallow_water/cell_size_m", request.spacing)});
}

std::size_t cell_at(const ShallowWater& world, double x, double z) {
    const fluid::shallow_water::Grid& grid = world.grid;
    return grid.row(static_cast<std::ptrdiff_t>((z - grid.z.lo) / grid.dz)) +
           static_cast<std::size_t>((x - grid.x.lo) / grid.dx);
}

// Calls body(cell) for each active cell.
template <typename Body>
void for_each_active(const ShallowWater& world, Body&& body) {
    for (std::size_t k = 0; k < world.grid.nz; ++k) {
        const std::size_t row = world.grid.row(static_cast<std::ptrdiff_t>(k));
        world.lines.active.for_each_span(k, [&](std::size_t first, std::size_t n) {
            for (std::size_t c = row + first; c < row + first + n; ++c) body(c);
        });
    }
}

// One step of at most `longest`, s.
fluid::shallow_water::StepReport advance(ShallowWater& world, double longest, Result& result) {
    const double cpu = process_cpu_time(), wall = wall_time();
    const auto report = fluid::shallow_water::step(world, longest);
    ++result.steps;
    result.particle_steps += static_cast<double>(active_cells(world));
    result.simulated_time += report.dt;
    result.solver_cpu_time += process_cpu_time() - cpu;
    result.solver_wall_time += wall_time() - wall;
    return report;
}

// Observed stages; a gauge that stays dry shows the ground, as the published models do.
struct Stage {
    double easting, northing, observed;  // m
    bool wet;                            // in every model
};
const std::vector<Stage> merewether_stages{{382373.51, 6354387.84, 23.01, true},
                                           {382354.61, 6354365.21, 23.14, false},
                                           {382424.40, 6354478.33, 19.98, true},
                                           {382509.71, 6354548.22, 18.38, true},
                                           {382339.42, 6354297.84, 23.36, false}};

Result run_merewether(const Request& request) {
    const Scene scene = flood(request, "sites/merewether/merewether.json");
    ShallowWater world(scene);
    Result result;
    result.model = "shallow_water";
    result.particles = world.grid.cells();
    const auto stages = [&] {
        std::vector<double> found;
        for (const Stage& stage : merewether_stages) {
            const std::size_t c =
                cell_at(world, stage.easting - scene.site->origin_x, stage.northing - scene.site->origin_z);
            found.push_back(world.water.h[c] + world.bed.height[c]);
        }
        return found;
    };
    double in = 0, out = 0, froude = 0, fastest = 0;
    std::vector<double> at_600;
    Curve curve{"stages", {"time_s", "stage_1_m", "stage_2_m", "stage_3_m", "stage_4_m", "stage_5_m"}, {}};
    while (world.time < 700 - 1e-9) {
        const double whole = 10 * std::floor(world.time / 10 + 1e-9) + 10;
        const auto report = advance(world, whole - world.time, result);
        in += report.inflow, out += report.outflow;
        if (world.time < whole - 1e-9) continue;
        for_each_active(world, [&](std::size_t c) {
            const double h = world.water.h[c], u = std::hypot(world.primitive.u[c], world.primitive.v[c]);
            fastest = std::max(fastest, h > 0.01 ? u : 0);
            if (h > 0.05) froude = std::max(froude, u / std::sqrt(standard_gravity * h));
        });
        const std::vector<double> now = stages();
        curve.rows.push_back({world.time, now[0], now[1], now[2], now[3], now[4]});
        if (at_600.empty() && world.time > 600 - 1e-6) at_600 = now;
    }
    const std::vector<double> last = stages();
    double error = 0, of_wet = 0, late = 0, stored = 0;
    for (std::size_t n = 0; n < last.size(); ++n) {
        const double here = std::abs(last[n] - merewether_stages[n].observed);
        error += here / 5;
        of_wet += merewether_stages[n].wet ? here / 3 : 0;
        late = std::max(late, std::abs(last[n] - at_600[n]));
    }
    for_each_active(world, [&](std::size_t c) { stored += world.water.h[c] * world.openings.share_of(c); });
    stored *= world.grid.cell_area();
    result.metrics = {{"mean_error", error, "m"},  {"mean_error_wet", of_wet, "m"},
                      {"froude", froude, "1"},     {"late_change", late, "m"},
                      {"fastest", fastest, "m/s"}, {"balance", std::abs(stored + out - in) / in, "1"}};
    result.curves = {curve};
    return result;
}

// What a gauge of Seaside measured until 38 s; u across the shore, h u^2 from when the speed is known on.
struct Gauge {
    std::string name;
    double x = 0, z = 0;                    // m
    double arrival = 0, speed_from = 0;     // s
    double depth = 0, speed = 0, flux = 0;  // peaks: m, m/s, m^3/s^2
    std::vector<double> time, h, u;         // computed
};

// Rows A and B; the first column stands at the sea.
const std::vector<Gauge> seaside_gauges{
    {"a1", 28.611, 10.007, 25.12, 26.28, 0.2494, 1.454, 0.4319, {}, {}, {}},
    {"a5", 30.544, 10.006, 26.02, 28.24, 0.0772, 1.908, 0.2509, {}, {}, {}},
    {"a9", 35.676, 9.972, 30.16, 26.48, 0.0424, 1.133, 0.0245, {}, {}, {}},
    {"b1", 28.721, 12.612, 25.14, 26.16, 0.2193, 2.042, 0.6758, {}, {}, {}},
    {"b4", 30.176, 12.794, 25.80, 27.24, 0.1581, 1.787, 0.4242, {}, {}, {}},
    {"b6", 31.635, 12.971, 26.46, 27.86, 0.0905, 1.959, 0.3034, {}, {}, {}},
    {"b9", 35.668, 13.469, 28.78, 29.34, 0.0440, 1.395, 0.0340, {}, {}, {}},
};

// Peaks of what was computed at a gauge over those measured. The speed counts from when it was measured, that much after
// the water came.
struct Ratios {
    double depth = 0, speed = 0, flux = 0;
};
Ratios ratios_of(const Gauge& gauge) {
    double came = std::numeric_limits<double>::infinity();
    Ratios peak;
    for (std::size_t n = 0; n < gauge.time.size(); ++n) {
        if (gauge.time[n] < 24) continue;
        if (gauge.h[n] > 0.01) came = std::min(came, gauge.time[n]);
        peak.depth = std::max(peak.depth, gauge.h[n]);
        if (gauge.time[n] < came + gauge.speed_from - gauge.arrival) continue;
        peak.speed = std::max(peak.speed, gauge.u[n]);
        peak.flux = std::max(peak.flux, gauge.h[n] * gauge.u[n] * gauge.u[n]);
    }
    return {peak.depth / gauge.depth, peak.speed / gauge.speed, peak.flux / gauge.flux};
}

// Bands that other models reach, of computed over measured peaks.
struct Band {
    const char* gauge;
    double depth_lo, depth_hi, speed;
};
constexpr Band bands[] = {
    {"b1", 0.65, 0.90, 0.25}, {"b4", 0.75, 1.25, 0.25}, {"b6", 0.75, 1.25, 0.25}, {"b9", 0.30, 1.00, 0.40}};

Result run_seaside(const Request& request) {
    const Scene scene = flood(request, "sites/seaside/seaside.json");
    ShallowWater world(scene);
    std::vector<Gauge> gauges = seaside_gauges;
    Result result;
    result.model = "shallow_water";
    result.particles = world.grid.cells();
    double fastest = 0;
    while (world.time < 38 - 1e-9) {
        advance(world, std::min(0.02, 38 - world.time), result);
        for (Gauge& gauge : gauges) {
            const std::size_t c = cell_at(world, gauge.x, gauge.z);
            gauge.time.push_back(world.time);
            gauge.h.push_back(world.water.h[c]);
            gauge.u.push_back(world.primitive.u[c]);
        }
        for_each_active(world, [&](std::size_t c) {
            if (world.water.h[c] > 0.005)
                fastest = std::max(fastest, std::hypot(world.primitive.u[c], world.primitive.v[c]));
        });
    }
    double depth_outside = 0, speed_outside = 0;
    std::vector<double> flux;
    for (const Gauge& gauge : gauges) {
        const Ratios r = ratios_of(gauge);
        flux.push_back(std::abs(r.flux - 1));
        result.metrics.push_back({"depth_" + gauge.name, r.depth, "1"});
        result.metrics.push_back({"speed_" + gauge.name, r.speed, "1"});
        result.metrics.push_back({"flux_" + gauge.name, r.flux, "1"});
        for (const Band& band : bands) {
            if (gauge.name != band.gauge) continue;
            depth_outside = std::max({depth_outside, band.depth_lo - r.depth, r.depth - band.depth_hi});
            speed_outside = std::max(speed_outside, std::abs(r.speed - 1) - band.speed);
        }
        Curve curve{"gauge_" + gauge.name, {"time_s", "depth_m", "speed_m_s"}, {}};
        for (std::size_t n = 0; n < gauge.time.size(); n += 4)
            curve.rows.push_back({gauge.time[n], gauge.h[n], gauge.u[n]});
        result.curves.push_back(curve);
    }
    std::sort(flux.begin(), flux.end());
    result.metrics.push_back({"depth_outside", depth_outside, "1"});
    result.metrics.push_back({"speed_outside", speed_outside, "1"});
    result.metrics.push_back({"momentum_flux_median", flux[flux.size() / 2], "1"});
    result.metrics.push_back({"fastest", fastest, "m/s"});
    return result;
}

}  // namespace

Case site_merewether_case() {
    return {.name = "site_merewether",
            .truth =
                "Stages of the flood of 2007 at Merewether, Newcastle, at five places, as a benchmark of Australian "
                "Rainfall "
                "and Runoff (project 15; data by the Water Research Laboratory): 19.7 m3/s, 700 s. Two of the places "
                "are dry in "
                "every model; there the ground counts.",
            .reference = "AR&R project 15",
            .spacings = {1, 0.5},
            .run = run_merewether};
}

Case site_seaside_case() {
    return {.name = "site_seaside",
            .truth =
                "Peaks of depth, speed and momentum flux in the streets of a town model of 1:50 under a tsunami (Park "
                "et al., "
                "Coastal Engineering 79 (2013), 1-12; NTHMP benchmark of 2017): computed over measured, rows A and B, "
                "until 38 s.",
            .reference = "Park 2013",
            .spacings = {0.1, 0.05},
            .run = run_seaside};
}

}  // namespace wade::validation
