#pragma once
// Friction of a rough bed by Manning's formula (Manning 1891), as in the shallow-water equations (W6 of
// docs/step_of_the_water.md):
//
//   du/dt = - k u,   k = g n^2 |U| / h^(4/3)
//
// n: Manning's coefficient, s/m^(1/3), 0 to 1; h: depth of the water column round a particle, m; U: the mean horizontal
// velocity of the column, m/s. A wide uniform stream on a slope S therefore reaches U = h^(2/3) S^(1/2) / n.
//
// The friction is depth-averaged: it acts on all particles of a column alike, so that it creates no velocity profile
// and no turbulence. A column stands on a cell of the ground about four spacings wide; its depth is the volume of its
// particles over the ground in the cell that no obstacle taller than the water, and no house of a site, covers. On a
// raised bed the depth is that of the water above it. A film thinner than half a spacing has the friction of half a
// spacing. On a site n is that in the middle of the cell.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

// The columns of water, by row (z), then x.
class WaterColumns {
 public:
    // whole_columns: particles that are not moved by the solver belong to the columns, too.
    explicit WaterColumns(const Scene& scene, bool whole_columns = false);

    void sum(const Particles& particles);

    [[nodiscard]] std::size_t count() const { return columns_.size(); }
    [[nodiscard]] std::uint32_t nx() const { return nx_; }
    [[nodiscard]] std::uint32_t nz() const { return nz_; }
    [[nodiscard]] const Interval& x() const { return x_; }
    [[nodiscard]] const Interval& z() const { return z_; }
    [[nodiscard]] MapPoint middle(std::size_t c) const;
    // The column of a particle of the last sum.
    [[nodiscard]] std::uint32_t of(std::size_t particle) const { return column_of_[particle]; }
    [[nodiscard]] bool is_wet(std::size_t c) const { return columns_[c].particles > 0; }
    [[nodiscard]] bool is_solid(std::size_t c) const { return solid_[c]; }  // nearly all of its ground
    [[nodiscard]] double depth(std::size_t c) const;                        // m
    [[nodiscard]] double speed(std::size_t c) const;                        // m/s; of one that is wet
    // Means over its particles, m/s; of one that is wet.
    [[nodiscard]] double vx(std::size_t c) const { return columns_[c].vx / columns_[c].particles; }
    [[nodiscard]] double vz(std::size_t c) const { return columns_[c].vz / columns_[c].particles; }

 private:
    struct Column {
        double particles = 0;
        double vx = 0, vz = 0;  // sums over them, m/s
    };
    [[nodiscard]] std::uint32_t column_at(float px, float pz) const;
    void find_ground(const Scene& scene);

    bool whole_columns_;
    double particle_volume_;  // d^3, m^3
    Interval x_, z_;          // m
    float columns_per_m_x_, columns_per_m_z_;
    std::uint32_t nx_, nz_;
    std::vector<double> ground_;  // ground area of each column, m^2
    std::vector<bool> solid_;
    std::vector<Column> columns_;
    std::vector<std::uint32_t> column_of_;
};

// Whether the ground of the scene is rough anywhere.
[[nodiscard]] bool is_rough(const Scene& scene);

class BedFriction {
 public:
    // Of a scene that is_rough().
    explicit BedFriction(const Scene& scene, bool whole_columns = false);

    // Multiplies the horizontal velocity of each fluid particle by 1 / (1 + dt k): implicit, so that friction stops the
    // water at most and never turns it round.
    void apply(Particles& particles, float dt);

 private:
    WaterColumns columns_;
    std::vector<double> coefficient_;  // g n^2 of a column, m^(1/3)
    double least_depth_;               // m
    std::vector<float> factor_;        // of a column
};

}  // namespace wade::fluid
