// Crowds in difficult situations; the water, if there is any, is checked as in the other cases.

#include <algorithm>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/crowd_world.hpp"
#include "stability_case.hpp"
#include "water_run.hpp"

namespace wade::stability {

namespace {

using crowd::CrowdWorld;
using crowd::Vector2d;
using fluid::FluidWorld;
using fluid::Particles;

// A crowd that walks through each frame of the water, and what must hold for every agent after each of its steps.
class WatchedCrowd {
 public:
    explicit WatchedCrowd(const Scene& scene) : crowd_(crowd::make_crowd(scene)) {}

    void walk(const FluidWorld& world, double time) {
        const Particles& p = world.particles();
        mass_.assign(p.count, world.particle_mass());
        crowd::WaterView water;
        water.mass = mass_;
        water.px = {p.x.data(), p.count};
        water.pz = {p.z.data(), p.count};
        water.vx = {p.vx.data(), p.count};
        water.vz = {p.vz.data(), p.count};
        double fastest = 0;
        for (std::size_t i = 0; i < p.count; ++i) {
            fastest = std::max(fastest, std::hypot(static_cast<double>(p.vx[i]), static_cast<double>(p.vz[i])));
        }
        while (static_cast<double>(crowd_.steps + 1) * crowd_.dt <= time + 1e-9) {
            const std::vector<std::uint32_t> walking = crowd_.active;
            crowd::step(crowd_, water);
            for (const std::uint32_t id : walking) look_at(id, fastest);
        }
    }

    void report(Result& result) const {
        result.nonfinite += nonfinite_;
        const std::size_t known = crowd_.active.size() + crowd_.arrived + crowd_.dead;
        check_at_most(result, "agents_missing", static_cast<double>(crowd_.agents.size() - known), 0);
        check_at_most(result, "agents_in_solids", static_cast<double>(in_solids_), 0);
        check_at_most(result, "agents_out_of_the_world", static_cast<double>(outside_), 0);
        // Eq. 9 is a weighted mean of the walking velocity and those of the water in contact.
        check_at_most(result, "speed_over_fastest", speed_ratio_, 1 + 1e-6);
        note(result, "agents_arrived", static_cast<double>(crowd_.arrived));
        note(result, "agents_dead", static_cast<double>(crowd_.dead));
    }

    [[nodiscard]] const CrowdWorld& crowd() const { return crowd_; }

 private:
    void look_at(std::uint32_t id, double fastest_water) {
        const crowd::Agents& agents = crowd_.agents;
        const Vector2d& x = agents.position[id];
        const Vector2d& v = agents.velocity[id];
        if (!x.allFinite() || !v.allFinite() || !agents.heading[id].allFinite()) {
            ++nonfinite_;
            return;
        }
        const World& world = crowd_.scene.world;
        // An agent that falls over the edge at x = 0 is dead and outside.
        const bool fallen = agents.outcome[id] == crowd::Outcome::dead && x.x() < 0;
        if (!fallen && (x.x() < 0 || x.x() > world.length || x.y() < 0 || x.y() > world.width)) ++outside_;
        for (const Obstacle& o : crowd_.scene.obstacles) {
            if (x.x() > o.x.lo && x.x() < o.x.hi && x.y() > o.z.lo && x.y() < o.z.hi) ++in_solids_;
        }
        const double bound = std::max(agents.desired_speed[id], fastest_water);
        if (bound > 0) speed_ratio_ = std::max(speed_ratio_, v.norm() / bound);
    }

    CrowdWorld crowd_;
    std::vector<float> mass_;
    std::uint64_t nonfinite_ = 0;  // agents, summed over steps, as the next two
    std::uint64_t in_solids_ = 0;
    std::uint64_t outside_ = 0;
    double speed_ratio_ = 0;
};

Result run_with_crowd(const Scene& scene, WatchedCrowd& people) {
    Hooks hooks;
    hooks.after_frame = [&](const FluidWorld& world, double time, Result&) { people.walk(world, time); };
    Result result = run_water(scene, hooks);
    people.report(result);
    return result;
}

// Particles under the agents' feet vanish at the outlet and come in again at the emitter.
Result recycled_under_agents(const Request& request) {
    const Scene scene = scene_for(request, "recycled_under_agents", {"/duration_s=3", "/channel/z_max_m=4"});
    WatchedCrowd people(scene);
    std::uint64_t recycled = 0;
    Hooks hooks;
    hooks.after_frame = [&](const FluidWorld& world, double time, Result&) {
        people.walk(world, time);
        recycled = world.emitter().recycled;
    };
    Result result = run_water(scene, hooks);
    people.report(result);
    check_at_least(result, "particles_recycled", static_cast<double>(recycled), 100);
    return result;
}

// Eighty people at 6 per m2 between a wall and a flood.
Result crowd_against_wall(const Request& request) {
    const Scene scene = scene_for(request, "crowd_against_wall", {"/duration_s=3", "/fluid/particle_spacing_m=0.4"});
    WatchedCrowd people(scene);
    return run_with_crowd(scene, people);
}

// A marker belongs to the first of equally near agents, so they leave one after the other. Half of them must leave
// within the scene's minute: enough to tell leaving from standing for ever.
Result agents_at_one_point(const Request& request) {
    Scene scene = scene_for(request, "agents_at_one_point");
    // The loader refuses agents nearer than a millimetre, so they are put together here.
    scene.crowd->groups.at(0).pitch_x = 0;
    scene.crowd->groups.at(0).pitch_z = 0;
    WatchedCrowd people(scene);
    Result result = run_with_crowd(scene, people);
    const AgentGroup& group = scene.crowd->groups.at(0);
    const Vector2d start(group.start_x, group.start_z);
    std::size_t left = people.crowd().arrived;
    for (const std::uint32_t id : people.crowd().active) {
        left += (people.crowd().agents.position[id] - start).norm() > 0.1 ? 1U : 0U;
    }
    check_at_least(result, "share_that_left", static_cast<double>(left) / static_cast<double>(group.count), 0.5);
    return result;
}

// One starts on its goal: it has arrived after the first step, and no direction towards it is needed.
Result agent_on_goal(const Request& request) {
    const Scene scene = scene_for(request, "agent_on_goal");
    WatchedCrowd people(scene);
    Result result = run_with_crowd(scene, people);
    check_at_least(result, "arrived_or_walking", static_cast<double>(people.crowd().arrived), 1);
    return result;
}

}  // namespace

std::vector<Case> crowd_cases() {
    return {
        {"recycled_under_agents", "particles are recycled while agents stand in them", recycled_under_agents},
        {"crowd_against_wall", "a dense crowd is pressed against a wall by water", crowd_against_wall},
        {"agents_at_one_point", "agents start at one point: a division by their distance", agents_at_one_point, false},
        {"agent_on_goal", "an agent stands on its goal: a direction of length zero", agent_on_goal, false},
    };
}

}  // namespace wade::stability
