#pragma once
// Vectors of 64 bytes, the compiler's own: it splits them where the processor's registers are shorter, so that the lanes,
// and with them all results, are the same everywhere.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace wade::crowd {

template <typename Real>
struct Lanes {
    static constexpr std::size_t count = 64 / sizeof(Real);
    using Integer = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
    using Reals [[gnu::vector_size(64)]] = Real;
    using Integers [[gnu::vector_size(64)]] = Integer;

    // Whether `pack` takes few instructions, and few of them a marker.
#if defined(__AVX512F__)
    static constexpr bool packs_well = count == 16;
#else
    static constexpr bool packs_well = false;
#endif

    static Reals load(const Real* from) {
        Reals v;
        std::memcpy(&v, from, sizeof v);
        return v;
    }
    static void store(Real* to, const Reals& v) {
        std::memcpy(to, &v, sizeof v);
    }

    // 0, 1, 2, ... lane by lane.
    static Integers number() {
        Integers v;
        for (std::size_t lane = 0; lane < count; ++lane) v[lane] = static_cast<Integer>(lane);
        return v;
    }

    // n rounded up to whole vectors.
    static constexpr std::size_t padded(std::size_t n) {
        return (n + count - 1) / count * count;
    }
};

// Writes the lanes of v whose owner is `whose` side by side to `to`, in their order; may write a whole vector. Returns how
// many there are.
template <typename Real>
inline std::uint32_t pack(Real* to, const typename Lanes<Real>::Reals& v, const typename Lanes<Real>::Integers& owner,
                          typename Lanes<Real>::Integer whose) {
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 4) {
        const __mmask16 own = _mm512_cmpeq_epi32_mask(reinterpret_cast<__m512i>(owner), _mm512_set1_epi32(whose));
        _mm512_storeu_ps(to, _mm512_maskz_compress_ps(own, reinterpret_cast<__m512>(v)));
        return static_cast<std::uint32_t>(__builtin_popcount(own));
    } else {
        const __mmask8 own = _mm512_cmpeq_epi64_mask(reinterpret_cast<__m512i>(owner), _mm512_set1_epi64(whose));
        _mm512_storeu_pd(to, _mm512_maskz_compress_pd(own, reinterpret_cast<__m512d>(v)));
        return static_cast<std::uint32_t>(__builtin_popcount(own));
    }
#else
    std::uint32_t n = 0;
    for (std::size_t lane = 0; lane < Lanes<Real>::count; ++lane) {
        to[n] = v[lane];
        n += owner[lane] == whose ? 1U : 0U;
    }
    return n;
#endif
}

// Gives working memory at least n places; what was in it is lost or not.
template <typename T>
void make_room(std::vector<T>& memory, std::size_t n) {
    if (memory.size() < n) memory.resize(n + n / 2);
}

}  // namespace wade::crowd
