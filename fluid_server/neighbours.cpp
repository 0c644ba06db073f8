#include "fluid_server/neighbours.hpp"

#include <algorithm>
#include <cmath>

#include "configs/scene_capacity.hpp"

namespace wade::fluid {

void NeighbourBlock::reserve(std::size_t pairs) {
    if (pairs <= j.size()) {
        return;
    }
    pairs += pairs / 4;  // so that growing is rare and little is left over
    j.resize(pairs);
    gx.resize(pairs);
    gy.resize(pairs);
    gz.resize(pairs);
    gradient_factor.resize(pairs);
}

namespace {

constexpr std::size_t chunk_size = 64;  // candidates tested together

// Appends to the block all candidates near the point x; accept(j, what to add to its position) may still refuse one.
template <typename Accept>
void append_near(const CellGrid& grid, const Particles& p, const Vec3& at, float h2, NeighbourBlock& block,
                 std::size_t& n, Accept&& accept) {
    std::array<float, chunk_size> r2{};
    std::array<std::uint32_t, chunk_size> near{};
    grid.for_each_run(at[0], at[1], at[2], [&](std::size_t from, std::size_t to, const Vec3& shift) {
        const float sx = at[0] - shift[0];
        const float sy = at[1] - shift[1];
        const float sz = at[2] - shift[2];
        for (std::size_t chunk = from; chunk < to; chunk += chunk_size) {
            const std::size_t size = std::min(chunk_size, to - chunk);
            const float* x = p.x.data() + chunk;
            const float* y = p.y.data() + chunk;
            const float* z = p.z.data() + chunk;
#pragma omp simd
            for (std::size_t c = 0; c < size; ++c) {
                const float dx = sx - x[c];
                const float dy = sy - y[c];
                const float dz = sz - z[c];
                r2[c] = dx * dx + dy * dy + dz * dz;
            }
            // Each candidate is written; only one that is near, and then only one that is accepted, moves the end.
            std::size_t found = 0;
            for (std::size_t c = 0; c < size; ++c) {
                near[found] = static_cast<std::uint32_t>(c);
                found += r2[c] < h2 ? 1U : 0U;
            }
            std::uint32_t* j = block.j.data();
            float* dx = block.gx.data();
            float* dy = block.gy.data();
            float* dz = block.gz.data();
            for (std::size_t c = 0; c < found; ++c) {
                const std::size_t candidate = near[c];
                j[n] = static_cast<std::uint32_t>(chunk + candidate);
                dx[n] = sx - x[candidate];
                dy[n] = sy - y[candidate];
                dz[n] = sz - z[candidate];
                n += accept(chunk + candidate, shift) ? 1U : 0U;
            }
            block.reserve(n + chunk_size + lanes);
        }
    });
}

// Ends a segment: fills it up to a multiple of the lanes with pairs that the kernel does not reach.
void close_segment(NeighbourBlock& block, std::uint32_t i, float support_radius, const Mirror& mirror, std::size_t& n) {
    for (; n % lanes != 0; ++n) {
        block.j[n] = i;
        block.gx[n] = support_radius;
        block.gy[n] = 0;
        block.gz[n] = 0;
    }
    block.segments.push_back({static_cast<std::uint32_t>(n), static_cast<std::int16_t>(mirror.obstacle),
                              static_cast<std::int16_t>(mirror.obstacle_axis), mirror.reflection, mirror.viscous});
    block.reserve(n + chunk_size + lanes);
}

template <typename AnyKernel>
void fill_lists(const CellGrid& grid, const Solids& solids, const Particles& p, const AnyKernel& kernel,
                float support_radius, float volume, NeighbourLists& lists) {
    const float h2 = support_radius * support_radius;
    const float self = volume * kernel.value(0);
    for_each_block(p.count, [&](std::size_t begin, std::size_t end, std::size_t b) {
        NeighbourBlock& block = lists.blocks[b];
        std::vector<Mirror>& mirrors = block.mirrors;
        std::size_t n = 0;
        block.segments.clear();
        block.reserve(chunk_size + lanes);
        block.first_segment[0] = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 x{p.x[i], p.y[i], p.z[i]};
            const std::size_t first = n;
            const bool by_obstacle = solids.obstacle_near(x);
            const auto at = [&](std::size_t j, const Vec3& shift) {
                return Vec3{p.x[j] + shift[0], p.y[j] + shift[1], p.z[j] + shift[2]};
            };
            append_near(grid, p, x, h2, block, n, [&](std::size_t j, const Vec3& shift) {
                return j != i && (!by_obstacle || solids.visible(x, at(j, shift)));
            });
            close_segment(block, static_cast<std::uint32_t>(i), support_radius, {}, n);
            solids.mirrors_near(x, mirrors);
            for (const Mirror& mirror : mirrors) {
                append_near(grid, p, mirror.reflect(x), h2, block, n, [&](std::size_t j, const Vec3& shift) {
                    if (mirror.facet >= 0 && !solids.sees_in_facet(x, at(j, shift), mirror)) {
                        return false;
                    }
                    return !by_obstacle || (mirror.obstacle < 0 ? solids.visible(x, mirror.reflect(at(j, shift)))
                                                                : solids.sees_image(x, at(j, shift), mirror));
                });
                close_segment(block, static_cast<std::uint32_t>(i), support_radius, mirror, n);
            }
            block.first_segment[i - begin + 1] = static_cast<std::uint32_t>(block.segments.size());

            float* gx = block.gx.data();
            float* gy = block.gy.data();
            float* gz = block.gz.data();
            float* factor = block.gradient_factor.data();
            LaneSum sum;
            for (std::size_t k = first; k < n; k += lanes) {
#pragma omp simd
                for (std::size_t l = 0; l < lanes; ++l) {
                    const float r = std::sqrt(gx[k + l] * gx[k + l] + gy[k + l] * gy[k + l] + gz[k + l] * gz[k + l]);
                    const float g = volume * kernel.gradient_factor(r);
                    sum.lane[l] += kernel.value(r);
                    factor[k + l] = g;
                    gx[k + l] *= g;
                    gy[k + l] *= g;
                    gz[k + l] *= g;
                }
            }
            lists.density[i] = self + volume * sum.total();
        }
    });
}

}  // namespace

Kernel make_kernel(const Fluid& fluid) {
    const auto h = static_cast<float>(support_radius_of(fluid));
    return fluid.kernel == KernelKind::wendland_c2 ? Kernel(WendlandC2(h)) : Kernel(CubicSpline(h));
}

void find_neighbours(const CellGrid& grid, const Solids& solids, const Particles& p, const Kernel& kernel,
                     float support_radius, float volume, NeighbourLists& lists) {
    std::visit([&](const auto& k) { fill_lists(grid, solids, p, k, support_radius, volume, lists); }, kernel);
}

}  // namespace wade::fluid
