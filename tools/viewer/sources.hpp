#pragma once
// Where water and people of the page come from: a session that runs, as one more free-running reader (water.cpp), a recording
// (water.cpp), or a run folder, while the run goes on, at its end, or after it was killed (run_folder.cpp). And the site that
// it happens in (site.cpp).

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <vector>

#include "configs/scene/scene.hpp"
#include "tools/shm/recording.hpp"
#include "tools/viewer/web_server.hpp"

namespace wade::view {

inline constexpr std::uint32_t most_particles = 200000;  // of a message; of more every n-th is sent
inline constexpr double most_frames_per_s = 30;

// Keeps the newest frame of a stream of a session. A thread of its own takes frames as long as clients want them; the
// producer never waits for it.
class LiveStream {
 public:
    LiveStream(std::string session, shm::StreamKind kind);
    ~LiveStream();
    LiveStream(const LiveStream&) = delete;
    LiveStream& operator=(const LiveStream&) = delete;

    // Returns the newest frame; null before there is one. The thread takes frames for the next two seconds.
    [[nodiscard]] Message newest();
    // waiting, running, paused, stale (no frame for 3.2 s though the producer lives), ended (also if the producer has given up,
    // see problem()), killed (the producer has died).
    [[nodiscard]] std::string state();
    [[nodiscard]] std::string problem();
    // Returns the time, s, of a frame that the crowd is done with, so that its files lack nothing up to there. Follows the stream
    // by one or two calls. Without a crowd in the session: the time of the newest frame.
    [[nodiscard]] double passed_s();
    [[nodiscard]] const std::string& session() const { return session_; }

 private:
    void read_all();
    void read_stream();
    void keep(Message message);
    [[nodiscard]] bool is_wanted() const;

    std::string session_;
    shm::StreamKind kind_;
    std::atomic<bool> stop_ = false;
    std::atomic<const char*> end_ = nullptr;  // ended or killed; null before
    std::atomic<std::int64_t> wanted_at_ns_ = 0, came_at_ns_ = 0;
    std::uint64_t next_frame_ = 0;  // that passed_s() waits for, 0: none
    double next_s_ = 0, passed_s_ = 0;
    std::mutex mutex_;  // of the two below
    Message newest_;
    std::string problem_;
    std::thread thread_;
};

// Any frame of a recording.
class RecordedWater {
 public:
    // Errors: ConfigurationError as recording::Recording.
    explicit RecordedWater(const std::filesystem::path& file);

    // The last frame that is not later than a time, or the first one. Errors: ConfigurationError for a damaged frame.
    [[nodiscard]] Message at(double time_s);
    [[nodiscard]] double first_s() const;
    [[nodiscard]] double last_s() const;
    [[nodiscard]] std::size_t frames() const { return recording_.frames().size(); }
    [[nodiscard]] bool is_whole() const { return recording_.end().has_value(); }

 private:
    [[nodiscard]] double time_of(const recording::FrameRecord& record) const;

    recording::Recording recording_;
    std::vector<std::vector<float>> arrays_;
    Message last_;
    double last_frame_ = 0;
};

// Words that messages of people give as an index in these lists.
inline constexpr std::string_view state_words[] = {
#define WADE_PERSON_STATE(word, kind, end) #word,
#define WADE_OUTCOME WADE_PERSON_STATE
#define WADE_STATE WADE_PERSON_STATE
#include "configs/scene/states.def"
};
// Of each state: safe, lost or none.
inline constexpr std::string_view state_ends[] = {
#define WADE_PERSON_STATE(word, kind, end) #end,
#define WADE_OUTCOME WADE_PERSON_STATE
#define WADE_STATE WADE_PERSON_STATE
#include "configs/scene/states.def"
};
inline constexpr std::string_view posture_words[] = {"upright", "falling",  "lying",     "floating", "swimming",
                                                     "sitting", "kneeling", "squatting", "rising"};
// States beside those of state_words: files without states, and a word that is not in the list.
inline constexpr int untold_state = -1, unknown_state = -2;
inline constexpr std::string_view unknown_word = "unknown";
// The arrays of a message of people, in their order; `holds` is the first id that is held, -1: none.
inline constexpr std::string_view people_fields[] = {
    "id",           "x_m",          "z_m",           "state",        "posture",    "heading_rad",
    "speed_m_s",    "gait_phase",   "step_length_m", "hip_height_m", "lean_x_rad", "lean_z_rad",
    "rate_x_rad_s", "rate_y_rad_s", "rate_z_rad_s",  "holds"};

// State of a person from a time on.
struct StateChange {
    double time = 0;
    std::uint32_t id = 0;
    int state = 0;  // in state_words, or unknown_state
};

// A table that grows, rows of `frame,time_s,id,...`, frame by frame: where each frame lies. It is not held in memory.
class FrameTable {
 public:
    explicit FrameTable(std::filesystem::path file) : path_(std::move(file)) {}

