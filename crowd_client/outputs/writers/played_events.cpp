#include "crowd_client/outputs/writers/played_events.hpp"

#include <algorithm>

#include "configs/errors/exit_code.hpp"
#include "configs/json/json.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/scene_frames.hpp"

namespace wade::crowd {
namespace {

void check_target(const CrowdWorld& crowd, const TauCommand& command) {
    const std::size_t agents = crowd.agents.size();
    if (command.agent && static_cast<std::size_t>(*command.agent) >= agents) {
        throw ConfigurationError("tau: there is no agent " + std::to_string(*command.agent) +
                                 "; allowed: " + (agents == 0 ? "none" : "0 to " + std::to_string(agents - 1)) + ".");
    }
    if (!command.group) return;
    std::string known;
    for (const AgentGroup& group : crowd.scene.crowd->groups) {
        if (group.name == *command.group) return;
        known += (known.empty() ? "" : ", ") + group.name;
    }
    throw ConfigurationError("tau: there is no group \"" + *command.group +
                             "\"; allowed: " + (known.empty() ? "none" : known) + ".");
}

// Returns the last frame with events that hold from `step` on, or from the first later step with such a frame.
std::uint64_t last_frame_of_step(const Scene& scene, std::uint64_t step) {
    std::uint64_t lo = 0;  // its step is below `step`
    std::uint64_t hi = 1;
    while (step_of_frame(scene, hi) < step) hi *= 2;
    while (hi - lo > 1) {
        const std::uint64_t middle = lo + (hi - lo) / 2;
        (step_of_frame(scene, middle) < step ? lo : hi) = middle;
    }
    while (step_of_frame(scene, hi + 1) == step_of_frame(scene, hi)) ++hi;
    return hi;
}

Json json_of(const TauEvent& event) {
    Json json{{"frame", event.frame}, {"tau", event.tau}};
    if (event.agent) json["agent"] = *event.agent;
    if (event.group) json["group"] = *event.group;
    return json;
}

}  // namespace

TauEvent event_of(const CrowdWorld& crowd, const TauCommand& command) {
    check_target(crowd, command);
    return {last_frame_of_step(crowd.scene, crowd.steps + 1), command.agent, command.group, command.tau};
}

void add_event(CrowdWorld& crowd, const TauEvent& event) {
    std::vector<TauEvent>& events = crowd.scene.events;
    const auto after = std::upper_bound(events.begin(), events.end(), event.frame,
                                        [](std::uint64_t frame, const TauEvent& e) { return frame < e.frame; });
    events.insert(after, event);
}

std::string event_json(const TauEvent& event) {
    return json_of(event).dump({.sorted = true});
}

std::string scene_with_events(const std::string& canonical_scene, std::span<const TauEvent> events) {
    Json scene = Json::parse(canonical_scene);
    for (const TauEvent& event : events) scene["events"].push_back(json_of(event));
    return scene.dump({.indent = 2, .sorted = true}) + "\n";
}

}  // namespace wade::crowd
