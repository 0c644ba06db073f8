#pragma once
// The guards: particles before an open end of the window that move as the shallow water does,
//
//   u, v   of the shallow water at the particle's place,      w = -y (du/dx + dv/dz),      p = g (h - y)
//
// which is how hydrostatic water moves over a level bed: columns keep their volume, so that the guard keeps its density. As
// Kind::inflow they have no acceleration of their own, hold the water of the window up by that pressure and carry it in or
// away (PressureSolver::guide_inflow). The density solve moves them as it moves all: in water of one layer a column cannot
// grow otherwise.
//
//       outer edge          window's end
//   . . . |  o   o   o   o   |  o   o          A fluid particle that leaves the window becomes part of the guard, a particle
//         |  o   o   o   o   |  o   o          of the guard that enters the window becomes fluid; beyond the outer edge
//   s = length             s = 0               particles are dropped, and where the stream leads in columns are added.
//
// Across z the outer edge has strips about one spacing wide. A column is as many particles as the depth of the cell there
// gives, d apart along x; what is left of a particle is kept for the next one of the strip, so that a stream of any depth
// brings the right mass in the mean.

#include <array>
#include <cstddef>
#include <vector>

#include "configs/scene/interval.hpp"
#include "fluid_server/mixed/stream_at.hpp"
#include "fluid_server/mixed/window.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid::mixed {

// One end of the window.
struct End {
    int side = -1;             // outwards along x
    bool open = true;          // or at a wall
    double x = 0;              // m
    std::vector<double> last;  // by strip: s of the outermost column, m
    std::vector<double> rest;  // by strip: what is left over of a particle, [0, 1)

    // Outward distance from the end, m.
    [[nodiscard]] double s_of(double place) const { return side * (place - x); }
};

class Guards {
 public:
    Guards(const shallow_water::ShallowWater& world, double length);

    // Places both ends; the window must not be empty. Columns stay where they are in the channel.
    void move_to(const Window& window, const shallow_water::Grid& grid, bool walls);

    // Fills the window and both guards; the particles are none before.
    void fill(Particles& particles, const shallow_water::ShallowWater& world);

    // Makes particles fluid in the window and Kind::inflow before it, with the velocity of the stream, drops those beyond
    // the outer edges and adds columns up to there. dt: since the last call, s; moved: how far the ends have been moved
    // outwards since then, m. Columns that fill what is new at an end where the stream leads out have its volume, whatever the gap before them.
    void update(Particles& particles, const shallow_water::ShallowWater& world, double dt,
                const std::array<double, 2>& moved = {});

    [[nodiscard]] const std::array<End, 2>& ends() const { return ends_; }

 private:
    [[nodiscard]] std::size_t strip_of(double z) const;
    void add_columns(End& end, Particles& particles, const shallow_water::ShallowWater& world, double filled = 0);
    // share: of its particles over those of a column of the depth of the water
    void add_column(End& end, std::size_t strip, double s, double share, Particles& particles,
                    const shallow_water::ShallowWater& world);

    Interval z_;
    double spacing_;
    double length_;
    std::size_t strips_;
    double width_;  // of a strip, m
    double pitch_;  // of columns along x, m
    std::array<End, 2> ends_;
    std::vector<double> outermost_;  // by strip
};

}  // namespace wade::fluid::mixed
