#pragma once
// Drawn markers and their owners, in single precision: each cell weighs all of its markers at once and adds them to the
// sums of their owners.
//
// With Eq. 2 left to the end, m = sum f a / sum f, and one division a marker, g the direction of the goal:
//
//   f = (1 + g.a / |a|) / (1 + |a|) = (|a| + g.a) / (|a| + |a|^2)
//
// Sums are kept lane by lane and added up at the end, always in one order, so that they have the same bits everywhere.

#include <array>
#include <cstdint>
#include <vector>

#include "crowd_client/markers/band_walk.hpp"

namespace wade::crowd {

// Contribution of a marker to its owner: f, f a along x and z, and 1, with contested_unit more if it is contested.
using MarkerShare [[gnu::vector_size(16)]] = float;

// More than the markers of any walker: within 2 m, at most 1000 in 4 m2. The sums of both are whole numbers below 2^24.
constexpr float contested_unit = 4096;

// Sums over the markers of an entry, lane by lane.
using OwnerSums = std::array<MarkerShare, Lanes<float>::count>;

// State of one thread.
class DrawnOwners {
 public:
    void begin_row(const Claiming& claiming, const RowBand& band, int row);
    void expect_cell(const Claiming&, int, int) {}  // nothing is read
    void deal_cell(const Claiming& claiming, const RowBand& band, int column, int row);
    void finish(const Claiming& claiming, std::uint32_t entry, std::uint32_t image, int row);

    std::uint64_t pair_tests = 0;

 private:
    using L = Lanes<float>;

    // Sums of the entries of a row.
    struct Row {
        std::uint32_t first = 0;
        std::vector<OwnerSums> sums;
        std::vector<float> goal_x, goal_z;  // direction of the goal; zero on it
        std::vector<float> discount;        // with bodies only
    };

    [[nodiscard]] Row& row_of(const Claiming& claiming, int row) {
        return rows_[static_cast<std::size_t>(row % claiming.cells.span)];
    }
    void look_up_owners(const Claiming& claiming, const RowBand& band, int column, int row);
    [[nodiscard]] Way<float> way_of(std::size_t m, const L::Integers& owner, bool with_bodies) const;
    void weigh(bool with_bodies);
    template <bool with_bodies>
    void add_to_owners();

    MarkerLanes<float> markers_;
    Candidates<float> candidates_;
    Claims<float> claims_;
    std::vector<float> goal_x_, goal_z_, discount_;  // by candidate
    std::vector<OwnerSums*> sums_of_;                // by candidate
    std::vector<float> weight_, x_, z_;              // by marker: f and f a
    std::array<Row, 3> rows_;
    OwnerSums nobody_{};  // sink for markers without an owner, and for walkers of other bands
};

}  // namespace wade::crowd
