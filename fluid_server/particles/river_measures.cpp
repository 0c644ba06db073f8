#include "fluid_server/particles/river_measures.hpp"

#include "fluid_server/particles/parallel.hpp"
#include "shm_protocol/layout.hpp"

namespace wade::fluid {

RiverMeasures measure_river(const Particles& p, double particle_mass, double gravity,
                            const std::vector<BedFacet>& bed) {
    struct Sums {
        double n = 0, height = 0, bed = 0, speed = 0, v2 = 0;
    };
    BlockSums<Sums> sums;
    sums.begin(p.count);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        Sums block;
        for (std::size_t i = begin; i < end; ++i) {
            if (p.kind[i] == Kind::fluid) {
                const double vx = static_cast<double>(p.vx[i]);
                const double vy = static_cast<double>(p.vy[i]);
                const double vz = static_cast<double>(p.vz[i]);
                block.n += 1;
                block.height += static_cast<double>(p.y[i]);
                block.bed += static_cast<double>(bed_height(bed, p.x[i]));
                block.speed -= vx;
                block.v2 += vx * vx + vy * vy + vz * vz;
            }
        }
        sums[b] = block;
    });
    const Sums all = sums.total([](Sums& total, const Sums& block) {
        total.n += block.n;
        total.height += block.height;
        total.bed += block.bed;
        total.speed += block.speed;
        total.v2 += block.v2;
    });
    if (all.n == 0) {
        return {shm::Diagnostics::not_given, shm::Diagnostics::not_given, 0, 0};
    }
    return {2 * (all.height - all.bed) / all.n, all.speed / all.n, 0.5 * particle_mass * all.v2,
            particle_mass * gravity * all.height};
}

}  // namespace wade::fluid
