#pragma once
// Changes of tau that a user asks for while the run goes on, as events of the scene, so that the run can be repeated.

#include <span>
#include <string>

#include "configs/program/run_control.hpp"
#include "crowd_client/crowd_world.hpp"

namespace wade::crowd {

// The event that a command becomes: it holds from the crowd's next step on, or the first after it with which a frame of
// the scene begins, and acts after the scene's own events of that step.
// Throws ConfigurationError for an agent or a group that the scene does not have.
[[nodiscard]] TauEvent event_of(const CrowdWorld& crowd, const TauCommand& command);

// Adds an event that no step was taken with yet.
void add_event(CrowdWorld& crowd, const TauEvent& event);

// One line of JSON, an element of the scene's `events`.
[[nodiscard]] std::string event_json(const TauEvent& event);

// The resolved scene with further events at the end of its list.
[[nodiscard]] std::string scene_with_events(const std::string& canonical_scene, std::span<const TauEvent> events);

}  // namespace wade::crowd
