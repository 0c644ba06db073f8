#pragma once
// trajectories.sqlite: the paths in JuPedSim's format, schema version 2, as JuPedSim's and PedPy's tools read it.
//
// pos_x is our x, pos_y our z. Frame 0 holds the start, frame f the state after f n steps of the crowd, n as
// steps_per_path_frame() of the scene; fps is the rate of the frames. An agent that has arrived or died is in one more
// frame, the first since then, at its last position; over the outfall, at the edge of the world. A run that ends
// between two frames has its end as the last frame.
//
// The rows lie in the order of their key (frame, id), which therefore needs no index beside them. The database leaves an
// eighth of its pages empty as it grows; close() packs them.
//
// Other programs may open the file during the run without harm: readers see whole frames. While another program locks
// the file, frames are kept in memory and written once it is free. Some frames may still be kept when the memory or the
// run ends, or when the file was moved or deleted. They go to a second file of the same tables beside it,
// trajectories.rest.sqlite.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "crowd_client/agents.hpp"

namespace wade::crowd {

// Rows that are not written yet.
struct PathRows {
    struct Row {
        std::int64_t frame;
        std::int64_t id;
        double x, z, heading_x, heading_z;
    };
    std::vector<std::int64_t> frames;
    std::vector<Row> rows;
};

struct TrajectoryLimits {
    int pages = 0;                                 // largest size of the file in pages of 4 KiB, 0 = none
    std::size_t kept_rows = std::size_t{1} << 20;  // in memory while the file is locked, 48 bytes each
    std::size_t frames_at_once = 1;                // written as one transaction, which takes less time
    double patience = 5;                           // s of wall time to wait at the end for a lock of another program
};

class TrajectoryFile {
 public:
    using Warn = std::function<void(const std::string&)>;

    // Creates the file anew. warn: gets a sentence at the end for each problem.
    // Throws OutputError, as all members do.
    TrajectoryFile(const std::filesystem::path& file, const Scene& scene, const TrajectoryLimits& limits = {},
                   Warn warn = {});
    ~TrajectoryFile();
    TrajectoryFile(const TrajectoryFile&) = delete;
    TrajectoryFile& operator=(const TrajectoryFile&) = delete;

    // Takes a frame of the agents that are active, or have ended in a step after `after`. Writes it with all kept
    // frames as one transaction, once there are `frames_at_once`: after a crash each frame is there as a whole or not
    // at all.
    void write(std::uint64_t frame, const Agents& agents, std::uint64_t after = 0);

    // Writes the kept frames, folds the write-ahead log into the one file that remains and packs it. If another program
    // has the file open the log stays beside it until that program closes it.
    void close();

 private:
    struct Database;

    void flush();
    void spill();
    void fold();
    void pack();
    void warn_of_rest() const;

    std::filesystem::path file_, rest_file_, packed_file_;
    Scene scene_;
    TrajectoryLimits limits_;
    Warn warn_;
    std::unique_ptr<Database> database_, rest_;
    bool is_gone_ = false;  // moved or deleted by another program
    PathRows kept_;
    std::int64_t first_in_rest_ = 0, last_in_rest_ = 0;  // frames
};

// Returns the world rectangle with the obstacles as holes, in well-known text. A hole may touch neither the edge nor
// another hole there, so that a touching obstacle is drawn 1 mm smaller on each side. On a site returns the world
// without its houses, which may touch and overlap, and without areas that they cut off, such as courtyards.
[[nodiscard]] std::string walkable_area_wkt(const Scene& scene);

}  // namespace wade::crowd
