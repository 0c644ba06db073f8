#pragma once
// Effect of the water on the people of a scene: impulse on standing people, outcome of walking people.
//
// Water and crowd run in one process, frame by frame, as the two programs do in lockstep: the water computes frame k,
// the crowd takes step k through it. The crowd acts on the water as the scene has it.
//
//   p_a(k)  = sum_i m_i v_i over the particles that touch agent a in step k: Eq. 5 with the scene's contact rule,
//             horizontal, kg m/s
//   I_a     = sum_k p_a(k) dt, the time integral of that momentum, kg m; dt is the length of a step of the crowd
//   L_a     = sum_k |p_a(k)| dt, kg m: the same without the cancelling of opposite directions, "load"
//
// By Eq. 9 the velocity of an agent depends on the water through p_a and the mass in contact alone, so I_a is what the
// walking of agents is sensitive to; I_a divided by the duration is the mean momentum in contact with the agent.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "configs/scene/coupling.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/crowd_world.hpp"
#include "fluid_server/fluid_model.hpp"
#include "validation_case.hpp"

namespace wade::validation {

// A standing person: desired speed 0 and tau 0, so that the position is the same in every run.
struct StandingAgent {
    std::uint32_t id = 0;
    crowd::Vector2d impulse = crowd::Vector2d::Zero();  // I_a, kg m
    double load = 0;                                    // L_a, kg m
};

struct WalkingAgent {
    std::uint32_t id = 0;
    crowd::Outcome outcome = crowd::Outcome::active;
    double time = 0;                                  // of arrival or death, s; the end of the run if still active
    crowd::Vector2d place = crowd::Vector2d::Zero();  // at that time, m
};

struct ImpulseRun {
    std::vector<StandingAgent> standing;  // ascending id
    std::vector<WalkingAgent> walking;    // ascending id
};

// Runs the scene with any model of the water; notes cost and model in `result`.
[[nodiscard]] ImpulseRun run_impulse(const Scene& scene, Result& result);

// The finest run of a case, from data/<name>_standing.csv and data/<name>_walking.csv beside this file. Empty if
// the request asks for no comparison. Throws ConfigurationError if a file is missing, and std::runtime_error, naming file
// and line, if one cannot be read.
[[nodiscard]] ImpulseRun read_reference(const Request& request, const std::string& name);

// Adds to `result` the curves of the run and, unless the reference is empty, its errors against it:
//   impulse_median, impulse_p95  |I_a - I_a,ref| / L_a,ref over the standing agents with L_a,ref > 0. The load in the
//                                denominator keeps an agent in a wake, where the impulse cancels, from dividing by
//                                nearly nothing; in a stream of one direction L = |I|.
//   load_total                   |sum L_a - sum L_a,ref| / sum L_a,ref: what remains once the scatter among agents
//                                cancels
//   outcome_changed              fraction of the walking agents with another outcome
//   end_time_median              s, over the walking agents that arrive or die in both runs in the same way
//   end_place_median             m, over all walking agents: distance of their last positions
// Throws std::runtime_error if the two runs are not of the same agents.
void compare_impulse(const ImpulseRun& run, const ImpulseRun& reference, Result& result);

// Runs the case: configs/validation/<name>.json against the reference <name>.
[[nodiscard]] Result run_impulse_case(const Request& request, const std::string& name);

// The error of the whole sample against a stream of given momentum in contact: median over the standing agents of
// |I_a - I| / |I|. impulse: I, kg m
void compare_with_uniform_stream(const ImpulseRun& run, const crowd::Vector2d& impulse, Result& result);

// A frame in private memory, instead of the shared one.
class FrameMemory {
 public:
    explicit FrameMemory(const fluid::FluidModel& model) : column_(model.column_width()) {
        const std::uint32_t capacity = model.capacity();
        for (std::vector<float>* v : {&mass_, &vx_, &vy_, &vz_, &px_, &py_, &pz_}) v->resize(capacity);
    }
    void take(const fluid::FluidModel& model, std::uint64_t frame) {
        shm::FrameFields slot;
        slot.frame = frame;
        slot.mass = mass_;
        slot.vx = vx_, slot.vy = vy_, slot.vz = vz_;
        slot.px = px_, slot.py = py_, slot.pz = pz_;
        count_ = model.write_frame(slot);
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] crowd::WaterView ground_view() const {
        const auto some = [&](const std::vector<float>& v) { return std::span<const float>(v).first(count_); };
        crowd::WaterView view;
        view.mass = some(mass_);
        view.px = some(px_), view.pz = some(pz_);
        view.vx = some(vx_), view.vz = some(vz_);
        view.column = {column_[0], column_[1]};
        return view;
    }

