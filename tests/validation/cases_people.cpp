// People who push the water: the law of drag, what drives the river, the surface before a row, a crowd as vegetation.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "cases.hpp"
#include "configs/scene/scene_frames.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/people/person.hpp"
#include "fluid_server/make_model.hpp"
#include "fluid_server/shallow_water/model.hpp"
#include "impulse.hpp"
#include "run.hpp"

namespace wade::validation {
namespace {

using crowd::Vector2d;

// Sums of the second half of a run, when the river has found its state, and the account of all of it.
struct PeopleRun {
    double half = 0;                   // s
    std::vector<Vector2d> impulse;     // by id, N s
    double driven = 0;                 // impulse of the force that holds the bulk speed, N s, towards -x
    double speed = 0;                  // mean of the stream, m/s
    Vector2d got = Vector2d::Zero();   // of the whole run, N s
    Vector2d lost = Vector2d::Zero();  // and what the water says
    Vector2d missing = Vector2d::Zero();
    std::unique_ptr<fluid::FluidModel> water;

    [[nodiscard]] double drag() const {  // of all people, N, towards -x
        return -std::accumulate(impulse.begin(), impulse.end(), Vector2d(Vector2d::Zero())).x() / half;
    }
};

double mass_of(const crowd::WaterView& view) {
    return std::accumulate(view.mass.begin(), view.mass.end(), 0.0,
                           [](double sum, float m) { return sum + static_cast<double>(m); });
}

PeopleRun run_people(const Scene& scene, Result& result) {
    PeopleRun run;
    run.water = fluid::make_fluid_model(scene);
    crowd::CrowdWorld people = crowd::make_crowd(scene);
    FrameMemory memory(run.water->capacity());
    WayBack way_back;
    constexpr std::uint64_t ticks = 1000000;
    const auto per_second = static_cast<std::uint64_t>(std::llround(scene.frame_rate * static_cast<double>(ticks)));
    const std::uint64_t frames = frames_of(scene), first = frames / 2 + 1;
    std::vector<Vector2d> before;
    Vector2d handed = Vector2d::Zero();
    const double cpu = process_cpu_time();
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
        // Parallel: the impulses of the step before last are what this frame takes.
        run.got = handed;
        handed =
            std::accumulate(people.pushing->given.begin(), people.pushing->given.end(), Vector2d(Vector2d::Zero()));
        if (people.scene.coupling.agents_stream == AgentsStream::serial) run.got = handed;
        way_back.give(people, frame, *run.water);
        if (frame == first) before = people.pushing->given;
        const shm::Diagnostics d = run.water->advance_frame({(frame - 1) * ticks, frame * ticks, per_second});
        memory.take(*run.water, frame);
        result.steps += d.sub_steps;
        run.lost = {d.taken_by_people_x_n_s, d.taken_by_people_z_n_s};
        run.missing = {d.missing_for_people_x_n_s, d.missing_for_people_z_n_s};
        crowd::step(people, memory.ground_view());
        if (frame < first) continue;
        const double dt = 1 / scene.frame_rate;
        run.half += dt;
        run.speed += d.mean_speed_m_s * dt;
        if (!std::isnan(d.driving_acceleration_m_s2)) {
            run.driven += d.driving_acceleration_m_s2 * dt * mass_of(memory.ground_view());
        }
    }
    result.solver_cpu_time = process_cpu_time() - cpu;
    run.speed /= run.half;
    for (std::size_t id = 0; id < before.size(); ++id) run.impulse.push_back(people.pushing->given[id] - before[id]);
    result.model = run.water->name();
    result.particles = memory.count();
    result.simulated_time = static_cast<double>(frames) / scene.frame_rate;
    return run;
}

// rho C_D B h U^2 / 2 of one of 1.7 m, N.
double law_of_drag(const Scene& scene) {
    const double k =
        crowd::drag_upright(crowd::usual_height, scene.channel.depth, {scene.fluid.rest_density, scene.world.gravity});
    return k * scene.channel.velocity * scene.channel.velocity;
}

void add_balance(const PeopleRun& run, Result& result) {
    const double got = std::sqrt(run.got.squaredNorm());
    result.metrics.push_back({"driving_error", std::abs(run.driven / (run.drag() * run.half) - 1), "1"});
    result.metrics.push_back({"balance", std::sqrt((run.lost + run.missing - run.got).squaredNorm()) / got, "1"});
    result.metrics.push_back({"missing", std::sqrt(run.missing.squaredNorm()) / got, "1"});
}

Result run_drag(const Request& request) {
    Result result;
    const Scene scene = scene_for(request, "validation/people_river.json");
    const PeopleRun run = run_people(scene, result);
    result.metrics.push_back({"drag_error", std::abs(run.drag() / law_of_drag(scene) - 1), "1"});
    result.metrics.push_back({"drag", run.drag(), "N"});
    add_balance(run, result);
    return result;
}

// People at random, no two nearer than 0.5 m, on all of the channel.
void scatter(Scene& scene, int n) {
    const AgentGroup one = scene.crowd.groups.at(0);
    scene.crowd.groups.clear();
    for (std::uint64_t draw = 0; static_cast<int>(scene.crowd.groups.size()) < n; ++draw) {
        AgentGroup group = one;
        group.name = std::to_string(draw);
        group.start_x = scene.channel.x.lo + scene.channel.x.length() * crowd::counter_uniform(scene.seed, 1, draw);
        group.start_z = scene.channel.z.lo + scene.channel.z.length() * crowd::counter_uniform(scene.seed, 2, draw);
        const bool free = std::none_of(scene.crowd.groups.begin(), scene.crowd.groups.end(), [&](const AgentGroup& g) {
            return std::hypot(g.start_x - group.start_x, g.start_z - group.start_z) < 0.5;
        });
        if (free) scene.crowd.groups.push_back(group);
    }
}

// 0.5 people/m2 in the river of one.
Result run_crowd(const Request& request) {
    Result result;
    Scene scene = scene_for(request, "validation/people_river.json");
    scatter(scene, 96);
    const PeopleRun run = run_people(scene, result);
    result.metrics.push_back({"drag_error", std::abs(run.drag() / (96 * law_of_drag(scene)) - 1), "1"});
    result.metrics.push_back({"drag_per_person", run.drag() / (96 * law_of_drag(scene)), "1"});
    add_balance(run, result);
    return result;
}

// Ten in file, 0.6 m apart, who shelter one another.
Result run_file(const Request& request) {
    Result result;
    Scene scene = scene_for(request, "validation/people_river.json");
    AgentGroup& file = scene.crowd.groups.at(0);
    file.columns = file.count = 10;
    file.pitch_x = 0.6;
    scene.coupling.shelter = Shelter::wake;
    const PeopleRun run = run_people(scene, result);
    result.metrics.push_back({"mean_drag", run.drag() / (10 * law_of_drag(scene)), "1"});
    result.metrics.push_back({"mean_drag_error", std::abs(result.metrics.back().value / 0.178 - 1), "1"});
    add_balance(run, result);
    return result;
}

// On a slope of 0.01 with a bed of n_b = 0.03: the speed of uniform flow through 0.5 people/m2.
Result run_vegetation(const Request& request) {
    Result result;
    Scene scene = scene_for(request, "validation/people_river.json",
                            {"/channel/flow=periodic", "/channel/slope=0.01", "/channel/manning_n=0.03",
                             "/channel/velocity_m_s=1.04", "/duration_s=30"});
    scatter(scene, 96);
    const PeopleRun run = run_people(scene, result);
    const double density = 96 / (scene.channel.x.length() * scene.channel.z.length());  // 1/m2
    const double width = crowd::body_width_share * crowd::usual_height, depth = scene.channel.depth;
    const double n_squared = 0.03 * 0.03 + crowd::body_drag * width * density * std::pow(depth, 4.0 / 3) / (2 * 9.81);
    const double expected = std::pow(depth, 2.0 / 3) * std::sqrt(0.01 / n_squared);
    result.metrics.push_back({"speed_error", std::abs(run.speed / expected - 1), "1"});
    result.metrics.push_back({"speed", run.speed, "m/s"});
    result.metrics.push_back({"expected_speed", expected, "m/s"});
    return result;
}

// Momentum function of a section of the grid per metre of width, rho (g h^2 / 2 + q^2 / h), N/m, and the mean depth.
struct Section {
    double momentum = 0, depth = 0;
};
Section section_at(const fluid::shallow_water::ShallowWater& world, double x) {
    const fluid::shallow_water::Grid& grid = world.grid;
    const auto i = static_cast<std::size_t>((x - grid.x.lo) / grid.dx);
    Section section;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)) + i;
        const double h = world.water.h[c], q = world.water.qx[c];
        section.momentum += world.scene.fluid.rest_density * (0.5 * world.constants.gravity * h * h + q * q / h);
        section.depth += h;
    }
    const auto n = static_cast<double>(grid.nz);
    return {section.momentum / n, section.depth / n};
}

