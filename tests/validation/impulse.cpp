#include "impulse.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"
#include "crowd_client/crowd_world.hpp"
#include "fluid_server/make_model.hpp"
#include "profiles.hpp"
#include "run.hpp"

namespace wade::validation {

namespace {

using crowd::Outcome;
using crowd::Vector2d;

bool stands(const crowd::Agents& agents, std::size_t id) {
    return agents.desired_speed[id] == 0 && agents.tau[id] == 0;
}

// The two programs let the crowd take a step a frame if their rates are the same; so it is here.
void check_rates(const Scene& scene) {
    if (scene.crowd->step_rate == scene.frame_rate) return;
    throw ConfigurationError(scene.name + ": /crowd/step_rate_hz is " + std::to_string(scene.crowd->step_rate) +
                             ", this case allows only that of /frame_rate_hz, " + std::to_string(scene.frame_rate));
}

void add_step(const crowd::CrowdWorld& crowd, const std::vector<std::uint32_t>& ids, std::vector<Vector2d>& impulse,
              std::vector<double>& load) {
    for (std::size_t k = 0; k < ids.size(); ++k) {
        const Vector2d& momentum = crowd.contacts[k].momentum;
        impulse[ids[k]] += momentum * crowd.dt;
        load[ids[k]] += std::sqrt(momentum.squaredNorm()) * crowd.dt;
    }
}

void add_curves(const ImpulseRun& run, const ImpulseRun& reference, Result& result) {
    Curve impulse{"impulse", {"agent", "impulse_x_kg_m", "impulse_z_kg_m", "load_kg_m"}, {}};
    const bool compared = !reference.standing.empty();
    if (compared) impulse.columns.insert(impulse.columns.end(), {"finest_impulse_x_kg_m", "finest_load_kg_m"});
    for (std::size_t k = 0; k < run.standing.size(); ++k) {
        const StandingAgent& agent = run.standing[k];
        impulse.rows.push_back({static_cast<double>(agent.id), agent.impulse.x(), agent.impulse.y(), agent.load});
        if (!compared) continue;
        impulse.rows.back().push_back(reference.standing[k].impulse.x());
        impulse.rows.back().push_back(reference.standing[k].load);
    }
    Curve outcome{"outcome", {"agent", "outcome_0_active_1_arrived_2_dead", "time_s", "x_m", "z_m"}, {}};
    for (const WalkingAgent& agent : run.walking) {
        outcome.rows.push_back({static_cast<double>(agent.id), static_cast<double>(agent.outcome), agent.time,
                                agent.place.x(), agent.place.y()});
    }
    result.curves.push_back(std::move(impulse));
    result.curves.push_back(std::move(outcome));
}

template <typename Agent>
bool same_ids(const std::vector<Agent>& a, const std::vector<Agent>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Agent& left, const Agent& right) { return left.id == right.id; });
}

double length_of(const Vector2d& v) {
    return std::sqrt(v.squaredNorm());
}

void compare_standing(const ImpulseRun& run, const ImpulseRun& reference, Result& result) {
    std::vector<double> errors;
    double load = 0;
    double true_load = 0;
    for (std::size_t k = 0; k < run.standing.size(); ++k) {
        const StandingAgent& truth = reference.standing[k];
        load += run.standing[k].load;
        true_load += truth.load;
        if (truth.load > 0) errors.push_back(length_of(run.standing[k].impulse - truth.impulse) / truth.load);
    }
    result.metrics.push_back({"impulse_median", quantile(errors, 0.5), "1"});
    result.metrics.push_back({"impulse_p95", quantile(errors, 0.95), "1"});
    result.metrics.push_back({"load_total", std::abs(load / true_load - 1), "1"});
}

void compare_walking(const ImpulseRun& run, const ImpulseRun& reference, Result& result) {
    std::vector<double> times;
    std::vector<double> places;
    double changed = 0;
    for (std::size_t k = 0; k < run.walking.size(); ++k) {
        const WalkingAgent& agent = run.walking[k];
        const WalkingAgent& truth = reference.walking[k];
        places.push_back(length_of(agent.place - truth.place));
        if (agent.outcome != truth.outcome) {
            ++changed;
        } else if (agent.outcome != Outcome::active) {
            times.push_back(std::abs(agent.time - truth.time));
        }
    }
    result.metrics.push_back({"outcome_changed", changed / static_cast<double>(run.walking.size()), "1"});
    result.metrics.push_back({"end_time_median", quantile(times, 0.5), "s"});
    result.metrics.push_back({"end_place_median", quantile(places, 0.5), "m"});
}

}  // namespace

