#pragma once
// Fixed markers and their owners, in double precision: each cell deals its markers out to their owners. An owner sums
// up Eq. 1-3 in the order of the markers, to the bit as marker_preference, marker_weight and motion_vector do.

#include <array>
#include <cstdint>
#include <vector>

#include "crowd_client/markers/band_walk.hpp"

namespace wade::crowd {

// Markers relative to their owners.
struct OwnedMarkers {
    std::vector<double> x, z;       // marker - walker, m
    std::vector<double> contested;  // 0 or 1; with bodies only
    std::size_t count = 0;

    void make_room_for(std::size_t n, bool with_bodies);
};

// State of one thread.
class FixedOwners {
 public:
    void begin_row(const Claiming& claiming, const RowBand& band, int row);
    void expect_cell(const Claiming& claiming, int column, int row);
    void deal_cell(const Claiming& claiming, const RowBand& band, int column, int row);
    void finish(const Claiming& claiming, std::uint32_t entry, std::uint32_t image, int row);

    std::uint64_t pair_tests = 0;

 private:
    // Markers that a walker owns in one cell: a piece of a dealt row.
    struct Run {
        std::uint32_t begin = 0;
        std::uint16_t count = 0;
        std::uint16_t row = 0;  // of the cell
    };

    // The runs of the entries with corner cells in a row, `span` x `span` slots an entry.
    struct Runs {
        std::uint32_t first = 0;
        std::vector<Run> runs;
        std::vector<std::uint8_t> count;  // by entry
    };

    void list_owned();
    void deal_markers(const Claiming& claiming, const RowBand& band, int column, int row);
    void deal_to_few(OwnedMarkers& dealt, const Claiming& claiming, const RowBand& band, int column, int row);
    void deal_to_many(OwnedMarkers& dealt, const Claiming& claiming, const RowBand& band, int column, int row);
    void note_run(const Claiming& claiming, const RowBand& band, std::uint32_t entry, int corner_row, int row,
                  std::uint32_t begin, std::uint32_t end);
    void append_runs(const Claiming& claiming, std::uint32_t entry, int corner_row, int row);
    [[nodiscard]] Vector2d motion_of_own(const Vector2d& goal_offset, double discount, bool with_bodies);

    MarkerLanes<double> markers_;
    Candidates<double> candidates_;
    Claims<double> claims_;
    // The owned markers of the current cell and their candidates, in the order of the cell.
    struct Owned {
        std::vector<std::uint32_t> marker, owner;
        std::uint32_t count = 0;
    };
    Owned owned_;
    std::vector<std::uint32_t> next_;    // by candidate: index of its next marker in the row
    std::array<OwnedMarkers, 3> dealt_;  // of the last `span` rows
    std::array<Runs, 3> runs_;
    OwnedMarkers own_;  // of the current walker
    std::vector<double> preference_, weight_;
};

}  // namespace wade::crowd
