#pragma once
// Changes of tau that a user asks for while the run goes on, as events of the scene, so that the run can be repeated.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "configs/program/run_control.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/output_writer.hpp"

namespace wade::crowd {

// Returns the event of a command. It holds from the crowd's next step on, or from the first later step that begins a
// frame of the scene. It acts after the scene's own events of that step.
// Throws ConfigurationError for an agent or a group that the scene does not have.
[[nodiscard]] TauEvent event_of(const CrowdWorld& crowd, const TauCommand& command);

// Adds an event that acts in none of the steps taken so far.
void add_event(CrowdWorld& crowd, const TauEvent& event);

// One line of JSON, an element of the scene's `events`.
[[nodiscard]] std::string event_json(const TauEvent& event);

// The resolved scene with further events at the end of its list.
[[nodiscard]] std::string scene_with_events(const std::string& canonical_scene, std::span<const TauEvent> events);

// events.jsonl: each tau command as an event of the scene, absent if there was none. scene_as_played.json: the scene
// with these events, which repeats the run; rewritten as a whole after each step with new events.
class EventsFile final : public OutputWriter {
 public:
    explicit EventsFile(const OutputPlace& place)
        : folder_(place.folder), canonical_scene_(place.labels.canonical_scene) {}

    void on_event(const TauEvent& event) override {
        played_.push_back(event);
        if (!lines_) lines_.emplace(folder_ / "events.jsonl");
        lines_->append(event_json(event) + "\n");
    }
    void on_step(const CrowdWorld&, const WaterView&) override { rewrite(); }
    void finish(const RunView&) override { rewrite(); }

 private:
    void rewrite() {
        if (played_.size() == written_) return;
        write_whole_file(folder_ / "scene_as_played.json", scene_with_events(canonical_scene_, played_));
        written_ = played_.size();
    }

    std::filesystem::path folder_;
    std::string canonical_scene_;
    std::vector<TauEvent> played_;
    std::size_t written_ = 0;  // events of scene_as_played.json
    std::optional<AppendFile> lines_;
};

}  // namespace wade::crowd