 private:
    std::array<double, 2> column_;  // width along x and z, m
    std::vector<float> mass_, vx_, vy_, vz_, px_, py_, pz_;
    std::size_t count_ = 0;
};

// Hands the agents to the water, as the two programs do with /coupling/agents_stream; with `parallel` one frame late.
class WayBack {
 public:
    void give(const crowd::CrowdWorld& people, std::uint64_t frame, fluid::FluidModel& water) {
        const AgentsStream stream = people.scene.coupling->agents_stream;
        if (stream == AgentsStream::off) return;
        Frame now = gather(people);
        const bool parallel = stream == AgentsStream::parallel;
        const Frame& due = parallel ? before_ : now;
        if (!parallel || frame > 1) hand_over(due, frame, water);
        before_ = std::move(now);
    }

 private:
    struct Frame {
        std::vector<float> x, z, vx, vz, jx, jz, submerged, spread, state, none;
    };

    Frame gather(const crowd::CrowdWorld& people) {
        const crowd::Agents& agents = people.agents;
        Frame f;
        sent_.resize(agents.size(), crowd::Vector2d::Zero());
        for (std::size_t id = 0; id < agents.size(); ++id) {
            const bool walks = agents.outcome[id] == crowd::Outcome::active;
            f.x.push_back(static_cast<float>(agents.position[id].x()));
            f.z.push_back(static_cast<float>(agents.position[id].y()));
            f.vx.push_back(walks ? static_cast<float>(agents.velocity[id].x()) : 0);
            f.vz.push_back(walks ? static_cast<float>(agents.velocity[id].y()) : 0);
            f.state.push_back(static_cast<float>(walks ? shm::agent_walking : shm::agent_arrived));
            if (!people.pushing) continue;
            const crowd::Vector2d impulse = people.pushing->given[id] - sent_[id];
            sent_[id] = people.pushing->given[id];
            f.jx.push_back(static_cast<float>(impulse.x()));
            f.jz.push_back(static_cast<float>(impulse.y()));
            f.submerged.push_back(static_cast<float>(people.pushing->submerged[id]));
            f.spread.push_back(static_cast<float>(people.feeling->spread));
        }
        f.none.assign(agents.size(), 0);
        return f;
    }

    static void hand_over(const Frame& f, std::uint64_t frame, fluid::FluidModel& water) {
        water.take_agents({frame, frame, f.none, f.vx, f.none, f.vz, f.x, f.none, f.z, f.none, f.none, f.state, f.jx,
                           f.jz, f.submerged, f.spread});
    }

    Frame before_;
    std::vector<crowd::Vector2d> sent_;
};

// Momentum exchange between people and water (/coupling/two_way): sums over the second half of a run, when the river
// has settled, and the momentum balance of the whole run.
struct PeopleRun {
    double half = 0;                                // s
    std::vector<crowd::Vector2d> impulse;           // by id, N s
    double driven = 0;                              // impulse of the force that holds the bulk speed, N s, towards -x
    double taken = 0;                               // and what people took of it, N s: a frame or two after they got it
    double speed = 0;                               // mean of the stream, m/s
    crowd::Vector2d got = crowd::Vector2d::Zero();  // of the whole run, N s
    crowd::Vector2d lost = crowd::Vector2d::Zero();  // and what the water says
    crowd::Vector2d missing = crowd::Vector2d::Zero();
    std::unique_ptr<fluid::FluidModel> water;

    [[nodiscard]] double drag() const {  // of all people, N, towards -x
        return -std::accumulate(impulse.begin(), impulse.end(), crowd::Vector2d(crowd::Vector2d::Zero())).x() / half;
    }
};

// Called after each frame, at its time, s.
using Look = std::function<void(const crowd::CrowdWorld&, const crowd::WaterView&, double)>;

// Runs the scene like run_impulse, with momentum exchange between people and water.
[[nodiscard]] PeopleRun run_people(const Scene& scene, Result& result, const Look& look = {});

}  // namespace wade::validation
