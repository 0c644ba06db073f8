#pragma once
// What a step of the water asks of all particles at once.

#include <cstddef>
#include <vector>

#include "fluid_server/particles/parallel.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

struct Motion {
    double fastest = 0;  // m/s
    double highest = 0;  // above y = 0, m
};

// Of max(0, rho / rho_0 - 1) over particles.
struct DensityError {
    double mean = 0, max = 0;
};

// Kept from step to step, so that it allocates nothing.
class StepMeasures {
 public:
    [[nodiscard]] Motion motion(const Particles& particles);

    // density: over rest density, of `count` particles.
    [[nodiscard]] DensityError density_error(const std::vector<float>& density, std::size_t count);

 private:
    struct Extremes {
        double sum = 0, max = 0, highest = 0;
    };
    BlockSums<Extremes> extremes_;
};

}  // namespace wade::fluid
