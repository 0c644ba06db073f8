#pragma once
// Where the water of the page comes from: a session that runs, as one more free-running reader, or a recording.

#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tools/shm/recording.hpp"
#include "viewer/message.hpp"

namespace wade::view {

inline constexpr std::uint32_t most_particles = 200000;  // of a message; of more every n-th is sent
inline constexpr double most_frames_per_s = 30;

// The newest frame of a stream of a session. A thread of its own waits for frames, as long as somebody wants them; the producer
// waits for nobody here.
class LiveStream {
 public:
    LiveStream(std::string session, shm::StreamKind kind);
    ~LiveStream();
    LiveStream(const LiveStream&) = delete;
    LiveStream& operator=(const LiveStream&) = delete;

    // The newest frame; null before there is one. Says that somebody wants frames for the next two seconds.
    [[nodiscard]] Message newest();
    // waiting, running, paused, stale (no frame for 3.2 s though the producer lives), ended; empty: cannot be read, see problem().
    [[nodiscard]] std::string state();
    [[nodiscard]] std::string problem();
    [[nodiscard]] const std::string& session() const { return session_; }

 private:
    void read_all();
    void read_stream();
    void keep(Message message);
    [[nodiscard]] bool is_wanted() const;

    std::string session_;
    shm::StreamKind kind_;
    std::atomic<bool> stop_ = false, ended_ = false;
    std::atomic<std::int64_t> wanted_at_ns_ = 0, came_at_ns_ = 0;
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

}  // namespace wade::view