    // Takes in what has come since the last call, some 8 MB at most; true if there is more.
    bool read_on();

    [[nodiscard]] std::size_t frames() const { return starts_.size(); }
    // Returns how many frames have all their rows: the last one of a table that grows may lack some.
    [[nodiscard]] std::size_t whole_frames() const { return starts_.size() - (grows_ && !starts_.empty() ? 1 : 0); }
    // Returns the number of a frame; numbers without rows are left out in the table.
    [[nodiscard]] std::size_t number(std::size_t frame) const { return numbers_[frame]; }
    // Returns the frames in a second by numbers and times of rows, which are rounded to thousandths.
    [[nodiscard]] double rate_hz() const;
    // Returns the time of a frame by its number: the last one of a run may come early.
    [[nodiscard]] double time_of_number(std::size_t number, double rate_hz) const;
    // The frame of the table at a time, the last that is not later. There must be one.
    [[nodiscard]] std::size_t at(double time_s) const;
    [[nodiscard]] const std::string& header() const { return header_; }
    // Returns the complete rows of a frame that are there by now.
    [[nodiscard]] std::string rows_of(std::size_t frame) const;
    // Returns the same by the frame's number; empty if no person has a row.
    [[nodiscard]] std::string rows_of_number(std::size_t number) const;
    [[nodiscard]] const std::vector<StateChange>& changes() const { return changes_; }

 private:
    void take_row(std::string_view row, std::uint64_t at);
    void forget();

    std::filesystem::path path_;
    std::string header_;
    std::uint64_t read_ = 0;  // bytes, up to the end of a row
    bool grows_ = false;      // it has grown since the last look
    std::vector<std::uint64_t> starts_;
    std::vector<double> times_;
    std::vector<std::size_t> numbers_;
    long long last_frame_ = -1;
    std::unordered_map<std::uint32_t, int> states_;
    std::vector<StateChange> changes_;
};

// What stands in a site: outlines of houses, shelters, gates, sources and outlets, m, as JSON.
[[nodiscard]] std::string site_json(const Site& site);

// The ground of a site at points of a square grid that begins at the scene's origin; NaN outside.
[[nodiscard]] Message ground_of(const Scene& scene);

class RunFolder {
 public:
    // may_be_empty: the run is about to start. Errors: ConfigurationError if it is no folder of a run.
    explicit RunFolder(std::filesystem::path folder, bool may_be_empty);

    // Takes in what has come; true if there is more to take in at once. The run had written all up to `passed_s` before this call.
    bool read_on(double passed_s);

    // Frames of people: of poses.csv, else of trajectories.sqlite, all upright. Frames without people count, too.
    [[nodiscard]] bool has_poses() const { return pose_rate() > 0; }
    [[nodiscard]] std::size_t people_frames() const;
    [[nodiscard]] double people_time(std::size_t frame) const;
    [[nodiscard]] Message people(std::size_t frame) const;  // the last one if there are not so many
    // Returns the paths from a time on, thinned to some 300,000 points; null before they can be read.
    [[nodiscard]] Message paths(double from_s) const;
    // Depths as of the newest snapshot of water.bin that is not later than a time, else the first; null if there is none.
    [[nodiscard]] Message depths(double time_s) const;
    [[nodiscard]] std::size_t snapshots() const { return snapshot_times_.size(); }
    [[nodiscard]] double snapshot_time(std::size_t k) const { return snapshot_times_[k]; }
    // The row of terms.csv of a person at a time with the header before it; empty if there is none.
    [[nodiscard]] std::string terms(std::uint32_t id, double time_s) const;
    // The same of all times, some 200 rows at most.
    [[nodiscard]] std::string course(std::uint32_t id) const;
    [[nodiscard]] const std::vector<StateChange>& changes() const { return poses_.changes(); }
    // A small text file of the folder, "" if it is not there.
    [[nodiscard]] std::string text_of(const std::string& name) const;
    [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
    // Why water.bin is not shown, empty if it is.
    [[nodiscard]] const std::string& water_problem() const { return water_problem_; }

 private:
    void look_at_paths();
    void look_at_water();
    [[nodiscard]] double pose_rate() const;

    std::filesystem::path folder_;
    FrameTable poses_, terms_;
    double scene_pose_rate_ = 0;  // of the manifest, 0: unknown
    std::uint64_t manifest_bytes_ = 0;
    double passed_s_ = 0;     // poses.csv lacks nothing up to there
    double paths_per_s_ = 0;  // frames of trajectories.sqlite
    std::size_t path_frames_ = 0;
    std::uint32_t columns_ = 0, rows_ = 0;  // of water.bin
    double cell_ = 0, x0_ = 0, z0_ = 0;
    std::vector<double> snapshot_times_;
    std::string water_problem_;
    unsigned looks_ = 0;
};

}  // namespace wade::view
