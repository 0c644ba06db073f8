#include "fluid_server/particles/filling.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/particle_volume.hpp"
#include "configs/scene/world.hpp"

namespace wade::fluid {

namespace {

// A particle stands for a cube of side d: it is free of a solid if its centre is about half of that away. Without the
// margin a particle next to a face would see its own image too near and be shot away in the first step.
constexpr double clearance = 0.45;

// `wanted` particles over a block, layer by layer from below, as far apart as it takes for each site to have the volume
// d^3, whatever the rounding along the other two axes.
void fill_layers(Particles& particles, const WaterBlock& block, const Surroundings& in, double gravity,
                 std::uint64_t wanted) {
    const int nx = count_along(block.x.length(), in.spacing);
    const int nz = count_along(block.z.length(), in.spacing);
    const double dx = block.x.length() / nx;
    const double dz = block.z.length() / nz;
    const auto layer = static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(nz);
    const std::uint64_t layers = (wanted + layer - 1) / layer;
    double dy = particle_volume(in.spacing) / (dx * dz);
    if (in.lid) {
        dy = block.depth / static_cast<double>(layers);
    }
    const std::array<float, 3> v{static_cast<float>(block.velocity[0]), static_cast<float>(block.velocity[1]),
                                 static_cast<float>(block.velocity[2])};
    for (std::uint64_t j = 0; j < layers; ++j) {
        // Under a lid all layers leave out as many sites.
        const std::uint64_t here =
            in.lid ? wanted * (j + 1) / layers - wanted * j / layers : std::min(layer, wanted - j * layer);
        const double y = block.y_min + (static_cast<double>(j) + 0.5) * dy;
        const double pressure = std::max(0.0, gravity * (block.y_min + block.depth - y));
        std::uint64_t site = 0;
        for (int k = 0; k < nz; ++k) {
            for (int i = 0; i < nx; ++i, ++site) {
                const bool filled = (site + 1) * here / layer != site * here / layer;
                const Vec3 x{static_cast<float>(block.x.lo + (i + 0.5) * dx), static_cast<float>(y),
                             static_cast<float>(block.z.lo + (k + 0.5) * dz)};
                if (filled && is_free(x, in.obstacles, in.spacing)) {
                    particles.add(x, v, Kind::fluid, static_cast<float>(pressure));
                }
            }
        }
    }
}

// Slabs one spacing long, each standing on the bed at its middle.
void fill_slabs(Particles& particles, const WaterBlock& block, const Surroundings& in) {
    const int slabs = count_along(block.x.length(), in.spacing);
    const double length = block.x.length() / slabs;
    double volume = 0;
    std::uint64_t filled = 0;
    for (int s = 0; s < slabs; ++s) {
        WaterBlock slab = block;
        slab.x = {block.x.lo + s * length, block.x.lo + (s + 1) * length};
        slab.y_min = static_cast<double>(bed_height(in.bed, static_cast<float>(0.5 * (slab.x.lo + slab.x.hi))));
        slab.depth = block.depth - slab.y_min;
        if (slab.depth <= 0) {
            continue;
        }
        volume += length * slab.depth * block.z.length();
        const std::uint64_t due = particles_in(volume, in.spacing);
        fill_layers(particles, slab, in, in.gravity, due - filled);
        filled = due;
    }
}

}  // namespace

bool is_free(const Vec3& x, const std::vector<Obstacle>& obstacles, double spacing) {
    const double margin = clearance * spacing;
    return std::none_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) {
        const auto within = [&](float v, const Interval& span) {
            return static_cast<double>(v) > span.lo - margin && static_cast<double>(v) < span.hi + margin;
        };
        return within(x[0], o.x) && within(x[2], o.z) && static_cast<double>(x[1]) < o.height + margin;
    });
}

int count_along(double extent, double spacing) {
    return std::max(1, static_cast<int>(std::lround(extent / spacing)));
}

void fill_block(Particles& particles, const WaterBlock& block, const Surroundings& in) {
    const bool stands_on_bed = block.y_min == 0;
    if (stands_on_bed && !in.bed.empty()) {
        fill_slabs(particles, block, in);
        return;
    }
    const double volume = block.x.length() * block.depth * block.z.length();
    fill_layers(particles, block, in, stands_on_bed ? in.gravity : 0, particles_in(volume, in.spacing));
}

void fill_scene(Particles& particles, const Scene& scene) {
    const Channel& channel = scene.channel;
    const double gravity = scene.world->gravity * std::cos(std::atan(channel.slope));
    const Surroundings surroundings{scene.fluid->particle_spacing, gravity, channel.top != Top::open,
                                    bed_facets(channel), scene.obstacles};
    if (channel.flow != Flow::closed && channel.initial_river == InitialRiver::filled) {
        fill_block(particles, {channel.x, channel.z, channel.depth, 0, {-channel.velocity, 0, 0}}, surroundings);
    }
    for (const WaterBlock& block : channel.water_blocks) {
        fill_block(particles, block, surroundings);
    }
}

bool fills_channel(const Scene& scene, double volume) {
    const Channel& channel = scene.channel;
    if (channel.top == Top::open || channel.flow == Flow::emitter) {
        return false;
    }
    double space = channel.x.length() * channel.z.length() * channel.height;
    for (const Obstacle& o : scene.obstacles) {
        space -= o.x.length() * o.z.length() * std::min(o.height, channel.height);
    }
    const std::vector<BedFacet> bed = bed_facets(channel);
    constexpr int slabs = 1000;
    for (int k = 0; k < slabs && !bed.empty(); ++k) {
        const double x = channel.x.lo + (k + 0.5) / slabs * channel.x.length();
        space -= channel.x.length() / slabs * channel.z.length() *
                 static_cast<double>(bed_height(bed, static_cast<float>(x)));
    }
    return volume > 0.95 * space;
}

}  // namespace wade::fluid
