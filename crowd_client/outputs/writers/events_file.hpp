#pragma once
// events.jsonl: each tau command as an event of the scene, absent if there was none. scene_as_played.json: the scene with
// these events, which repeats the run; rewritten as a whole with each.

#include <optional>
#include <string>
#include <vector>

#include "crowd_client/outputs/output_file.hpp"
#include "crowd_client/outputs/output_writer.hpp"
#include "crowd_client/outputs/played_events.hpp"

namespace wade::crowd {

class EventsFile final : public OutputWriter {
 public:
    explicit EventsFile(const OutputPlace& place)
        : folder_(place.folder), canonical_scene_(place.labels.canonical_scene) {}

    void on_event(const TauEvent& event) override {
        played_.push_back(event);
        if (!lines_) lines_.emplace(folder_ / "events.jsonl");
        lines_->append(event_json(event) + "\n");
        write_whole_file(folder_ / "scene_as_played.json", scene_with_events(canonical_scene_, played_));
    }
    void finish(const RunView&) override {}

 private:
    std::filesystem::path folder_;
    std::string canonical_scene_;
    std::vector<TauEvent> played_;
    std::optional<AppendFile> lines_;
};

}  // namespace wade::crowd
