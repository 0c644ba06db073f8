#include "crowd_client/water/near_water.hpp"

#include <bit>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace wade::crowd {

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

}  // namespace wade::crowd
