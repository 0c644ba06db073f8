#pragma once
// The particles of the fluid as structure of arrays.

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace wade::fluid {

enum class Kind : std::uint8_t {
    fluid,  // moved by the solver
    inflow  // still inside the emitter, or in a guard (mixed/): moves with a velocity that it is given
};

// Sweeps work on clusters of particles that follow one another, one a lane of a vector: no more than this.
inline constexpr std::size_t largest_cluster = 16;

// Returns the length of an array with one number a particle, padded so that neighbour loops may touch whole clusters.
inline std::size_t padded(std::size_t capacity) {
    return (capacity / largest_cluster + 2) * largest_cluster;
}

// One entry a particle in every array; only the first `count` are alive. Sizes are fixed at construction.
struct Particles {
    std::size_t count = 0;
    std::vector<float> x, y, z;     // m
    std::vector<float> vx, vy, vz;  // m/s
    // Pressures over rest density, m^2/s^2, kept from step to step as first guess of the next solve.
    std::vector<float> pressure;        // that of the water: of the divergence-free solve, which carries all forces
    std::vector<float> shift_pressure;  // of the constant-density solve, which moves positions only
    std::vector<Kind> kind;

    explicit Particles(std::size_t capacity)
        : x(padded(capacity)),
          y(padded(capacity)),
          z(padded(capacity)),
          vx(padded(capacity)),
          vy(padded(capacity)),
          vz(padded(capacity)),
          pressure(padded(capacity)),
          shift_pressure(padded(capacity)),
          kind(capacity, Kind::fluid) {}

    [[nodiscard]] std::size_t capacity() const { return kind.size(); }

    // Adds a particle; its pressure over rest density, m^2/s^2, is a first guess. Throws std::length_error if there is no room.
    void add(const std::array<float, 3>& position, const std::array<float, 3>& velocity, Kind k,
             float first_pressure = 0) {
        if (count == capacity()) {
            throw std::length_error("no room for one more fluid particle: fluid.max_particles is " +
                                    std::to_string(capacity()));
        }
        const std::size_t i = count++;
        x[i] = position[0], y[i] = position[1], z[i] = position[2];
        vx[i] = velocity[0], vy[i] = velocity[1], vz[i] = velocity[2];
        pressure[i] = first_pressure, shift_pressure[i] = 0;
        kind[i] = k;
    }
};

// Every array of a particle's numbers but `kind`, for whoever copies or stores whole particles.
struct ParticleArray {
    const char* name;
    std::vector<float> Particles::*values;
};
inline constexpr std::array<ParticleArray, 8> particle_arrays{{{"x", &Particles::x},
                                                               {"y", &Particles::y},
                                                               {"z", &Particles::z},
                                                               {"vx", &Particles::vx},
                                                               {"vy", &Particles::vy},
                                                               {"vz", &Particles::vz},
                                                               {"shift_pressure", &Particles::shift_pressure},
                                                               {"pressure", &Particles::pressure}}};

}  // namespace wade::fluid
