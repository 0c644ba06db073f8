#pragma once
// Measures the current depth of the water.
//
// A scene says how deep its water is at the start or in its stream. Behind a hydraulic jump or before a wall it may stand
// several times as deep: pressure acts faster there, which the time step must know, and the divergence solve has more layers of
// particles to hold up (PressureSolver). So where particles are more than twice as high as the scene's water is deep, and
// higher than ten layers, columns are measured, two support radii or somewhat more in length and width:
//
//   depth of a column = volume of its particles / its area.
//
// Spray adds next to nothing to it, and a sheet one particle thick a quarter of its height. If the deepest column is
// more than twice as deep as the scene's water, its depth counts.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

class WaterDepth {
 public:
    explicit WaterDepth(const Scene& scene);

    // m. highest: of the particles, m.
    [[nodiscard]] double now(const Particles& particles, double highest);

 private:
    [[nodiscard]] double deepest_column(const Particles& particles);

    double of_scene_;
    double spacing_;
    Interval x_, z_;
    std::size_t nx_, nz_;
    std::vector<std::uint32_t> particles_in_;  // by column
};

}  // namespace wade::fluid
