#pragma once
// What comes to a site and leaves it: sources, rain, outlets, gates that open.
//
// A source adds its volume to its cells, by their area, without momentum; rain adds depth. Over a free outlet water leaves as
// over a fall: its cells are emptied after each step, so that they are always dry ground for the water beside them.
//
// The cells of the other outlets hold depth h and velocity u, along the normal into the site. From inside comes R = u - 2 c, the
// invariant of the cells beside them; c = sqrt(g h), d = max(0, eta(t) - b), c_d = sqrt(g d).
//
//   stage   A large water at rest outside, of level eta(t). Outflow takes its level and loses its own velocity head:
//           h = d, u = R + 2 c_d, if that is at most 0. Inflow takes its head: h + u^2 / (2 g) = d with u = R + 2 c, that is
//           c = (sqrt(3 g d - R^2 / 2) - R) / 3, at least critical flow, c^2 = 2 g d / 3, with 0 <= u <= c.
//           d = 0 is dry: nothing comes in.
//   wave    Open water outside. eta(t) is the level of the incoming simple wave, its first value the level at rest:
//           u + 2 c = 4 c_d - 2 c_0, u - 2 c = R. The wave's own velocity and the flow at the boundary are at most critical.
//
// Where the site lies on opposite sides of the cell, or on none, the water of the cell stands at eta(t), at rest.
// Both let all water out as it is, if nothing runs inwards: neither a wave, u + c <= 0 inside, nor a bore of depth d.

#include <array>
#include <cstddef>
#include <vector>

#include "configs/scene/site.hpp"
#include "fluid_server/shallow_water/bands.hpp"
#include "fluid_server/shallow_water/grid.hpp"
#include "fluid_server/shallow_water/site/openings.hpp"
#include "fluid_server/shallow_water/site/wet_lines.hpp"

namespace wade::fluid::shallow_water {

struct SourceCell {
    std::size_t cell = 0;   // place in the grid's memory
    double per_volume = 0;  // depth that a volume of the source adds, 1/m^2
};
struct SiteSource {
    Series discharge;
    std::vector<SourceCell> cells;
};

struct OutletCell {
    std::size_t cell = 0;
    double normal_x = 0, normal_z = 0;    // into the site; both 0: of none or of opposite cells
    std::array<std::size_t, 4> inside{};  // the cells of the site beside it
    std::size_t count = 0;                // of these
};
// Cells of an outlet in a line of a row, see wet_lines.hpp.
struct OutletLine {
    std::size_t row = 0, column = 0;  // of the first one
    std::size_t begin = 0, end = 0;   // in SiteOutlet::cells
};
struct SiteOutlet {
    OutletKind kind = OutletKind::free;
    Series stage;
    std::vector<OutletCell> cells;
    std::vector<OutletLine> lines;
    std::vector<std::size_t> beside;  // cells inside that are of another rank than the outlet's cell (bands.hpp)
};

struct SiteWater {
    std::vector<SiteSource> sources;
    Series rain;  // m/s
    std::vector<SiteOutlet> outlets;
    std::vector<double> openings_of_gates;  // future opening times of gates, ascending, s
    std::vector<std::size_t> groups;        // with a cell of a source or an outlet (openings.hpp)
    std::vector<double> volumes;            // of the cells of outlets, memory
};

// Throws ConfigurationError if a source or an outlet has no cell on open ground.
SiteWater make_site_water(const Site& site, const Grid& grid, const Openings& openings);

// The time, at most `remaining`, until a gate opens.
double until_gate_opens(const SiteWater& site, double time, double remaining);

// Returns the longest step of at most `longest`, s, that keeps the wave of the inflow on dry ground, of depth h, within
// the distance `way`, m: dt sqrt(g h) <= way.
double longest_with_inflow(const SiteWater& site, double time, double longest, double gravity, double way);

struct Passed {
    double inflow = 0, outflow = 0;  // m^3
    bool rained = false;
};

// The water that a site changes, and what lies under it.
struct SiteCells {
    const Grid& grid;
    const Bed& bed;
    const Openings& openings;
    Water& water;
    double gravity, dry;
    const Lines& active;  // all others are dry and stay so, unless it rains
    Band* band;           // the rows that are changed
};

// Calls body(cell) for the cells of an outlet in these lines.
template <typename Outlet, typename Body>
void for_each_cell_in(const Lines& lines, Outlet& outlet, Body&& body) {
    for (const OutletLine& line : outlet.lines) {
        if (!lines.has(line.row, line.column)) continue;
        for (std::size_t n = line.begin; n < line.end; ++n) body(outlet.cells[n]);
    }
}

// The groups that have a cell of a source or an outlet.
std::vector<std::size_t> groups_of(const SiteWater& site, const Openings& openings);

// Sources, rain and outlets over the step from a time, s, on.
Passed exchange(SiteWater& site, const SiteCells& cells, double time, double dt);

// Removes the opening times that have come, and returns whether there were any.
bool gates_open(SiteWater& site, double time);

// Times are sums of steps, s.
inline constexpr double gate_slack = 1e-9;

}  // namespace wade::fluid::shallow_water
