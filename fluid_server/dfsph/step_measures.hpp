#pragma once
// What a step of the water asks of all particles at once, and what is no water any more.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "configs/scene/scene.hpp"
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

// What is no water any more throws RunError (numerical_failure), with advice on the settings of the fluid.

// fastest: of what moves, m/s; expected: of what the scene speaks of, m/s, 0 = nothing.
void check_speed(const Particles& particles, double fastest, double expected, const Fluid& fluid);

// A mean density error, a fraction of rest density.
void check_compression(double mean_error, const Fluid& fluid);

// After a step: particles that are somewhere no longer finite, and the longest way, m.
void check_moves(std::uint64_t not_finite, double longest, double support_radius, const Fluid& fluid);

inline Motion StepMeasures::motion(const Particles& p) {
    extremes_.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        float fastest = 0, highest = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const float v2 = p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
            fastest = std::max(fastest, v2);
            highest = std::max(highest, p.y[i]);
        }
        extremes_[b].max = static_cast<double>(fastest);
        extremes_[b].highest = static_cast<double>(highest);
    });
    const Extremes all = extremes_.total([](Extremes& total, const Extremes& block) {
        total.max = std::max(total.max, block.max);
        total.highest = std::max(total.highest, block.highest);
    });
    return {std::sqrt(all.max), all.highest};
}

inline DensityError StepMeasures::density_error(const std::vector<float>& density, std::size_t count) {
    extremes_.begin(count);
    for_each_block(count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        Extremes& block = extremes_[b];
        for (std::size_t i = begin; i < end; ++i) {
            const double error = std::max(0.0, static_cast<double>(density[i]) - 1);
            block.sum += error;
            block.max = std::max(block.max, error);
        }
    });
    const Extremes all = extremes_.total([](Extremes& total, const Extremes& block) {
        total.sum += block.sum;
        total.max = std::max(total.max, block.max);
    });
    return {count == 0 ? 0 : all.sum / static_cast<double>(count), all.max};
}

}  // namespace wade::fluid
