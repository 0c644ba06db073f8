#pragma once
// What can be measured of a water of steering particles.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "fluid_server/steering/steering_world.hpp"

namespace wade::steering_map {

using fluid::steering::SteeringWorld;

// Advances by whole frames until `time` s are over; calls on_frame(t) after each. Returns CPU time of the steps, s.
double run_for(SteeringWorld& world, double time, const std::function<void(double t)>& on_frame = {});

// Of water at rest in a box.
struct Packing {
    double spacing = 0;          // mean distance of the nearest neighbour, m
    double density = 0;          // of the inner third of the height, over rest density
    double bottom = 0, top = 0;  // of the lowest and the highest sixth below the surface
    double depth = 0;            // of the water: twice the mean height, m
    double unevenness = 0;       // largest less smallest surface height of columns 4 d wide, m
};
[[nodiscard]] Packing measure_packing(const SteeringWorld& world);

// Mean velocity along -x by height, in bins of the channel's height, m/s.
struct Profile {
    std::vector<double> velocity, count;
    explicit Profile(std::size_t bins) : velocity(bins), count(bins) {}
    void add(const SteeringWorld& world);
    [[nodiscard]] double mean(std::size_t k) const { return count[k] > 0 ? velocity[k] / count[k] : 0; }
};

// u(y) = slip + curvature y (height - y), least squares.
struct Parabola {
    double slip = 0, curvature = 0, residual = 0;  // residual: rms over the span of u
};
[[nodiscard]] Parabola fit_parabola(const Profile& profile, double height);

// Of a fluid with a yield stress, stress = yield + viscosity * shear rate (Bingham 1922), least squares over the heights at which
// the profile shears by more than a twentieth of its steepest. drive: acceleration along the planes, m/s^2; stress over density.
struct Bingham {
    double yield = 0;      // m^2/s^2
    double viscosity = 0;  // m^2/s
    double sheared = 0;    // share of the height that shears
};
[[nodiscard]] Bingham fit_bingham(const Profile& profile, double height, double drive);

}  // namespace wade::steering_map
