#include "configs/scene/kernel_choice.hpp"

#include <algorithm>
#include <array>

#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/scene_capacity.hpp"

namespace wade {
namespace {

bool fills_its_channel(const Scene& scene) {
    if (scene.channel->top == Top::open) return false;
    return scene.channel->top == Top::periodic ||
           deepest_water(scene) > scene.channel->height - scene.fluid->particle_spacing;
}

// Blocks of one level, at rest, that cover the channel.
bool is_tank(const Channel& channel) {
    double area = 0;
    for (const WaterBlock& block : channel.water_blocks) {
        const bool rests = std::all_of(block.velocity.begin(), block.velocity.end(), [](double v) { return v == 0; });
        const WaterBlock& first = channel.water_blocks.front();
        if (!rests || block.y_min > 0 || block.depth != first.depth) return false;
        area += block.x.length() * block.z.length();
    }
    constexpr double nearly = 1 - 1e-6;
    return area >= nearly * channel.x.length() * channel.z.length();
}

bool has_front(const Channel& channel) {
    if (channel.flow == Flow::closed || !channel.water_blocks.empty()) return !is_tank(channel);
    return channel.flow != Flow::recirculating && channel.initial_river == InitialRiver::dry;
}

// Whether walls and periods are as far apart as the scene checks will ask.
bool has_room(const Scene& scene, KernelKind kernel) {
    Fluid fluid = scene.fluid;
    fluid.kernel = kernel;
    const Channel& channel = scene.channel;
    const double support = support_radius_of(fluid);
    const double walls_apart = support - fluid.particle_spacing, period = 3 * support;
    double highest_bed = 0;
    for (const BedPoint& point : channel.bed_points) highest_bed = std::max(highest_bed, point.y);
    const auto along_x = channel.flow == Flow::closed ? walls_apart : channel.flow == Flow::emitter ? 0 : period;
    const auto along_z = channel.sides == Sides::walls ? walls_apart : period;
    const auto upwards = channel.top == Top::open ? 0 : channel.top == Top::wall ? walls_apart + highest_bed : period;
    return channel.x.length() >= along_x && channel.z.length() >= along_z && channel.height >= upwards;
}

}  // namespace

KernelKind kernel_needed(const Scene& scene) {
    constexpr std::array nearer_and_nearer{KernelKind::wendland_c2, KernelKind::quartic_spline};
    if (scene.fluid->support_in_spacings != 2) return KernelKind::cubic_spline;
    const bool is_full = fills_its_channel(scene);
    if (!is_full && has_front(scene.channel)) return KernelKind::cubic_spline;
    for (const KernelKind kernel : nearer_and_nearer) {
        if ((is_full || kernel != KernelKind::wendland_c2) && has_room(scene, kernel)) return kernel;
    }
    return KernelKind::cubic_spline;
}

void choose_kernel(Scene& scene) {
    if (scene.fluid->kernel == KernelKind::automatic) scene.fluid->kernel = kernel_needed(scene);
}

}  // namespace wade
