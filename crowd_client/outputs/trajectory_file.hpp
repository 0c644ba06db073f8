#pragma once
// trajectories.sqlite: the paths in JuPedSim's format, schema version 2, as JuPedSim's and PedPy's tools read it.
//
// pos_x is our x, pos_y our z. Frame f holds the state after f steps of the crowd, frame 0 the start; fps is the rate of
// the steps. Agents that have arrived or died have no rows from that frame on.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "crowd_client/agents.hpp"

namespace wade::crowd {

class TrajectoryFile {
 public:
    // Creates the file anew. page_limit: largest size in database pages of 4 KiB, 0 = none.
    // Throws OutputError, as all members do.
    TrajectoryFile(const std::filesystem::path& file, const Scene& scene, int page_limit = 0);
    ~TrajectoryFile();
    TrajectoryFile(const TrajectoryFile&) = delete;
    TrajectoryFile& operator=(const TrajectoryFile&) = delete;

    // Writes the active agents as one transaction: after a crash each frame is there as a whole or not at all.
    void write(std::uint64_t frame, const Agents& agents, const std::vector<std::uint32_t>& active);

    // Folds the write-ahead log into the one file that remains. The destructor does so too, without errors.
    void close();

 private:
    struct Database;
    std::unique_ptr<Database> database_;
};

// World rectangle with the obstacles as holes, in well-known text. A hole may touch neither the edge nor another hole
// there, so an obstacle that does is drawn 1 mm smaller on each side.
[[nodiscard]] std::string walkable_area_wkt(const Scene& scene);

}  // namespace wade::crowd
