#pragma once
// Sources and outlets of a site, particle by particle.
//
//   N(t) = floor(V(t) / d^3)     particles that a source has made by then, V the integral of its hydrograph
//
//      . <- at rest, above the water  A source makes its next particle where the fewest particles lie on its ground, at
//   ~~~~~~~~                          the lowest free height. As in the shallow water it adds mass and no momentum: the
//   o o o o o                         weight of the water under a source drives the outflow from it.
//
// A free outlet removes particles in its polygon, or no further than d from its line, or beyond a side of the world
// that is open all along. The inflow depends on the time alone, so that a run can continue from a state of any time.

#include <cstdint>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"
#include "fluid_server/particles/channel_ends.hpp"
#include "fluid_server/particles/mirror.hpp"
#include "fluid_server/particles/site/site_shape.hpp"

namespace wade::fluid {

// Square cells in plan.
struct PlanCells {
    float x = 0, z = 0, per_m = 1;  // corner, m; cells per m
    int nx = 0, nz = 0;

    [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(nz); }
    // -1: outside.
    [[nodiscard]] int at(float px, float pz) const {
        const float column = (px - x) * per_m, row = (pz - z) * per_m;
        const bool inside = column >= 0 && row >= 0 && column < static_cast<float>(nx) && row < static_cast<float>(nz);
        return inside ? static_cast<int>(row) * nx + static_cast<int>(column) : -1;
    }
    [[nodiscard]] MapPoint middle(int cell) const {
        const double side = 1 / static_cast<double>(per_m);
        const int column = cell % nx, row = cell / nx;
        return {static_cast<double>(x) + (column + 0.5) * side, static_cast<double>(z) + (row + 0.5) * side};
    }
};

struct ParticleSource {
    Series discharge;                      // m3/s
    PlanCells cells;                       // d wide each, over the source and a cell beyond
    std::vector<int> sites;                // cells that it fills with particles
    std::vector<float> ground;             // of each cell, m
    std::vector<std::vector<Vec3>> water;  // particles over each cell; of the moment, kept for its memory
};

struct ParticleOutlet {
    PlanCells cells;
    std::vector<bool> takes;  // of each cell
};

class SiteEnds final : public ChannelEnds {
 public:
    // Throws ConfigurationError for a source that has no site on open ground.
    explicit SiteEnds(const Scene& scene);

    void begin_step(Particles& particles, double time, double dt) override;
    // "12 m3 came in, 3 m3 went out", of this run.
    [[nodiscard]] std::string remark() const override;

 private:
    void take_leavers(Particles& particles);
    // Those with the numbers [before, now) of a source.
    void make(ParticleSource& source, std::uint64_t before, std::uint64_t now, Particles& particles);

    double spacing_, volume_;  // d, m; d^3, m3
    SiteShape shape_;
    std::vector<ParticleSource> sources_;
    std::vector<ParticleOutlet> outlets_;
    std::uint64_t made_ = 0, left_ = 0, missed_ = 0;
};

}  // namespace wade::fluid
