#pragma once
// Vectors of 64 bytes, in as many registers as the processor needs for them, so that the lanes, and with them all results,
// are the same everywhere.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

// Functions that are not inlined return such vectors in memory where the registers are shorter. All of them are compiled
// with the same options, so that the warning that this depends on the processor says nothing here.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace wade::crowd {

#if defined(__AVX512F__)
inline constexpr std::size_t register_bytes = 64;
#elif defined(__AVX2__)
inline constexpr std::size_t register_bytes = 32;
#else
inline constexpr std::size_t register_bytes = 16;
#endif

// The compiler's own vectors of a whole register are fast, those of several are taken apart number by number.
template <typename Number>
struct Vector {
    static constexpr std::size_t count = 64 / sizeof(Number);
    static constexpr std::size_t parts = 64 / register_bytes;
    static constexpr std::size_t in_part = count / parts;
    using Part [[gnu::vector_size(register_bytes)]] = Number;
    using Integer = std::conditional_t<sizeof(Number) == 4, std::int32_t, std::int64_t>;
    using Mask = Vector<Integer>;  // of a lane: all bits or none

    Part part[parts];

    Vector() = default;
    Vector(Number value) {  // NOLINT: the same in all lanes
        for (Part& p : part) p = value - Part{};
    }
    Number operator[](std::size_t lane) const { return part[lane / in_part][lane % in_part]; }

    template <typename Result, typename Operation>
    static Result of_parts(const Vector& a, const Vector& b, Operation&& operation) {
        Result r;
        for (std::size_t k = 0; k < parts; ++k) r.part[k] = operation(a.part[k], b.part[k]);
        return r;
    }
    friend Vector operator+(const Vector& a, const Vector& b) {
        return of_parts<Vector>(a, b, [](const Part& u, const Part& v) { return u + v; });
    }
    friend Vector operator-(const Vector& a, const Vector& b) {
        return of_parts<Vector>(a, b, [](const Part& u, const Part& v) { return u - v; });
    }
    friend Vector operator*(const Vector& a, const Vector& b) {
        return of_parts<Vector>(a, b, [](const Part& u, const Part& v) { return u * v; });
    }
    friend Vector operator/(const Vector& a, const Vector& b) {
        return of_parts<Vector>(a, b, [](const Part& u, const Part& v) { return u / v; });
    }
    friend Vector operator&(const Vector& a, const Vector& b) {
        return of_parts<Vector>(a, b, [](const Part& u, const Part& v) { return u & v; });
    }
    friend Vector operator|(const Vector& a, const Vector& b) {
        return of_parts<Vector>(a, b, [](const Part& u, const Part& v) { return u | v; });
    }
    Vector& operator+=(const Vector& v) { return *this = *this + v; }
    Vector& operator*=(const Vector& v) { return *this = *this * v; }
    Vector& operator|=(const Vector& v) { return *this = *this | v; }
    friend Mask operator==(const Vector& a, const Vector& b) {
        return of_parts<Mask>(a, b, [](const Part& u, const Part& v) { return u == v; });
    }
    friend Mask operator!=(const Vector& a, const Vector& b) {
        return of_parts<Mask>(a, b, [](const Part& u, const Part& v) { return u != v; });
    }
    friend Mask operator<(const Vector& a, const Vector& b) {
        return of_parts<Mask>(a, b, [](const Part& u, const Part& v) { return u < v; });
    }
};

// Lane by lane: a where the mask is set, else b.
template <typename Number>
inline Vector<Number> choose(const typename Vector<Number>::Mask& mask, const Vector<Number>& a,
                             const Vector<Number>& b) {
    Vector<Number> r;
    for (std::size_t k = 0; k < Vector<Number>::parts; ++k) r.part[k] = mask.part[k] ? a.part[k] : b.part[k];
    return r;
}

template <typename Real>
struct Lanes {
    static constexpr std::size_t count = Vector<Real>::count;
    using Integer = typename Vector<Real>::Integer;
    using Reals = Vector<Real>;
    using Integers = Vector<Integer>;

    template <typename Number>
    static Vector<Number> load(const Number* from) {
        Vector<Number> v;
        for (std::size_t k = 0; k < v.parts; ++k) std::memcpy(&v.part[k], from + k * v.in_part, register_bytes);
        return v;
    }
    template <typename Number>
    static void store(Number* to, const Vector<Number>& v) {
        for (std::size_t k = 0; k < v.parts; ++k) std::memcpy(to + k * v.in_part, &v.part[k], register_bytes);
    }

    // n rounded up to whole vectors.
    static constexpr std::size_t padded(std::size_t n) { return (n + count - 1) / count * count; }
};

