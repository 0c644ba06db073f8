#include "fluid_server/filling.hpp"

#include <algorithm>
#include <cmath>

namespace wade::fluid {

namespace {

// A particle stands for a cube of side d: it is free of a solid if its centre is about half of that away. Without the
// margin a particle next to a face would see its own image too near and be shot away in the first step.
constexpr double clearance = 0.45;

bool is_free(const Vec3& x, const std::vector<Obstacle>& obstacles, double spacing) {
    const double margin = clearance * spacing;
    return std::none_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) {
        const auto within = [&](float v, const Interval& span) {
            return static_cast<double>(v) > span.lo - margin && static_cast<double>(v) < span.hi + margin;
        };
        return within(x[0], o.x) && within(x[2], o.z) && static_cast<double>(x[1]) < o.height + margin;
    });
}

// `wanted` particles over a block, row by row.
void fill_lattice(Particles& particles, const WaterBlock& block, double spacing, std::uint64_t wanted,
                  const std::vector<Obstacle>& obstacles) {
    const Lattice lattice = lattice_over(block.x.length(), block.depth, block.z.length(), spacing, wanted);
    const std::uint64_t layer = lattice.sites() / static_cast<std::uint64_t>(lattice.ny);
    const std::uint64_t surplus = lattice.sites() - wanted;
    // Surplus sites are left out of the uppermost layers, half a layer each at most.
    const std::uint64_t thinned = std::min(lattice.sites(), layer * (1 + 2 * surplus / layer));
    std::uint64_t above = lattice.sites();  // sites from this one on
    const Vec3 v{static_cast<float>(block.velocity[0]), static_cast<float>(block.velocity[1]),
                 static_cast<float>(block.velocity[2])};
    for (int j = 0; j < lattice.ny; ++j) {
        for (int k = 0; k < lattice.nz; ++k) {
            for (int i = 0; i < lattice.nx; ++i, --above) {
                const bool left_out = above <= thinned && above * surplus / thinned != (above - 1) * surplus / thinned;
                const Vec3 x{static_cast<float>(block.x.lo) + (static_cast<float>(i) + 0.5F) * lattice.dx,
                             static_cast<float>(block.y_min) + (static_cast<float>(j) + 0.5F) * lattice.dy,
                             static_cast<float>(block.z.lo) + (static_cast<float>(k) + 0.5F) * lattice.dz};
                if (!left_out && is_free(x, obstacles, spacing)) {
                    particles.add(x, v, Kind::fluid);
                }
            }
        }
    }
}

}  // namespace

std::uint64_t Lattice::sites() const {
    return static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(ny) * static_cast<std::uint64_t>(nz);
}

Lattice lattice_over(double length, double depth, double width, double spacing, std::uint64_t wanted) {
    const auto along = [&](double extent) { return std::max(1, static_cast<int>(std::lround(extent / spacing))); };
    Lattice lattice{along(length), along(depth), along(width)};
    if (wanted > 0) {
        // The longer horizontal axis has as many sites as it takes; the depth keeps its layers.
        int& longest = length >= width ? lattice.nx : lattice.nz;
        const std::uint64_t across = lattice.sites() / static_cast<std::uint64_t>(longest);
        longest = static_cast<int>((wanted + across - 1) / across);
    }
    lattice.dx = static_cast<float>(length / lattice.nx);
    lattice.dy = static_cast<float>(depth / lattice.ny);
    lattice.dz = static_cast<float>(width / lattice.nz);
    return lattice;
}

void fill_block(Particles& particles, const WaterBlock& block, double spacing, const std::vector<Obstacle>& obstacles) {
    const double volume = block.x.length() * block.depth * block.z.length();
    const auto wanted = static_cast<std::uint64_t>(std::llround(volume / (spacing * spacing * spacing)));
    fill_lattice(particles, block, spacing, wanted, obstacles);
}

void fill_above_bed(Particles& particles, const WaterBlock& block, double spacing, const std::vector<BedFacet>& bed,
                    const std::vector<Obstacle>& obstacles) {
    const auto slabs = std::max(1L, std::lround(block.x.length() / spacing));
    const double length = block.x.length() / static_cast<double>(slabs);
    double volume = 0;
    std::uint64_t filled = 0;
    for (long s = 0; s < slabs; ++s) {
        WaterBlock slab = block;
        slab.x.lo = block.x.lo + static_cast<double>(s) * length;
        slab.x.hi = slab.x.lo + length;
        slab.y_min = static_cast<double>(bed_height(bed, static_cast<float>(0.5 * (slab.x.lo + slab.x.hi))));
        slab.depth = block.depth - slab.y_min;
        if (slab.depth <= 0) {
            continue;
        }
        volume += length * slab.depth * block.z.length();
        const auto due = static_cast<std::uint64_t>(std::llround(volume / (spacing * spacing * spacing)));
        fill_lattice(particles, slab, spacing, due - filled, obstacles);
        filled = due;
    }
}

void fill_scene(Particles& particles, const Scene& scene) {
    const Channel& channel = scene.channel;
    const double spacing = scene.fluid.particle_spacing;
    const std::vector<BedFacet> bed = bed_facets(channel);
    const auto fill = [&](const WaterBlock& block) {
        if (bed.empty() || block.y_min > 0) {
            fill_block(particles, block, spacing, scene.obstacles);
        } else {
            fill_above_bed(particles, block, spacing, bed, scene.obstacles);
        }
    };
    if (channel.flow != Flow::closed && channel.initial_river == InitialRiver::filled) {
        fill({channel.x, channel.z, channel.depth, 0, {-channel.velocity, 0, 0}});
    }
    for (const WaterBlock& block : channel.water_blocks) {
        fill(block);
    }
}

double deepest_water(const Scene& scene) {
    const Channel& channel = scene.channel;
    const bool by_blocks = channel.flow == Flow::closed || !channel.water_blocks.empty();
    double depth = by_blocks ? 0 : channel.depth;
    for (const WaterBlock& block : channel.water_blocks) {
        depth = std::max(depth, block.y_min + block.depth);
    }
    return depth;
}

}  // namespace wade::fluid
