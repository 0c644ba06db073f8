#pragma once
// What is known about a run besides the crowd.

#include <optional>
#include <string>
#include <vector>

namespace wade::crowd {

// Times and names of machines are left empty in a reproducible run.
struct RunLabels {
    std::string model;            // of the fluid, as its producer calls itself; empty: never joined
    std::string canonical_scene;  // JSON of the resolved scene
    std::string session;
    bool latest_frames = false;  // the newest frames instead of all
    int threads = 0;             // 0: as many as there are processors
    std::vector<std::string> command_line;
    bool reproducible = false;
    std::optional<double> wall_time;  // s
    std::string started_at;           // ISO 8601, UTC
    std::string host;
};

}  // namespace wade::crowd