// Makes room in a table for look_up(), in whole pairs of vectors.
template <typename Real>
void make_table(std::vector<Real>& table, std::size_t size) {
    constexpr std::size_t unit = 2 * Lanes<Real>::count;
    const std::size_t places = (size + unit - 1) / unit * unit;
    if (table.size() < places) table.resize(places + places / 2 / unit * unit);
}

#if defined(__AVX2__) && !defined(__AVX512F__)
// Returns table[index] from a table of 16 or 32 entries: on the processors known to us faster than a gather.
inline __m256 look_up_16(const float* table, __m256i index) {
    const __m256 low = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), index);
    const __m256 high = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table + 8), index);
    return _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(index, 28)));  // by the bit of 8
}
inline __m256 look_up_32(const float* table, __m256i index) {
    const __m256 low = look_up_16(table, index), high = look_up_16(table + 16, index);
    return _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(index, 27)));  // by the bit of 16
}
inline __m256 gather(const float* table, __m256i index) {
    return _mm256_mask_i32gather_ps(_mm256_setzero_ps(), table, index, _mm256_castsi256_ps(_mm256_set1_epi32(-1)), 4);
}
#endif

// Returns table[index] lane by lane; 0 <= index < size.
template <typename Real>
inline Vector<Real> look_up(const std::vector<Real>& table, std::size_t size,
                            const typename Vector<Real>::Mask& index) {
    static_cast<void>(size);
    Vector<Real> v;
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 4) {
        const auto places = reinterpret_cast<__m512i>(index.part[0]);
        if (size <= 2 * v.count) {
            const __m512 low = _mm512_loadu_ps(table.data()), high = _mm512_loadu_ps(table.data() + v.count);
            v.part[0] = _mm512_permutex2var_ps(low, places, high);
        } else {
            v.part[0] = _mm512_mask_i32gather_ps(_mm512_setzero_ps(), __mmask16{0xffff}, places, table.data(), 4);
        }
        return v;
    }
#elif defined(__AVX2__)
    if constexpr (sizeof(Real) == 4) {
        const float* const from = table.data();
        for (std::size_t k = 0; k < v.parts; ++k) {
            const auto places = reinterpret_cast<__m256i>(index.part[k]);
            v.part[k] = size <= 16   ? look_up_16(from, places)
                        : size <= 32 ? look_up_32(from, places)
                                     : gather(from, places);
        }
        return v;
    }
#endif
    for (std::size_t k = 0; k < v.parts; ++k) {
        for (std::size_t l = 0; l < v.in_part; ++l) v.part[k][l] = table[static_cast<std::size_t>(index.part[k][l])];
    }
    return v;
}

template <typename Real>
inline Vector<Real> square_root(const Vector<Real>& v) {
    Vector<Real> roots;
    for (std::size_t k = 0; k < v.parts; ++k) {
#if defined(__AVX512F__)
        if constexpr (sizeof(Real) == 4) {
            roots.part[k] = _mm512_maskz_sqrt_ps(__mmask16{0xffff}, v.part[k]);
        } else {
            roots.part[k] = _mm512_maskz_sqrt_pd(__mmask8{0xff}, v.part[k]);
        }
#elif defined(__AVX2__)
        if constexpr (sizeof(Real) == 4) {
            roots.part[k] = _mm256_sqrt_ps(v.part[k]);
        } else {
            roots.part[k] = _mm256_sqrt_pd(v.part[k]);
        }
#else
        for (std::size_t l = 0; l < v.in_part; ++l) roots.part[k][l] = std::sqrt(v.part[k][l]);
#endif
    }
    return roots;
}

// Returns the lanes of a mask as bits, the first lane in the lowest bit.
inline std::uint32_t bits_of(const Vector<std::int64_t>& mask) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < mask.parts; ++k) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
        bits |= _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask.part[k]));
#else
        for (std::size_t l = 0; l < mask.in_part; ++l) bits |= mask.part[k][l] != 0 ? 1U << (k * mask.in_part + l) : 0U;
#endif
    }
    return bits;
}

// Makes room for at least n elements in working memory; its content may be lost.
template <typename T>
void make_room(std::vector<T>& memory, std::size_t n) {
    if (memory.size() < n) memory.resize(n + n / 2);
}

// to[k] = from[k] - origin for four numbers. A copy of n numbers by fours reads and writes up to three beyond.
template <typename To, typename From>
inline void copy_four(To* to, const From* from, From origin) {
    using FourFrom [[gnu::vector_size(4 * sizeof(From))]] = From;
    using FourTo [[gnu::vector_size(4 * sizeof(To))]] = To;
    FourFrom four;
    std::memcpy(&four, from, sizeof four);
    const FourTo moved = __builtin_convertvector(four - origin, FourTo);
    std::memcpy(to, &moved, sizeof moved);
}
inline constexpr std::size_t beyond_fours = 3;

}  // namespace wade::crowd
