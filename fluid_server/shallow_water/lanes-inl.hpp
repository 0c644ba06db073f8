// Vectors of cells or faces of a row, one a lane, for the files that Highway compiles for several instruction sets. Each
// lane does what a loop over single numbers would do, so that all instruction sets give the same bits. The last vector of a
// loop may reach beyond the last cell: rows have room for that, in ghost cells that are filled afterwards or hold nothing.

#include <hwy/highway.h>

#include <cstddef>

#include "fluid_server/shallow_water/row_memory.hpp"

// Once for each instruction set.
#if defined(WADE_SHALLOW_WATER_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef WADE_SHALLOW_WATER_LANES_INL_HPP
#undef WADE_SHALLOW_WATER_LANES_INL_HPP
#else
#define WADE_SHALLOW_WATER_LANES_INL_HPP
#endif

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::shallow_water::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, line_values>;
using Floats = hn::CappedTag<float, 2 * line_values>;
constexpr Doubles doubles;
constexpr Floats floats;
using V = hn::Vec<Doubles>;
using F = hn::Vec<Floats>;

constexpr std::size_t lanes = hn::MaxLanes(doubles), float_lanes = hn::MaxLanes(floats);
static_assert(line_values % lanes == 0);

HWY_INLINE V all(double value) {
    return hn::Set(doubles, value);
}
HWY_INLINE F all(float value) {
    return hn::Set(floats, value);
}
HWY_INLINE V load(const double* from) {
    return hn::LoadU(doubles, from);
}
HWY_INLINE void store(V v, double* to) {
    hn::StoreU(v, doubles, to);
}
HWY_INLINE void store(F v, float* to) {
    hn::StoreU(v, floats, to);
}

// Half as many floats as a vector has.
HWY_INLINE V load_wide(const float* from) {
    return hn::PromoteTo(doubles, hn::LoadU(hn::Half<Floats>(), from));
}

// Between two vectors of doubles and one of floats.
HWY_INLINE F narrow(V lower, V upper) {
    const hn::Half<Floats> half;
    return hn::Combine(floats, hn::DemoteTo(half, upper), hn::DemoteTo(half, lower));
}
HWY_INLINE V widen_lower(F v) {
    return hn::PromoteTo(doubles, hn::LowerHalf(v));
}
HWY_INLINE V widen_upper(F v) {
    return hn::PromoteTo(doubles, hn::UpperHalf(hn::Half<Floats>(), v));
}

// The first n lanes, `rest` in the others.
HWY_INLINE V first(std::size_t n, V v, V rest) {
    return n >= lanes ? v : hn::IfThenElse(hn::FirstN(doubles, n), v, rest);
}

}  // namespace wade::fluid::shallow_water::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
