// Momentum exchange between people and water: drag, the river's driving force, a row, a crowd as vegetation, walls,
// drifting bodies, frame rates.

#include <algorithm>
#include <array>
#include <cmath>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/people/person.hpp"
#include "impulse.hpp"

namespace wade::validation {
namespace {

// Returns the drag rho C_D B h U^2 / 2 of a person of 1.7 m, N.
double law_of_drag(const Scene& scene) {
    const double k = crowd::drag_upright(crowd::usual_height, scene.channel->depth,
                                         {scene.fluid->rest_density, scene.world->gravity});
    return k * scene.channel->velocity * scene.channel->velocity;
}

void add_balance(const PeopleRun& run, Result& result) {
    const double got = std::sqrt(run.got.squaredNorm());
    result.metrics.push_back({"driving_error", std::abs(run.driven / run.taken - 1), "1"});
    result.metrics.push_back({"balance", std::sqrt((run.lost + run.missing - run.got).squaredNorm()) / got, "1"});
    result.metrics.push_back({"missing", std::sqrt(run.missing.squaredNorm()) / got, "1"});
}

constexpr const char* river = "validation/people_river.json";

// Measures the drag of one standing person, as a mean over all positions of `x` and `z`.
Result drag_in(const Request& request, const std::vector<std::string>& of_the_river,
               const std::vector<double>& x = {12.03}, const std::vector<double>& z = {4.07}) {
    Result result;
    double sum = 0, squares = 0, law = 0;
    PeopleRun all;  // sums
    for (std::size_t i = 0; i < x.size() * z.size(); ++i) {
        Scene scene = scene_for(request, river, of_the_river);
        scene.crowd->groups.at(0).start_x = x[i % x.size()];
        scene.crowd->groups.at(0).start_z = z[i / x.size()];
        const PeopleRun run = run_people(scene, result);
        law = law_of_drag(scene);
        sum += run.drag();
        squares += run.drag() * run.drag();
        all.driven += run.driven, all.taken += run.taken, all.speed += run.speed;
        all.got += run.got, all.lost += run.lost, all.missing += run.missing;
    }
    const auto places = static_cast<double>(x.size() * z.size());
    const double mean = sum / places;
    result.metrics.push_back({"drag_error", std::abs(mean / law - 1), "1"});
    result.metrics.push_back({"drag", mean, "N"});
    const double variance = std::max(0.0, squares / places - mean * mean);
    if (places > 1) result.metrics.push_back({"drag_scatter", std::sqrt(variance) / law, "1"});
    result.metrics.push_back({"speed", all.speed / places, "m/s"});
    add_balance(all, result);
    return result;
}

// People at random, no two nearer than 0.5 m, on all of the channel.
void scatter(Scene& scene, int n) {
    const AgentGroup one = scene.crowd->groups.at(0);
    scene.crowd->groups.clear();
    for (std::uint64_t draw = 0; static_cast<int>(scene.crowd->groups.size()) < n; ++draw) {
        AgentGroup group = one;
        group.name = std::to_string(draw);
        group.start_x = scene.channel->x.lo + scene.channel->x.length() * crowd::counter_uniform(scene.seed, 1, draw);
        group.start_z = scene.channel->z.lo + scene.channel->z.length() * crowd::counter_uniform(scene.seed, 2, draw);
        const bool free =
            std::none_of(scene.crowd->groups.begin(), scene.crowd->groups.end(), [&](const AgentGroup& g) {
                return std::hypot(g.start_x - group.start_x, g.start_z - group.start_z) < 0.5;
            });
        if (free) scene.crowd->groups.push_back(group);
    }
}

// Adds F per person over the law of drag for one person, and its error against `before`, a value found earlier.
void add_beside(double found, double before, Result& result) {
    result.metrics.push_back({"drag_per_person", found, "1"});
    result.metrics.push_back({"drag_per_person_error", std::abs(found / before - 1), "1"});
}

Result crowd_of(const Request& request, int people, double before) {
    Result result;
    Scene scene = scene_for(request, river);
    scatter(scene, people);
    const PeopleRun run = run_people(scene, result);
    add_beside(run.drag() / (people * law_of_drag(scene)), before, result);
    add_balance(run, result);
    return result;
}

// Ten in file, 0.6 m apart.
Result file_of(const Request& request, Shelter shelter, double before) {
    Result result;
    Scene scene = scene_for(request, river);
    AgentGroup& file = scene.crowd->groups.at(0);
    file.columns = file.count = 10;
    file.pitch_x = 0.6;
    scene.coupling->shelter = shelter;
    const PeopleRun run = run_people(scene, result);
    add_beside(run.drag() / (10 * law_of_drag(scene)), before, result);
    add_balance(run, result);
    return result;
}

// On a slope of 0.01 with a bed of n_b = 0.03: the speed of uniform flow through 0.5 people/m2.
Result run_vegetation(const Request& request) {
    Result result;
    Scene scene = scene_for(request, river,
                            {"/channel/flow=periodic", "/channel/slope=0.01", "/channel/manning_n=0.03",
                             "/channel/velocity_m_s=1.04", "/duration_s=30"});
    scatter(scene, 96);
    const PeopleRun run = run_people(scene, result);
    const double density = 96 / (scene.channel->x.length() * scene.channel->z.length());  // 1/m2
    const double width = crowd::body_width_share * crowd::usual_height, depth = scene.channel->depth;
    const double n_squared = 0.03 * 0.03 + crowd::body_drag * width * density * std::pow(depth, 4.0 / 3) / (2 * 9.81);
    const double expected = std::pow(depth, 2.0 / 3) * std::sqrt(0.01 / n_squared);
    result.metrics.push_back({"speed_error", std::abs(run.speed / expected - 1), "1"});
    result.metrics.push_back({"speed", run.speed, "m/s"});
    result.metrics.push_back({"expected_speed", expected, "m/s"});
    return result;
}

// Sums over frames for a reach of the river: depth, and rho (g h^2 / 2 + q^2 / h), N/m, as means of slices 1 m long.
struct Reach {
    Interval x;
    double depth = 0, momentum = 0;  // sums
    int frames = 0;