// A row of eight across 8 m in 1.5 m/s: what is missing of the momentum behind them is their drag.
Result run_row(const Request& request) {
    Result result;
    Scene scene = scene_for(request, "validation/people_river.json",
                            {"/channel/velocity_m_s=1.5", "/duration_s=60", "/fluid/model=shallow_water"});
    AgentGroup& row = scene.crowd.groups.at(0);
    row.rows = row.count = 8;
    row.columns = 1;
    row.start_x = 12, row.start_z = 0.5;
    const PeopleRun run = run_people(scene, result);
    const auto& model = dynamic_cast<const fluid::shallow_water::ShallowWaterModel&>(*run.water);
    const Section before = section_at(model.world(), 15.1), behind = section_at(model.world(), 8.9);
    const double per_width = run.drag() / scene.channel.z.length();
    // Between the sections, 6.2 m apart, the river is driven by its share of the whole force.
    const double driven = per_width * 6.2 / scene.channel.x.length();
    result.metrics.push_back(
        {"momentum_error", std::abs((before.momentum - behind.momentum) / (per_width - driven) - 1), "1"});
    result.metrics.push_back({"rise", before.depth - behind.depth, "m"});
    result.metrics.push_back({"drag_per_width", per_width, "N/m"});
    add_balance(run, result);
    return result;
}

}  // namespace

