#include "crowd_client/water/contacts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace wade::crowd {
namespace {

double gap_to_interval(double v, double lo, double hi) {
    const double beyond = std::max(lo - v, v - hi);
    return beyond > 0 ? beyond : 0;
}

// Particles that are tested at a time, and room for those that are close with what a vector store writes beyond them.
constexpr std::size_t chunk_size = 256;
using Chunk = std::array<std::size_t, chunk_size + 8>;

// Writes those of the particles [begin, end), at most chunk_size, that are closer to the agent than the root of `limit` into
// `close`, in their order; returns their number. Which ones are close is hard to foresee, so that there is no branch: each
// is written, and overwritten by the next one unless it is close.
std::size_t find_close(const WaterBins& bins, const Vector2d& agent, double limit, std::size_t begin, std::size_t end,
                       Chunk& close) {
    const double* const x = bins.x.data();
    const double* const z = bins.z.data();
    const double agent_x = agent.x(), agent_z = agent.y();
    std::size_t count = 0, k = begin;
#ifdef __AVX512F__
    const __m512d all_x = _mm512_set1_pd(agent_x), all_z = _mm512_set1_pd(agent_z), all_limit = _mm512_set1_pd(limit);
    __m512i number =
        _mm512_add_epi64(_mm512_set1_epi64(static_cast<long long>(k)), _mm512_set_epi64(7, 6, 5, 4, 3, 2, 1, 0));
    for (; k + 8 <= end; k += 8) {
        const __m512d dx = _mm512_sub_pd(_mm512_loadu_pd(x + k), all_x);
        const __m512d dz = _mm512_sub_pd(_mm512_loadu_pd(z + k), all_z);
        const __m512d distance = _mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dz, dz));
        const __mmask8 closer = _mm512_cmp_pd_mask(distance, all_limit, _CMP_LT_OQ);
        _mm512_storeu_si512(close.data() + count, _mm512_maskz_compress_epi64(closer, number));
        count += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(closer)));
        number = _mm512_add_epi64(number, _mm512_set1_epi64(8));
    }
#endif
    for (; k < end; ++k) {
        const double dx = x[k] - agent_x;
        const double dz = z[k] - agent_z;
        close[count] = k;
        count += dx * dx + dz * dz < limit ? 1U : 0U;
    }
    return count;
}

// Calls visit(k) for each particle k of the bins that is closer than `distance` in the ground plane.
template <typename Visit>
void for_each_touching(const WaterBins& bins, const Vector2d& agent, double distance, Visit&& visit) {
    const int column = GroundGrid::line_of(agent.x());
    const int row = GroundGrid::line_of(agent.y());
    const double limit = distance * distance;
    for (int r = row - 1; r <= row + 1; ++r) {
        const double gap_z = gap_to_interval(agent.y(), GroundGrid::line_start(r), GroundGrid::line_start(r + 1));
        // Cells of a row lie behind one another in the arrays; those that have no particle close enough are left out.
        const auto in_reach = [&](int c) {
            const double gap_x = gap_to_interval(agent.x(), GroundGrid::line_start(c), GroundGrid::line_start(c + 1));
            return gap_x * gap_x + gap_z * gap_z < limit;
        };
        if (!in_reach(column)) continue;
        const std::size_t first = bins.grid.index(in_reach(column - 1) ? column - 1 : column, r);
        const std::size_t last = bins.grid.index(in_reach(column + 1) ? column + 1 : column, r);
        const std::size_t end = bins.cell_start[last + 1];
        for (std::size_t begin = bins.cell_start[first]; begin < end; begin += chunk_size) {
            Chunk close;
            const std::size_t count = find_close(bins, agent, limit, begin, std::min(end, begin + chunk_size), close);
            for (std::size_t c = 0; c < count; ++c) visit(close[c]);
        }
    }
}

}  // namespace

double contact_distance(const Coupling& coupling) {
    return coupling.contact_rule == ContactRule::sum ? coupling.agent_radius + coupling.particle_radius
                                                     : std::abs(coupling.agent_radius - coupling.particle_radius);
}

Contact find_contact(const WaterBins& bins, const Vector2d& agent, double distance,
                     std::vector<WaterParticle>& touching) {
    touching.clear();
    for_each_touching(bins, agent, distance, [&](std::size_t k) { touching.push_back(bins.particle(k)); });
    return contact_momentum(touching);
}

TouchingMean mean_of_touching(const WaterBins& bins, const Vector2d& agent, double distance) {
    assert(bins.with_heights);
    TouchingMean mean;
    for_each_touching(bins, agent, distance, [&](std::size_t k) {
        ++mean.count;
        mean.height += bins.y[k];
        const Vector2d velocity = bins.particle(k).velocity;
        mean.velocity[0] += velocity.x();
        mean.velocity[1] += bins.vy[k];
        mean.velocity[2] += velocity.y();
    });
    if (mean.count == 0) return mean;
    const double n = static_cast<double>(mean.count);
    mean.height /= n;
    for (double& v : mean.velocity) v /= n;
    return mean;
}

CellWater water_at(const WaterBins& bins, const Vector2d& agent, double rest_density) {
    const std::size_t cell = bins.grid.cell_of(agent.x(), agent.y());
    const Contact all = bins.use[cell] == WaterBins::summed ? bins.sums[cell] : sum_of_cell(bins, cell);
    if (!(all.mass > 0)) return {};
    constexpr double cell_area = GroundGrid::cell_size * GroundGrid::cell_size;
    return {all.mass / (rest_density * cell_area), std::sqrt(all.momentum.squaredNorm()) / all.mass};
}

}  // namespace wade::crowd
