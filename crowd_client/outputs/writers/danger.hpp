#pragma once
// Danger levels of the water, cell by cell and agent by agent.
//
// A cell of 2 x 2 m holds a few particles, so that its depth at one moment scatters. Depth and discharge are therefore
// averaged over blocks of time, for an agent along its path. The levels follow from these means:
//
//   depth h = mean of sum w m / (rho A)     discharge q = mean of sum w m v / (rho A)
//   speed |q| / h                           depth times speed |q|
//
// m, v of the particles, w the fraction of each in the cell (footprint.hpp), A the area of the cell without obstacles,
// rho the rest density of the water.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "configs/numbers/hazard.hpp"
#include "crowd_client/agents.hpp"
#include "crowd_client/markers/ground_cells.hpp"
#include "crowd_client/results/output_file.hpp"
#include "crowd_client/results/output_writer.hpp"
#include "crowd_client/water/water_view.hpp"

namespace wade::crowd {

// The name as it is written to files.
[[nodiscard]] std::string_view danger_name(DangerLevel level);

// Exposure of one cell or one person.
struct Exposure {
    DangerLevel largest = DangerLevel::none;
    double max_depth = 0, max_speed = 0, max_depth_speed = 0;  // of block means: m, m/s, m2/s
    std::array<std::uint64_t, danger_levels> steps{};          // of the crowd, spent in each level

    // The block that is not over yet: sums over its steps.
    std::uint64_t open_steps = 0;
    double depth_sum = 0;
    Vector2d discharge_sum = Vector2d::Zero();
    DangerLevel last = DangerLevel::none;  // of the block before
    bool has_block = false;
};

// Adds a step: the water's depth, m, and discharge, m2/s.
void add_step(Exposure& exposure, double depth, const Vector2d& discharge, std::uint64_t block_steps);

// Closes an open block. A block shorter than block_steps counts in the level of the block before, if there is one.
void close_block(Exposure& exposure, std::uint64_t block_steps);

// Cells of about 2 x 2 m, 1.33 to 2.67 m, that fill the channel exactly, so that no bank cuts any; at most a million.
[[nodiscard]] GroundCells danger_grid(const Channel& channel);

class DangerRecord {
 public:
    // window: length of a block, s; at least a step is taken.
    DangerRecord(const Scene& scene, std::size_t agents, double window);

    // Adds the water of a step, in the cells and at the current positions of the active agents.
    void add(const Agents& agents, std::span<const std::uint32_t> active, const WaterView& water);
    void close();  // at the end of the run

    [[nodiscard]] const GroundCells& grid() const { return grid_; }
    [[nodiscard]] const std::vector<Exposure>& cells() const { return cells_; }    // row by row (z)
    [[nodiscard]] const std::vector<Exposure>& agents() const { return agents_; }  // by id
    [[nodiscard]] double dt() const { return dt_; }

 private:
    void sum_up(const WaterView& water);

    GroundCells grid_;
    double rest_density_;  // kg/m3
    double dt_;            // s
    std::uint64_t block_steps_;
    std::vector<double> mass_of_depth_;  // kg of water in a cell for a metre of depth
    std::vector<bool> filled_;           // by an obstacle
    std::vector<Exposure> cells_, agents_;
    std::vector<double> mass_;  // of the current step, kg
    std::vector<Vector2d> momentum_;
};

// none_s,low_s,...: the time spent in each level, s.
constexpr const char* exposure_columns = "none_s,low_s,moderate_s,high_s,very_high_s";
[[nodiscard]] std::string exposure_times(const Exposure& exposure, double dt);

// danger.csv, a line a cell: x_min_m,x_max_m,z_min_m,z_max_m,danger_level,max_depth_m,max_speed_m_s,max_dv_m2_s and the
// times. The maxima are each for itself.
[[nodiscard]] std::string danger_csv(const DangerRecord& record);

// danger.csv. Also updates the record for other outputs.
class DangerFile final : public OutputWriter {
 public:
    explicit DangerFile(const OutputPlace& place) : file_(place.folder / "danger.csv"), record_(place.danger) {}

    void on_step(const CrowdWorld& crowd, const WaterView& water) override {
        record_->add(crowd.agents, crowd.active, water);
    }
    void keep(const RunView&) override { write_whole_file(file_, danger_csv(*record_)); }
    void finish(const RunView& run) override {
        record_->close();
        keep(run);
    }
    // Twice the length of a line for each cell.
    [[nodiscard]] std::size_t bytes_at_end() const override { return 400 * record_->cells().size(); }

 private:
    std::filesystem::path file_;
    std::shared_ptr<DangerRecord> record_;
};

}  // namespace wade::crowd