Case people_drag_case() {
    return {.name = "people_drag",
            .truth =
                "One person of 1.7 m stands in a recirculating river of 1 m/s, 1 m deep, and pushes it: its drag is "
                "rho C_D B h "
                "U^2 / 2, and all that drives the river.",
            .reference = "law of drag",
            .spacings = {0.25, 0.125},
            .quick = true,
            .run = run_drag};
}

Case people_crowd_case() {
    return {.name = "people_crowd",
            .truth = "96 people stand at random in the same river, 0.5 people/m2; together they take what drives it.",
            .reference = "law of drag",
            .spacings = {0.25},
            .run = run_crowd};
}

Case people_file_case() {
    return {
        .name = "people_file",
        .truth =
            "Ten in file, 0.6 m apart, sheltered by wakes: the mean drag is 0.178 of that of one alone by the wakes' "
            "closed form, 0.13 to 0.2 by what Li et al. (2026) found of dense groups.",
        .reference = "Blevins 2005",
        .spacings = {0.25},
        .run = run_file};
}

Case people_vegetation_case() {
    return {.name = "people_vegetation",
            .truth =
                "96 people stand at random on a slope of 0.01: uniform flow as through stems, "
                "n^2 = n_b^2 + C_D B N h^(4/3) / (2 g).",
            .reference = "Petryk and Bosmajian 1975",
            .spacings = {0.25},
            .quick = true,
            .run = run_vegetation};
}

Case people_row_case() {
    return {
        .name = "people_row",
        .truth = "Eight people abreast across 8 m in 1.5 m/s: g h^2 / 2 + q^2 / h falls over the row by their drag.",
        .reference = "momentum of a section",
        .spacings = {0.25},
        .quick = true,
        .run = run_row};
}

}  // namespace wade::validation
