#include "fluid_server/filling.hpp"

#include <algorithm>
#include <cmath>

namespace wade::fluid {

std::uint64_t Lattice::sites() const {
    return static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(ny) * static_cast<std::uint64_t>(nz);
}

Lattice lattice_over(double length, double depth, double width, double spacing, std::uint64_t wanted) {
    const auto along = [&](double extent) { return std::max(1, static_cast<int>(std::lround(extent / spacing))); };
    Lattice lattice{along(length), along(depth), along(width)};
    // Grow the longer horizontal axis until there is a site for every particle; the depth keeps its layers.
    int& longest = length >= width ? lattice.nx : lattice.nz;
    while (lattice.sites() < wanted) {
        ++longest;
    }
    lattice.dx = static_cast<float>(length / lattice.nx);
    lattice.dy = static_cast<float>(depth / lattice.ny);
    lattice.dz = static_cast<float>(width / lattice.nz);
    return lattice;
}

void fill_block(Particles& particles, const Interval& x, double depth, const Interval& z, double spacing, float vx) {
    const double volume = x.length() * depth * z.length();
    const auto wanted = static_cast<std::uint64_t>(std::llround(volume / (spacing * spacing * spacing)));
    const Lattice lattice = lattice_over(x.length(), depth, z.length(), spacing, wanted);
    const std::uint64_t layer = lattice.sites() / static_cast<std::uint64_t>(lattice.ny);
    const std::uint64_t left_out = lattice.sites() - wanted;
    for (int j = 0; j < lattice.ny; ++j) {
        std::uint64_t site = 0;
        for (int k = 0; k < lattice.nz; ++k) {
            for (int i = 0; i < lattice.nx; ++i, ++site) {
                const bool top = j == lattice.ny - 1;
                if (top && (site + 1) * left_out / layer != site * left_out / layer) {
                    continue;
                }
                particles.add(static_cast<float>(x.lo) + (static_cast<float>(i) + 0.5F) * lattice.dx,
                              (static_cast<float>(j) + 0.5F) * lattice.dy,
                              static_cast<float>(z.lo) + (static_cast<float>(k) + 0.5F) * lattice.dz, vx, Kind::fluid);
            }
        }
    }
}

void fill_scene(Particles& particles, const Scene& scene) {
    const Channel& channel = scene.channel;
    const double spacing = scene.fluid.particle_spacing;
    if (channel.flow != Flow::closed && channel.initial_river == InitialRiver::filled) {
        fill_block(particles, channel.x, channel.depth, channel.z, spacing, static_cast<float>(-channel.velocity));
    }
    for (const WaterBlock& block : channel.water_blocks) {
        fill_block(particles, block.x, block.depth, block.z, spacing, 0);
    }
}

double deepest_water(const Scene& scene) {
    double depth = scene.channel.flow == Flow::closed ? 0 : scene.channel.depth;
    for (const WaterBlock& block : scene.channel.water_blocks) {
        depth = std::max(depth, block.depth);
    }
    return depth;
}

}  // namespace wade::fluid
