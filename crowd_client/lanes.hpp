#pragma once
// Vectors of 64 bytes, the compiler's own: it splits them where the processor's registers are shorter, so that the lanes,
// and with them all results, are the same everywhere.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

// Where the registers are shorter, functions that are not inlined return such vectors in memory. All of them are compiled
// with the same options, so that the warning that this depends on the processor says nothing here.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace wade::crowd {

template <typename Real>
struct Lanes {
    static constexpr std::size_t count = 64 / sizeof(Real);
    using Integer = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
    using Reals [[gnu::vector_size(64)]] = Real;
    using Integers [[gnu::vector_size(64)]] = Integer;

    static Reals load(const Real* from) {
        Reals v;
        std::memcpy(&v, from, sizeof v);
        return v;
    }
    static void store(Real* to, const Reals& v) { std::memcpy(to, &v, sizeof v); }

    // 0, 1, 2, ... lane by lane.
    static Integers number() {
        Integers v;
        for (std::size_t lane = 0; lane < count; ++lane) v[lane] = static_cast<Integer>(lane);
        return v;
    }

    // n rounded up to whole vectors.
    static constexpr std::size_t padded(std::size_t n) { return (n + count - 1) / count * count; }
};

// A table that look_up() reads has room for whole pairs of vectors.
template <typename Real>
void make_table(std::vector<Real>& table, std::size_t size) {
    constexpr std::size_t unit = 2 * Lanes<Real>::count;
    const std::size_t places = (size + unit - 1) / unit * unit;
    if (table.size() < places) table.resize(places + places / 2 / unit * unit);
}

// table[index] lane by lane; 0 <= index < size.
template <typename Real>
inline typename Lanes<Real>::Reals look_up(const std::vector<Real>& table, std::size_t size,
                                           const typename Lanes<Real>::Integers& index) {
    using L = Lanes<Real>;
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 4) {
        const auto places = reinterpret_cast<__m512i>(index);
        if (size <= 2 * L::count) {
            const __m512 low = _mm512_loadu_ps(table.data()), high = _mm512_loadu_ps(table.data() + L::count);
            return reinterpret_cast<typename L::Reals>(_mm512_permutex2var_ps(low, places, high));
        }
        return reinterpret_cast<typename L::Reals>(
            _mm512_mask_i32gather_ps(_mm512_setzero_ps(), __mmask16{0xffff}, places, table.data(), 4));
    }
#endif
    static_cast<void>(size);
    typename L::Reals v;
    for (std::size_t lane = 0; lane < L::count; ++lane) v[lane] = table[static_cast<std::size_t>(index[lane])];
    return v;
}

template <typename Reals>
inline Reals square_root(const Reals& v) {
#if defined(__AVX512F__)
    if constexpr (std::is_same_v<Reals, Lanes<float>::Reals>) {
        return reinterpret_cast<Reals>(_mm512_maskz_sqrt_ps(__mmask16{0xffff}, reinterpret_cast<__m512>(v)));
    } else {
        return reinterpret_cast<Reals>(_mm512_maskz_sqrt_pd(__mmask8{0xff}, reinterpret_cast<__m512d>(v)));
    }
#else
    using Real = std::remove_cvref_t<decltype(v[0])>;
    std::array<Real, sizeof(Reals) / sizeof(Real)> s;
    std::memcpy(s.data(), &v, sizeof s);
#pragma omp simd
    for (std::size_t lane = 0; lane < s.size(); ++lane) s[lane] = std::sqrt(s[lane]);
    Reals roots;
    std::memcpy(&roots, s.data(), sizeof s);
    return roots;
#endif
}

// Gives working memory at least n places; what was in it is lost or not.
template <typename T>
void make_room(std::vector<T>& memory, std::size_t n) {
    if (memory.size() < n) memory.resize(n + n / 2);
}

}  // namespace wade::crowd
