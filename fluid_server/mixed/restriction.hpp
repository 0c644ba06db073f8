#pragma once
// Averages the water of the window onto the grid, for the shallow water around it.
//
// The mean of the particles round the middle c of a cell has tent-shaped weights of half width W, whole cells and at least
// two spacings:
//
//   h_c = sum_i V_i w_ic / n_c,   (h u)_c = sum_i V_i u_i w_ic / n_c,   n_c = integral of w over the free cells round c,
//
//   w = (1 - |x - x_c| / W) (1 - |z - z_c| / W)
//
// V_i the volume of a particle; banks, walls and obstacles take their part of the weights away. The cells of the window
// continue as shallow water and relax to these means by the fraction 1 - exp(-dt / T) in a step of dt.
// T = W / sqrt(g H) is the time that a wave takes to pass such a mean. So waves leave the window unchanged, and single
// particles do not disturb the grid: with two layers of particles a cell of a spacing squared holds two or three.

#include <vector>

#include "fluid_server/mixed/window.hpp"
#include "fluid_server/particles/particles.hpp"
#include "fluid_server/shallow_water/step.hpp"

namespace wade::fluid::mixed {

class Restriction {
 public:
    explicit Restriction(const shallow_water::ShallowWater& world);

    // Draws the cells of the window to the means of the particles, guards included.
    void apply(shallow_water::ShallowWater& world, const Particles& particles, const Window& window, double dt);

    [[nodiscard]] double time() const { return time_; }  // T, s

 private:
    void add_particles(const shallow_water::ShallowWater& world, const Particles& particles, const Window& window);

    std::ptrdiff_t reach_;  // W in cells
    double time_;
    bool periodic_across_;
    double particle_volume_;
    std::vector<double> area_;                      // n, m^2 by cell; 0 in cells that an obstacle fills
    std::vector<double> volume_, flow_x_, flow_z_;  // sums by cell
};

}  // namespace wade::fluid::mixed
