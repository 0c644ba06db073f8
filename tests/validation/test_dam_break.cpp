// Ritter (1892): a dam breaks over a dry, smooth bed.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <vector>

#include "run_frames.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// Depth at distance s downstream of the dam, t after the break: h = (2 c - s/t)^2 / (9 g) between s = -c t and 2 c t.
double ritter_depth(double s, double t, double initial_depth, double g) {
    const double c = std::sqrt(g * initial_depth);
    const double u = s / t;
    if (u <= -c) {
        return initial_depth;
    }
    return u >= 2 * c ? 0 : (2 * c - u) * (2 * c - u) / (9 * g);
}

}  // namespace

TEST_CASE("a dam break over a dry bed follows Ritter's depth", "[validation][dam_break]") {
    const Scene scene = test::shipped_scene("validation/dam_break.json");
    FluidWorld world(scene);
    const WaterBlock& reservoir = scene.channel.water_blocks.at(0);
    const double depth = reservoir.depth;
    const double g = scene.world.gravity;
    const double d3 = std::pow(scene.fluid.particle_spacing, 3);
    const double width = scene.channel.z.length();
    const double column = 0.2;  // m, four spacings: columns over which the depth is averaged
    const auto columns = static_cast<std::size_t>(std::lround(scene.channel.x.length() / column));
    const int frames = static_cast<int>(std::lround(scene.duration * scene.frame_rate));

    double worst = 0;
    double density_error = 0;
    for (int f = 1; f <= frames; ++f) {
        test::advance_one_frame(
            world, [&](const StepReport& step) { density_error = std::max(density_error, step.max_density_error); });
        const double t = f / scene.frame_rate;
        const double scaled = t * std::sqrt(g / depth);
        if (scaled < 4 || scaled > 8) {
            continue;
        }
        const Particles& p = world.particles();
        std::vector<double> h(columns, 0);
        double tip = scene.channel.x.hi;
        for (std::size_t i = 0; i < p.count; ++i) {
            const double x = static_cast<double>(p.x[i]);
            h[std::min(static_cast<std::size_t>(x / column), columns - 1)] += d3 / (column * width);
            tip = std::min(tip, x);
        }
        double l1 = 0;
        int compared = 0;
        for (std::size_t k = 0; k < columns; ++k) {
            const double exact = ritter_depth(reservoir.x.lo - (static_cast<double>(k) + 0.5) * column, t, depth, g);
            if (exact > 0.15 * depth) {
                l1 += std::abs(h[k] - exact) / depth;
                ++compared;
            }
        }
        l1 /= compared;
        worst = std::max(worst, l1);
        if (f % 10 == 0 || f == frames) {
            std::cout << "dam break: t sqrt(g/H) = " << scaled << ", L1 of depth " << 100 * l1 << " % of H, tip at "
                      << (reservoir.x.lo - tip) / (2 * std::sqrt(g * depth) * t) << " of Ritter's\n";
        }
    }
    std::cout << "dam break: worst L1 " << 100 * worst << " % of H, max density error " << 100 * density_error
              << " %\n";
    // 5 %: between the 3.4 % of a second-order shallow-water grid of 0.25 m and the 12 to 18 % that particle codes show
    // at the front.
    CHECK(worst <= 0.05);
    CHECK(world.position_clamps() == 0);
}
