#pragma once
// Walls at any angle: how much of a cell is open to water, and how much of its faces.
//
//      +-------------+     A wall cuts cells. Of a cell the share s is open, of its faces the shares a; what passes a face is
//      |        . '  |     a times its flux, and the cell's water changes by the sum of it over s. The wall pushes with the
//      |   s .'      a     pressure that a mirror image of the water would have,
//      |   .'  wall  |
//      | .'          |         g h^2/2 + dp,   dp = h u_n (u_n + S),   S = max(c + u_n/2, c - u_n),
//      +------a------+
//                          u_n the velocity towards the wall: the flux of Harten, Lax and van Leer between mirrored states.
//
// The wall's length times its normal is what the open faces lack to a closed line, W = sum of (a_lower - a_upper) over the
// directions, so that water at rest stays so to the last bit, and water that runs along a straight wall is not braked.
// (Cut cells: LeVeque, Finite Volume Methods for Hyperbolic Problems 2002, section 23.10.)
//
// A cell so small that water could leave it within a time step is stepped together with a neighbour as one cell: a group.
// Its members have one bed and one state, the mean by their open shares of what each would have alone, however small it is. A cell that a wall thinner than it splits keeps its larger part. [A] Water does
// not rise above walls: their height is not asked for.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/site.hpp"
#include "fluid_server/shallow_water/grid.hpp"
#include "fluid_server/shallow_water/row_memory.hpp"
#include "fluid_server/shallow_water/site/wet_lines.hpp"

namespace wade::fluid::shallow_water {

// A cell beside a wall; what the wall pushes, per dp: the wall's length times its outward normal over the cell's sides.
struct WallCell {
    std::uint32_t column = 0;
    double x = 0, z = 0, length = 0;
};

// A cell with a wall below it (+1) or above it (-1) along one direction: its slope is that of the side away from the wall,
// or 0 between two walls (0).
struct OneSided {
    std::uint32_t column = 0;
    std::int8_t away = 0;
};

// Entries by row: those of row k are [begin[k], begin[k + 1]).
template <typename Entry>
struct EntriesByRow {
    std::vector<Entry> entries;
    std::vector<std::size_t> begin;

    [[nodiscard]] bool any(std::size_t k) const { return begin[k] < begin[k + 1]; }
    [[nodiscard]] bool empty() const { return entries.empty(); }
};

// A face closed by a flood wall, over which water runs above the crest: see weir_flux.hpp. The face lies below the cell.
struct WeirFace {
    std::uint32_t column = 0;
    double crest = 0;   // m
    double length = 0;  // of the wall over that of the face
    double open = 0;    // share of the face without the wall
};

struct MemberPlace {
    std::uint32_t row = 0, column = 0;
};

// Cells, as places in the grid's memory, that are stepped as one.
struct Group {
    std::size_t first = 0, last = 0;            // in Openings::members_of_groups
    std::size_t first_line = 0, last_line = 0;  // in Openings::lines_of_groups
    double share = 0;                           // open, of whole cells
};

// Rows of faces, ghost faces included, with some aperture below 1.
struct NarrowedRows {
    std::vector<std::uint8_t> rows;

    // Returns the apertures of the faces from index c on in a row; null if the whole row is open.
    [[nodiscard]] const double* from(const RowMemory& shares, std::size_t c, const Grid& grid) const {
        return rows.empty() || rows[c / grid.stride] == 0 ? nullptr : shares.data() + c;
    }
};

struct Openings {
    RowMemory share;           // s by cell; empty: all is open, and so is all below
    RowMemory per_share;       // 1 / s; 0 in closed cells, -1 / s in cells of a group
    RowMemory face_x, face_z;  // a of the face below each cell
    NarrowedRows narrowed_x, narrowed_z;
    EntriesByRow<WallCell> walls;
    EntriesByRow<OneSided> slopes_x, slopes_z;
    EntriesByRow<WeirFace> weirs_x, weirs_z;  // no rows without flood walls
    std::vector<Group> groups;
    std::vector<std::size_t> members_of_groups;    // places of cells
    std::vector<double> weights;                   // of members in their group, by their open shares
    std::vector<MemberPlace> places_of_members;    // by members_of_groups
    std::vector<Lines::Position> lines_of_groups;  // each once in a group
    std::vector<std::size_t> active_groups;        // those that a step works on, see find_active()

    [[nodiscard]] bool any() const { return !share.empty(); }
    [[nodiscard]] double share_of(std::size_t c) const { return share.empty() ? 1 : share[c]; }
};

// ground: closed where it is NaN, by place in the grid's memory. barriers: those that are closed.
Openings find_openings(const Grid& grid, const std::vector<House>& houses, const RowMemory& ground,
                       const std::vector<Barrier>& barriers);

// The mean of the values of a group's members, by their open shares.
double mean_of(const Openings& openings, const Group& group, const RowMemory& values);

// Gives the members of a group, of each group, or of each active one, their mean.
void level_group(const Openings& openings, const Group& group, RowMemory& values);
void level_groups(const Openings& openings, RowMemory& values);
void level_active_groups(const Openings& openings, RowMemory& values);

}  // namespace wade::fluid::shallow_water