ImpulseRun run_impulse(const Scene& scene, Result& result) {
    check_rates(scene);
    const std::unique_ptr<fluid::FluidModel> water = fluid::make_fluid_model(scene);
    crowd::CrowdWorld people = crowd::make_crowd(scene);
    FrameMemory memory(*water);
    suit_to_stream(people, {{}, 0, memory.ground_view().column});
    WayBack way_back;
    std::vector<Vector2d> impulse(people.agents.size(), Vector2d::Zero());
    std::vector<double> load(people.agents.size(), 0);

    result.model = water->name();
    // A million ticks a frame: whole numbers for any rate.
    constexpr std::uint64_t ticks = 1000000;
    const auto per_second = static_cast<std::uint64_t>(std::llround(scene.frame_rate * static_cast<double>(ticks)));
    double density_error = 0;
    const std::uint64_t frames = frames_of(scene);
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
        const double cpu = process_cpu_time();
        const double wall = wall_time();
        way_back.give(people, frame, *water);
        const shm::Diagnostics d = water->advance_frame({(frame - 1) * ticks, frame * ticks, per_second});
        memory.take(*water, frame);
        result.solver_cpu_time += process_cpu_time() - cpu;
        result.solver_wall_time += wall_time() - wall;
        result.steps += d.sub_steps;
        result.particle_steps += static_cast<double>(d.sub_steps) * static_cast<double>(memory.count());
        if (!std::isnan(d.max_density_error)) density_error = std::max(density_error, d.max_density_error);

        const std::vector<std::uint32_t> ids = people.active;  // the contacts of this step belong to these
        crowd::step(people, memory.ground_view());
        add_step(people, ids, impulse, load);
    }
    result.particles = memory.count();
    result.simulated_time = static_cast<double>(frames) / scene.frame_rate;
    result.metrics.push_back({"max_density_error", density_error, "1"});

    ImpulseRun run;
    for (std::uint32_t id = 0; id < people.agents.size(); ++id) {
        const crowd::Agents& agents = people.agents;
        if (stands(agents, id)) {
            run.standing.push_back({id, impulse[id], load[id]});
            continue;
        }
        const bool active = agents.outcome[id] == Outcome::active;
        const double time = active ? result.simulated_time : static_cast<double>(agents.end_step[id]) * people.dt;
        run.walking.push_back({id, agents.outcome[id], time, agents.position[id]});
    }
    return run;
}

void compare_impulse(const ImpulseRun& run, const ImpulseRun& reference, Result& result) {
    const bool compared = !reference.standing.empty() || !reference.walking.empty();
    if (compared && !(same_ids(run.standing, reference.standing) && same_ids(run.walking, reference.walking))) {
        throw std::runtime_error(
            "the agents of the scene are not those of the reference in tests/validation/data: make it anew with "
            "tools/wade speed-vs-error --reference CASE --spacing D");
    }
    add_curves(run, reference, result);
    if (!compared) return;
    compare_standing(run, reference, result);
    compare_walking(run, reference, result);
}

void compare_with_uniform_stream(const ImpulseRun& run, const Vector2d& impulse, Result& result) {
    std::vector<double> errors;
    for (const StandingAgent& agent : run.standing)
        errors.push_back(length_of(agent.impulse - impulse) / length_of(impulse));
    result.metrics.push_back({"uniform_stream_median", quantile(errors, 0.5), "1"});
}

Result run_impulse_case(const Request& request, const std::string& name) {
    const ImpulseRun reference = read_reference(request, name);
    Result result;
    const ImpulseRun run = run_impulse(scene_for(request, "validation/" + name + ".json"), result);
    compare_impulse(run, reference, result);
    return result;
}

namespace {

double mass_of(const crowd::WaterView& view) {
    return std::accumulate(view.mass.begin(), view.mass.end(), 0.0,
                           [](double sum, float m) { return sum + static_cast<double>(m); });
}

}  // namespace

PeopleRun run_people(const Scene& scene, Result& result, const Look& look) {
    PeopleRun run;
    run.water = fluid::make_fluid_model(scene);
    crowd::CrowdWorld people = crowd::make_crowd(scene);
    FrameMemory memory(*run.water);
    suit_to_stream(people, {{}, 0, memory.ground_view().column});
    WayBack way_back;
    constexpr std::uint64_t ticks = 1000000;
    const auto per_second = static_cast<std::uint64_t>(std::llround(scene.frame_rate * static_cast<double>(ticks)));
    const std::uint64_t frames = frames_of(scene), first = frames / 2 + 1;
    std::vector<crowd::Vector2d> before;
    crowd::Vector2d handed = crowd::Vector2d::Zero();
    const double cpu = process_cpu_time();
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
        // Parallel: the impulses of the step before last are what this frame takes.
        run.got = handed;
        handed = std::accumulate(people.pushing->given.begin(), people.pushing->given.end(),
                                 crowd::Vector2d(crowd::Vector2d::Zero()));
        if (people.scene.coupling->agents_stream == AgentsStream::serial) run.got = handed;
        way_back.give(people, frame, *run.water);
        if (frame == first) before = people.pushing->given;
        const shm::Diagnostics d = run.water->advance_frame({(frame - 1) * ticks, frame * ticks, per_second});
        memory.take(*run.water, frame);
        result.steps += d.sub_steps;
        if (frame >= first) run.taken -= d.taken_by_people_x_n_s - run.lost.x();
        run.lost = {d.taken_by_people_x_n_s, d.taken_by_people_z_n_s};
        run.missing = {d.missing_for_people_x_n_s, d.missing_for_people_z_n_s};
        crowd::step(people, memory.ground_view());
        const double dt = 1 / scene.frame_rate;
        if (look) look(people, memory.ground_view(), static_cast<double>(frame) * dt);
        if (frame < first) continue;
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

}  // namespace wade::validation
