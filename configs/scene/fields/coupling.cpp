// Keys of the coupling and of the events.

#include "configs/scene/coupling.hpp"

#include <algorithm>

#include "configs/scene/crowd.hpp"
#include "configs/scene/fields/lists.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/mixed_window.hpp"
#include "configs/scene/scene_frames.hpp"

namespace wade {

namespace {

// Returns true if any agent takes momentum by its tau (Eq. 5 to 9). Agents of the response `measured` sample the flow and touch no
// particles.
bool has_people_by_tau(const Scene& scene) {
    const std::vector<AgentGroup>& groups = scene.crowd->groups;
    const auto has_tau = [](const AgentGroup& group) { return group.tau || !group.tau_history.empty(); };
    return scene.crowd->response != ResponseKind::measured || groups.empty() || !scene.events.empty() ||
           std::any_of(groups.begin(), groups.end(), has_tau);
}

bool has_contacts(const Scene& scene) {
    return has_people_by_tau(scene) || scene.crowd->ragdoll.condition != RagdollCondition::off ||
           scene.fluid->model == ModelKind::automatic;
}

}  // namespace

void fields(Coupling& coupling, Fields& f, const Scene& scene) {
    const Acting by_tau{"with /crowd/response \"paper\" or a tau of a group", has_people_by_tau};
    const Acting in_contact{
        "with /crowd/response \"paper\", a tau of a group, a /crowd/ragdoll/condition or /fluid/model \"auto\"",
        has_contacts};
    const Acting of_agents{
        "with /crowd/response \"paper\", a tau of a group, a /crowd/ragdoll/condition, /fluid/model \"auto\" or "
        "/coupling/agents_stream",
        [](const Scene& its) { return has_contacts(its) || its.coupling->agents_stream != AgentsStream::off; }};
    f.acts_only(in_contact, [&] {
        f.choice(
            "contact_rule", coupling.contact_rule,
            "Distance, in the ground plane, below which an agent and a particle touch. difference: |agent_radius_m - "
            "particle_radius_m|, as in the authors' code. sum: agent_radius_m + particle_radius_m, as in the paper's "
            "text.");
    });
    f.acts_only(by_tau, [&] {
        f.choice("rule", coupling.rule,
                 "per_frame: Eq. 9 once a step of the crowd, from the velocity that the agent has without water. "
                 "continuous: "
                 "agents tend to the velocity of Eq. 9 within 1/30 s, so that they have inertia; the steady state is "
                 "that of "
                 "Eq. 9 at any rate, and the path after a change of the water is the same for steps of any length.");
        f.number(
            "sampling_rate_hz", coupling.sampling_rate, "1/s", from(0).to(1e5),
            "Times a second at which the rule continuous looks for the water in contact: several times within a step, "
            "with each particle moved on at its velocity from where it was at the begin of the step; once a step if 0 "
            "or not above the crowd's step rate. Agents go along with the particles that push them, which long steps "
            "do not see. Needs rule continuous if above 0.");
    });
    f.choice(
        "agents_stream", coupling.agents_stream,
        "The way back, from the crowd to the water. serial: the crowd publishes its agents and the water waits "
        "for them before each of its frames. parallel: the water takes the agents of one frame earlier, so that "
        "both work at the same time. The water of the mixed model has its particles where they are; none is moved by "
        "them without two_way.",
        preset_but("serial where the model mixed needs it to know where people are",
                   [&] { return mixed_needs_agents(scene) ? KeyValue(name_of(AgentsStream::serial)) : KeyValue(); }));
    f.flag(
        "two_way", coupling.two_way,
        "People push back: what momentum the water gives them it loses, in the models dfsph, shallow_water and mixed, "
        "among "
        "which auto then chooses. "
        "Whoever answers by the response paper pushes with the drag of its body. Sets agents_stream to parallel where "
        "it is "
        "off.");
    f.acts_only({"with /crowd/response \"measured\" or /coupling/two_way",
                 [](const Scene& s) { return s.crowd->response == ResponseKind::measured || s.coupling->two_way; }},
                [&] {
                    f.choice("shelter", coupling.shelter,
                             "How people behind people feel the water. wake: slower, by the deepest of the wakes in "
                             "which they stand; those wakes are finer than the water shows. Felt in the response "
                             "measured and, with two_way, in what they push.");
                });
    f.acts_only(of_agents, [&] {
        f.number("agent_radius_m", coupling.agent_radius, "m", above(0).to(1),
                 "r_a; at most 1, so that a contact lies within the 3 x 3 cells round an agent.");
    });
    f.acts_only(in_contact, [&] {
        f.number("particle_radius_m", coupling.particle_radius, "m", above(0).to(1),
                 "r_p, of contacts only: neither mass nor spacing of the particles follows from it.");
    });
    f.once_read([&]() -> std::optional<std::string> {
        if (coupling.two_way && coupling.agents_stream == AgentsStream::off) {
            coupling.agents_stream = AgentsStream::parallel;
        }
        return std::nullopt;
    });
}

void fields(TauPoint& point, Fields& f) {
    f.number("time_s", point.time, "s", from(0).to(1e6),
             "Time, not smaller than that of the point before; two points of one time make a jump.", required);
    f.number("tau", point.tau, "", from(0).to(1), "tau at this time.", required);
}

void fields(TauEvent& event, Fields& f, double frame_rate) {
    std::optional<std::uint64_t> frame = event.frame;
    std::optional<double> time;
    f.whole("frame", frame, "", from(0).to(1e9),
            "Frame from which on the new tau holds. Exactly one of frame and time_s is set.", otherwise("from time_s"));
    f.shorthands([&] {
        f.number("time_s", time, "s", from(0).to(1e6), "Time instead of a frame: the first frame at or after it.",
                 otherwise("from frame"));
    });
    f.whole("agent", event.agent, "", from(0).to(999999999), "Number of the agent.", otherwise("none"));
    f.text("group", event.group, {.shortest = 1}, "Name of the group.", otherwise("none"));
    f.number("tau", event.tau, "", from(0).to(1), "The new tau.", required);
    f.once_read([&]() -> std::optional<std::string> {
        if (frame.has_value() == time.has_value()) {
            return std::string("an event needs exactly one of \"frame\" and \"time_s\", and has ") +
                   (frame ? "both." : "neither.");
        }
        event.frame = frame ? *frame : frame_at(*time, frame_rate);
        return std::nullopt;
    });
}

}  // namespace wade
