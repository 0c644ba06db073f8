#pragma once
// Vectors of 64 bytes, the compiler's own: it splits them where the processor's registers are shorter, so that the lanes,
// and with them all results, are the same everywhere.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

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

// Gives working memory at least n places; what was in it is lost or not.
template <typename T>
void make_room(std::vector<T>& memory, std::size_t n) {
    if (memory.size() < n) memory.resize(n + n / 2);
}

}  // namespace wade::crowd