    void add(const crowd::WaterView& water, const Scene& scene) {
        const auto slices = static_cast<std::size_t>(std::lround(x.length()));
        std::vector<double> mass(slices, 0), flow(slices, 0);
        for (std::size_t i = 0; i < water.mass.size(); ++i) {
            const double along = static_cast<double>(water.px[i]) - x.lo, m = static_cast<double>(water.mass[i]);
            if (along < 0 || along >= x.length()) continue;
            const auto k = static_cast<std::size_t>(along);
            mass[k] += m;
            flow[k] += m * static_cast<double>(water.vx[i]);
        }
        const double rho = scene.fluid->rest_density, area = scene.channel->z.length(), n = static_cast<double>(slices);
        for (std::size_t k = 0; k < slices; ++k) {
            const double h = mass[k] / (rho * area), q = flow[k] / (rho * area);
            depth += h / n;
            momentum += rho * (0.5 * scene.world->gravity * h * h + q * q / h) / n;
        }
        ++frames;
    }
};

// A row of eight across 8 m in 1.5 m/s: the surface falls over it so far that g h^2 / 2 + q^2 / h loses their drag.
Result run_row(const Request& request) {
    Result result;
    Scene scene = scene_for(request, river, {"/channel/velocity_m_s=1.5", "/duration_s=16"});
    AgentGroup& row = scene.crowd->groups.at(0);
    row.rows = row.count = 8;
    row.columns = 1;
    row.start_x = 12, row.start_z = 0.5;
    Reach before{{14, 20}}, behind{{4, 10}};
    const PeopleRun run =
        run_people(scene, result, [&](const crowd::CrowdWorld& people, const crowd::WaterView& water, double time) {
            if (time <= 0.5 * scene.duration) return;
            before.add(water, people.scene);
            behind.add(water, people.scene);
        });
    const double h = before.depth / before.frames, fall = h - behind.depth / behind.frames;
    const double per_width = run.drag() / scene.channel->z.length();
    // The stretch of 10 m between the middles of the reaches gets its fraction of the driving force.
    const double lost = per_width * (1 - 10 / scene.channel->x.length());
    // d(g h^2 / 2 + q^2 / h) / dh = g h (1 - Fr^2)
    const double speed = scene.channel->velocity, gravity = scene.world->gravity;
    const double expected = lost / (scene.fluid->rest_density * (gravity * h - speed * speed));
    result.metrics.push_back({"fall_error", std::abs(fall / expected - 1), "1"});
    result.metrics.push_back({"fall", fall, "m"});
    result.metrics.push_back({"expected_fall", expected, "m"});
    const double flux = before.momentum / before.frames - behind.momentum / behind.frames;
    result.metrics.push_back({"momentum_error", std::abs(flux / lost - 1), "1"});
    result.metrics.push_back({"drag_per_width", per_width, "N/m"});
    add_balance(run, result);
    return result;
}

// Returns a person with the body response as JSON of the scene.
std::string person(const std::string& name, double x, double z, const std::string& more) {
    return R"({"name": ")" + name + R"(", "start": {"x_m": )" + std::to_string(x) + R"(, "z_m": )" + std::to_string(z) +
           R"(}, "goal": {"x_m": 24, "z_m": 8}, "desired_speed_m_s": 0)" + more + "}";
}
std::vector<std::string> people_by_body(const std::string& groups, const std::string& duration) {
    return {"/crowd/response=measured", "/crowd/groups=[" + groups + "]", "/duration_s=" + duration};
}

// Two braced people, one in mid-stream, one 0.3 m before the wall, neither in the other's wake.
Result run_wall(const Request& request) {
    Result result;
    const Scene scene = scene_for(request, river,
                                  people_by_body(person("middle", 6.03, 4.07, R"(, "skill": "braced")") + "," +
                                                     person("wall", 18.03, 0.3, R"(, "skill": "braced")"),
                                                 "10"));
    std::array<double, 2> slip{}, topple{};
    const PeopleRun run =
        run_people(scene, result, [&](const crowd::CrowdWorld& people, const crowd::WaterView&, double time) {
            for (std::size_t id = 0; id < 2 && time > 0.5 * scene.duration; ++id) {
                slip[id] += people.agents.people.slip[id];
                topple[id] += people.agents.people.topple[id];
            }
        });
    result.metrics.push_back({"slip_error", std::abs(slip[1] / slip[0] - 1), "1"});
    result.metrics.push_back({"topple_error", std::abs(topple[1] / topple[0] - 1), "1"});
    add_balance(run, result);
    return result;
}

// A child of 1.1 m floats in 1 m of water and drifts off: 0.3 s upright, then lying.
Result run_free_body(const Request& request) {
    Result result;
    const Scene scene = scene_for(
        request, river, people_by_body(person("child", 12.03, 4.07, R"(, "height_m": 1.1, "mass_kg": 25)"), "8"));
    double velocity = 0, after_two = 0;
    const PeopleRun run =
        run_people(scene, result, [&](const crowd::CrowdWorld& people, const crowd::WaterView&, double time) {
            velocity = -people.agents.momentary[0].x();
            if (time <= 2) after_two = velocity;
        });
    const crowd::WaterProperties water{scene.fluid->rest_density, scene.world->gravity};
    const double depth = scene.channel->depth, speed = scene.channel->velocity, upright_time = 0.3;
    const double floats = crowd::mass_with_water(25, crowd::submerged_share(1.1, depth), water);
    const double upright = crowd::drag_upright(1.1, depth, water) / floats;
    const double lying = crowd::drag_lying(depth, water) / crowd::mass_with_water(25, 1, water);
    // U - v = U / (1 + U int k / M dt), of water that stays as it is.
    const auto closed_form = [&](double time) {
        return speed - speed / (1 + speed * (upright * upright_time + lying * (time - upright_time)));
    };
    result.metrics.push_back({"velocity_error", std::abs(velocity / closed_form(scene.duration) - 1), "1"});
    result.metrics.push_back({"velocity_error_after_2_s", std::abs(after_two / closed_form(2) - 1), "1"});
    result.metrics.push_back({"velocity", velocity, "m/s"});
    add_balance(run, result);
    return result;
}

// Results of four people at one rate of frames and steps: one slips, one floats, one falls, one walks across.
struct TwoWays {
    double slides = 0, floats = 0, topples = 0, arrives = 0;  // m in 8 s; s
};
TwoWays two_ways_from(const Request& request, double start, double rate, Result& result) {
    std::vector<std::string> values = people_by_body(
        person("slider", start, 4.07, R"(, "skill": "braced", "ground_friction": 0.2)") + "," +
            person("floater", start, 7.03, R"(, "height_m": 1.1, "mass_kg": 25)") + "," +
            person("toppler", 3.03, 2.07, R"(, "skill": "unaware")") +
            R"(,{"name": "walker", "start": {"x_m": 9, "z_m": 1}, "goal": {"x_m": 9, "z_m": 7}, "skill": "braced"})",
        "8");
    values.push_back(assign("/frame_rate_hz", rate));
    values.push_back(assign("/crowd/step_rate_hz", rate));
    const Scene scene = scene_for(request, river, values);
    TwoWays found;
    const PeopleRun run =
        run_people(scene, result, [&](const crowd::CrowdWorld& people, const crowd::WaterView&, double time) {
            found.slides = start - people.agents.position[0].x();
            found.floats = start - people.agents.position[1].x();
            const crowd::PersonState state = people.agents.people.condition[2].state;
            if (found.topples == 0 && state == crowd::PersonState::toppled) found.topples = time;
            if (people.agents.outcome[3] == crowd::Outcome::active) found.arrives = time;
        });
    return found;
}
// Returns the mean over starts 0.11 m apart: one path in particles differs by 1 % (standard deviation) between them.
TwoWays two_ways_at(const Request& request, double rate, Result& result) {
    constexpr int starts = 6;
    TwoWays mean;
    for (int k = 0; k < starts; ++k) {
        const TwoWays found = two_ways_from(request, 20.03 + 0.11 * k, rate, result);
        mean.slides += found.slides / starts;
        mean.floats += found.floats / starts;
        mean.topples += found.topples / starts;
        mean.arrives += found.arrives / starts;
    }
    return mean;
}
Result run_rates(const Request& request) {
    Result result;
    const TwoWays finest = two_ways_at(request, 120, result);
    std::array<double, 3> worst{};
    for (const double rate : {15.0, 30.0, 60.0}) {
        const TwoWays now = two_ways_at(request, rate, result);
        worst[0] =
            std::max({worst[0], std::abs(now.slides / finest.slides - 1), std::abs(now.floats / finest.floats - 1)});
        worst[1] = std::max(worst[1], std::abs(now.topples - finest.topples));
        worst[2] = std::max(worst[2], std::abs(now.arrives / finest.arrives - 1));
    }
    result.metrics.push_back({"drift_difference", worst[0], "1"});
    result.metrics.push_back({"topples_difference", worst[1], "s"});
    result.metrics.push_back({"arrival_difference", worst[2], "1"});
    result.metrics.push_back({"slides", finest.slides, "m"});
    result.metrics.push_back({"floats", finest.floats, "m"});
    result.metrics.push_back({"topples", finest.topples, "s"});
    result.metrics.push_back({"arrives", finest.arrives, "s"});
    return result;
}

}  // namespace

namespace {

Case drag_case(const char* name, const char* truth, std::vector<double> spacings, Result (*run)(const Request&)) {
    return {.name = name, .truth = truth, .reference = "law of drag", .spacings = std::move(spacings), .run = run};
}

}  // namespace

Case people_drag_case() {
    return drag_case("people_drag",
                     "One person of 1.7 m stands in a recirculating river of 1 m/s, 1 m deep, and pushes it: its drag "
                     "is rho C_D B h U^2 / 2, and all that drives the river.",
                     {0.4642, 0.25, 0.125}, [](const Request& request) { return drag_in(request, {}); });
}

Case people_drag_half_deep_case() {
    // Between positions the drag differs by 2 % (standard deviation), for a minute and longer.
    return drag_case("people_drag_half_deep", "The same in 0.5 m of water, as a mean over four places.", {0.25, 0.125},
                     [](const Request& request) {
                         return drag_in(request, {"/channel/depth_m=0.5"}, {12.03, 12.1}, {4, 4.07});
                     });
}

Case people_drag_slow_case() {
    return drag_case("people_drag_slow", "The same at 0.5 m/s.", {0.25}, [](const Request& request) {
        // So long that the stream goes as far as in 16 s at 1 m/s.
        return drag_in(request, {"/channel/velocity_m_s=0.5", "/duration_s=32"});
    });
}

Case people_drag_fast_case() {
    return drag_case("people_drag_fast", "The same at 2.5 m/s, Froude number 0.8.", {0.25}, [](const Request& request) {
        return drag_in(request, {"/channel/velocity_m_s=2.5", "/duration_s=6.4"});
    });
}

Case people_crowd_case() {
    return drag_case("people_crowd",
                     "96 people stand at random in the same river, 0.5 people/m2: the drag of each is 1.017 times the "
                     "law in another draw, and together they take what drives it.",
                     {0.25}, [](const Request& request) { return crowd_of(request, 96, 1.017); });
}

Case people_crowd_dense_case() {
    return drag_case("people_crowd_dense", "192 people, 1 a square metre: 1.10 times the law in another draw.", {0.25},
                     [](const Request& request) { return crowd_of(request, 192, 1.10); });
}

Case people_file_case() {
    return {.name = "people_file",
            .truth =
                "Ten in file, 0.6 m apart, sheltered by wakes: the mean drag is 0.178 of that of one alone by the "
                "wakes' closed form, 0.13 to 0.2 by what Li et al. (2026) found of dense groups.",
            .reference = "Blevins 2005",
            .spacings = {0.25},
            .run = [](const Request& request) { return file_of(request, Shelter::wake, 0.178); }};
}

Case people_file_open_case() {
    return drag_case("people_file_open",
                     "The same ten without the wakes of /coupling/shelter: those that particles of 0.25 m show leave "
                     "0.565 of the drag, as a prototype found.",
                     {0.25}, [](const Request& request) { return file_of(request, Shelter::off, 0.565); });
}

Case people_wall_case() {
    return {.name = "people_wall",
            .truth = "Who stands at the wall of a river has the slip and topple demands of who stands in mid-stream.",
            .reference = "symmetry",
            .spacings = {0.25},
            .run = run_wall};
}

Case people_free_body_case() {
    return {.name = "people_free_body",
            .truth = "A body that floats in 1 m/s of water takes its velocity as v = U - U / (1 + k U t / M).",
            .reference = "closed form",
            .spacings = {0.25},
            .run = run_free_body};
}

Case people_rates_case() {
    return {.name = "people_rates",
            .truth =
                "15, 30, 60 and 120 frames and steps a second of two who push the water: one drifts away, one "
                "walks across.",
            .reference = "120 frames a second",
            .spacings = {0.25},
            .run = run_rates};
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
