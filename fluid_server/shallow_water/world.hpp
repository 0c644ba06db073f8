#pragma once
// Shallow water as it stands: its grid, its bed, what each cell holds, and memory that a step works with.

#include <omp.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fluid_server/shallow_water/bands.hpp"
#include "fluid_server/shallow_water/boundary.hpp"
#include "fluid_server/shallow_water/face_flux.hpp"
#include "fluid_server/shallow_water/grid.hpp"
#include "fluid_server/shallow_water/site/openings.hpp"
#include "fluid_server/shallow_water/site/site_water.hpp"
#include "fluid_server/shallow_water/site/wet_lines.hpp"

namespace wade::fluid::shallow_water {

// Faces across the whole width with a running sum of the flux, for the exchange with particles there (mixed/).
struct WatchedFace {
    std::size_t face = 0;                        // the lower one of the cells of this number along x
    double volume = 0;                           // that passed towards +x since this was last set to 0, m^3
    double momentum = 0;                         // along x, that the water carried with it, over density, m^4/s
    std::vector<double> row_mass, row_momentum;  // of the step at hand, m^2/s and m^3/s^2
};

// A cell of a site with a gauge of discharge: the mean flux through its open faces along x and across in the last step, m^2/s.
struct GaugedCell {
    std::size_t row = 0, column = 0;
    double qx = 0, qz = 0;
};

// Faces between an obstacle and a cell that is none, see find_fluxes(); empty without obstacles.
struct Walls {
    RowMemory side;                  // by cell: of the face below it, 1 or -1 where there is a wall, else 0
    std::vector<std::uint8_t> rows;  // by row, ghosts included: whether it has any

    // Of the faces from place c on in a row; null if there is none in the row.
    [[nodiscard]] const double* from(std::size_t c, const Grid& grid) const {
        return rows.empty() || rows[c / grid.stride] == 0 ? nullptr : side.data() + c;
    }
};

struct ShallowWater {
    explicit ShallowWater(const Scene& its_scene);

    Scene scene;
    Grid grid;
    Bed bed;
    Water water;          // at `time`; the ghost cells of these hold nothing
    Primitive primitive;  // of `water`
    double time = 0;      // s
    FluxConstants constants;
    double acceleration = 0;  // a, m/s^2
    double manning_n = 0;     // s/m^(1/3); of a site where no cell has its own
    WetLines lines;           // the cells that are worked on
    Openings openings;        // between the walls of a site
    std::optional<SiteWater> site;
    Band band;  // the rows of this process

    // Of the step at hand; kept for their memory.
    Water stage;
    Primitive stage_primitive;                     // of `stage`
    Walls walls_x, walls_z;                        // of faces along x and across
    std::vector<double> row_fastest;               // by row: largest s_x / dx + s_z / dz, 1/s
    std::vector<double> row_least;                 // by row: smallest depth, below 0 where a step was too long
    std::vector<double> row_volume, row_momentum;  // by row: sums of h and of h u
    std::vector<double> row_inflow, row_outflow;   // by row: mass flux at x.hi and x.lo, m^2/s
    std::vector<RowMemory> buffers;                // by thread
    std::vector<std::size_t> bands;    // of a site: first row by thread and the end; empty: equally many rows
    std::vector<WatchedFace> watched;  // see watch_faces(); usually none
    std::vector<GaugedCell> gauged;    // of a site
};

// Sets depth and velocity of each cell from functions of its centre: f(x, z), m and m/s.
template <typename Depth, typename VelocityX, typename VelocityZ>
void set_water(ShallowWater& world, Depth&& depth, VelocityX&& u, VelocityZ&& v);

// Sums up the flux through these faces from now on; none: no longer.
void watch_faces(ShallowWater& world, const std::vector<std::size_t>& faces);

// To be called after a change of `water`.
void update_primitive(ShallowWater& world);

// The same where only active cells changed, or those of sources and outlets.
void update_active(ShallowWater& world);
void update_exchanged(ShallowWater& world);

// Finds the active cells of a site for the next steps, from the water in the current ones.
void find_active(ShallowWater& world);

// How many cells a step works on.
std::size_t active_cells(const ShallowWater& world);

// Walls of a site as they are at a time, s, and the bed between them.
void set_openings(ShallowWater& world, double time);

// Ghost cells of the world's rows, and the rows beside them that other ranks have.
void fill_borders(ShallowWater& world, Primitive& state);

// From now on this process works on its band alone. Throws ConfigurationError for more ranks than the grid has rows for.
void spread(ShallowWater& world, Ranks& ranks);

// What a step asks of other ranks (bands.hpp); without any these do nothing.
// Of cells of groups in several bands.
void share_groups(ShallowWater& world, RowMemory& h, RowMemory& qx, RowMemory& qz);
void share_wet(ShallowWater& world);  // lines and groups that are wet
void keep_own_groups(ShallowWater& world);
void note_touched(ShallowWater& world);
void find_shared(ShallowWater& world);                                       // after a change of the openings
void share_all(ShallowWater& world, std::span<const RowField> others = {});  // all of the water, and other fields

// Before a frame: cuts the bands anew if that is worth while. After it: the first rank gets what it publishes. others: what
// else belongs to cells.
void rebalance(ShallowWater& world, std::span<const RowField> others);
void collect_frame(ShallowWater& world, std::span<const RowField> others);

// What a site's sources, rain and outlets change over dt, s; of `water` alone.
Passed exchange(ShallowWater& world, double dt);

template <typename Depth, typename VelocityX, typename VelocityZ>
void set_water(ShallowWater& world, Depth&& depth, VelocityX&& u, VelocityZ&& v) {
    const Grid& grid = world.grid;
    for (std::size_t k = 0; k < grid.nz; ++k) {
        for (std::size_t i = 0; i < grid.nx; ++i) {
            const double x = grid.x.lo + (static_cast<double>(i) + 0.5) * grid.dx;
            const double z = grid.z.lo + (static_cast<double>(k) + 0.5) * grid.dz;
            const std::size_t c = grid.row(static_cast<std::ptrdiff_t>(k)) + i;
            world.water.h[c] = depth(x, z);
            world.water.qx[c] = world.water.h[c] * u(x, z);
            world.water.qz[c] = world.water.h[c] * v(x, z);
        }
    }
    update_primitive(world);
}

// With fewer cells than this the threads would wait for one another longer than they work.
inline constexpr std::size_t serial_below = 4096;

// Calls body(first row, end row, buffer) in each thread for a band of the rows that this process has.
template <typename Body>
void for_each_band(ShallowWater& world, Body&& body) {
    const Grid& grid = world.grid;
    const bool parallel = grid.cells() >= serial_below;
    world.buffers.resize(static_cast<std::size_t>(parallel ? omp_get_max_threads() : 1));
#pragma omp parallel if (parallel)
    {
        const auto threads = static_cast<std::size_t>(parallel ? omp_get_num_threads() : 1);
        const auto thread = static_cast<std::size_t>(parallel ? omp_get_thread_num() : 0);
        if (world.bands.size() == threads + 1) {
            body(world.bands[thread], world.bands[thread + 1], world.buffers[thread]);
        } else {
            const std::size_t first = world.band.begin, rows = world.band.end - first;
            body(first + thread * rows / threads, first + (thread + 1) * rows / threads, world.buffers[thread]);
        }
    }
}

}  // namespace wade::fluid::shallow_water
