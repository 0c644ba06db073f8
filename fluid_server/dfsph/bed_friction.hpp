#pragma once
// Friction of a rough bed by Manning's formula (Manning 1891), as in the shallow-water equations (W6 of
// docs/step_of_the_water.md):
//
//   du/dt = - k u,   k = g n^2 |U| / h^(4/3)
//
// n: Manning's coefficient, s/m^(1/3), 0 to 1; h: depth of the column of water in which a particle is, m; U: its mean
// horizontal velocity, m/s. On a slope S a wide uniform stream so reaches U = h^(2/3) S^(1/2) / n.
//
// The friction is averaged over the depth: it acts on all particles of a column alike, so that it makes no profile of
// velocities and no turbulence. A column stands on a cell of the ground about four spacings wide; its depth is the volume
// of its particles over the ground in the cell that no obstacle taller than the water covers. On a raised bed the depth is
// that of the water above it. A film thinner than half a spacing has the friction of half a spacing.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

class BedFriction {
 public:
    // Needs channel.manning_n > 0. whole_columns: particles that are not moved by the solver belong to the columns, too.
    explicit BedFriction(const Scene& scene, bool whole_columns = false);

    // Multiplies the horizontal velocity of each fluid particle by 1 / (1 + dt k): implicit, so that friction stops the
    // water at most and never turns it round.
    void apply(Particles& particles, float dt);

 private:
    struct Column {
        double particles = 0;
        double vx = 0, vz = 0;  // sums over them, m/s
        float factor = 1;
    };
    [[nodiscard]] std::uint32_t column_at(float x, float z) const;
    void sum_columns(const Particles& particles);

    bool whole_columns_;
    double coefficient_;      // g n^2, m^(1/3)
    double particle_volume_;  // d^3, m^3
    double least_depth_;      // m
    float x_lo_, z_lo_;
    float columns_per_m_x_, columns_per_m_z_;
    std::uint32_t nx_, nz_;
    std::vector<double> ground_;  // area on which a column stands, m^2
    std::vector<Column> columns_;
    std::vector<std::uint32_t> column_of_;
};

}  // namespace wade::fluid
