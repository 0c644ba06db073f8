// From cells to the flux through the faces between them, a vector of them at a time: see face_flux.hpp.

#include <algorithm>
#include <array>
#include <cstddef>

#include "fluid_server/shallow_water/face_flux.hpp"
#include "fluid_server/shallow_water/lanes-inl.hpp"

// Once for each instruction set.
#if defined(WADE_SHALLOW_WATER_FACE_FLUX_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef WADE_SHALLOW_WATER_FACE_FLUX_INL_HPP
#undef WADE_SHALLOW_WATER_FACE_FLUX_INL_HPP
#else
#define WADE_SHALLOW_WATER_FACE_FLUX_INL_HPP
#endif

HWY_BEFORE_NAMESPACE();
namespace wade::fluid::shallow_water::HWY_NAMESPACE {

// Half of the mean of the differences to both neighbours, at most the smaller one, which the limiter allows twice.
HWY_INLINE V limited_rise(V below, V here, V above) {
    const V zero = all(0.0), to_lower = here - below, to_upper = above - here;
    const V mean = all(0.25) * (to_lower + to_upper);
    const V up = hn::Min(hn::Min(to_lower, to_upper), mean), down = hn::Max(hn::Max(to_lower, to_upper), mean);
    return hn::Max(up, zero) + hn::Min(down, zero);
}

// Computes the limited rises of n cells from the neighbours below and above.
inline void find_rises(Cells below, Cells here, Cells above, std::size_t n, CellRow rise) {
    for (std::size_t i = 0; i < n; i += lanes) {
        store(limited_rise(load(below.h + i), load(here.h + i), load(above.h + i)), rise.h + i);
        if (rise.eta != rise.h) {
            store(limited_rise(load(below.eta + i), load(here.eta + i), load(above.eta + i)), rise.eta + i);
        }
        store(limited_rise(load(below.normal + i), load(here.normal + i), load(above.normal + i)), rise.normal + i);
        store(limited_rise(load(below.along + i), load(here.along + i), load(above.along + i)), rise.along + i);
    }
}

// What the sweeps over some faces hand on. Each sweep is a short loop of its own, as a processor works on several vectors
// at a time only where these have few instructions.
struct Faces {
    static constexpr std::size_t count = 128;
    template <typename T>
    using Row = std::array<T, count>;
    alignas(line_bytes) Row<double> h_l, h_r, u_l, u_r;  // on the common bed
    alignas(line_bytes) Row<float> lean, spread;         // see combine_fluxes()
};

// States on both sides of n faces, and their hydrostatic reconstruction. Returns the smallest depth.
// wall: see find_fluxes(); only read with obstacles.
template <bool obstacles>
double reconstruct(Cells lower, Cells lower_rise, Cells upper, Cells upper_rise, const double* wall, std::size_t n,
                   double dry_depth, Faces& faces) {
    const V zero = all(0.0), dry = all(dry_depth);
    const V deep = all(1e300);
    V least = deep;
    for (std::size_t i = 0; i < n; i += lanes) {
        const V eta_l = load(lower.eta + i) + load(lower_rise.eta + i);
        const V eta_r = load(upper.eta + i) - load(upper_rise.eta + i);
        const V depth_l = load(lower.h + i) + load(lower_rise.h + i);
        const V depth_r = load(upper.h + i) - load(upper_rise.h + i);
        V u_l = load(lower.normal + i) + load(lower_rise.normal + i);
        V u_r = load(upper.normal + i) - load(upper_rise.normal + i);
        const V bed = hn::Max(eta_l - depth_l, eta_r - depth_r);
        V h_l = hn::Max(zero, eta_l - bed);
        V h_r = hn::Max(zero, eta_r - bed);
        if constexpr (obstacles) {
            const V side = load(wall + i);
            const auto above = hn::And(side > zero, hn::And(depth_r <= dry, eta_l <= eta_r));
            const auto below = hn::And(side < zero, hn::And(depth_l <= dry, eta_r <= eta_l));
            h_l = hn::IfThenElse(above, depth_l, hn::IfThenElse(below, depth_r, h_l));
            h_r = hn::IfThenElse(above, depth_l, hn::IfThenElse(below, depth_r, h_r));
            u_r = hn::IfThenElse(above, hn::Neg(u_l), u_r);
            u_l = hn::IfThenElse(below, hn::Neg(u_r), u_l);
        }
        store(h_l, &faces.h_l[i]);
        store(h_r, &faces.h_r[i]);
        store(u_l, &faces.u_l[i]);
        store(u_r, &faces.u_r[i]);
        least = hn::Min(least, first(n - i, hn::Min(h_l, h_r), deep));
    }
    return hn::GetLane(hn::MinOfLanes(doubles, least));
}

// Two vectors in single precision.
HWY_INLINE F load_narrow(const double* from) {
    return narrow(load(from), load(from + lanes));
}

// The same of depths, negative where it is dry.
HWY_INLINE F load_signed(const double* from, V dry) {
    const V lower = load(from), upper = load(from + lanes);
    return narrow(hn::IfThenElse(lower <= dry, hn::Neg(lower), lower),
                  hn::IfThenElse(upper <= dry, hn::Neg(upper), upper));
}

// Fastest waves of n faces; single precision is enough for them, and has twice the lanes. any_dry: whether a side may be.
template <bool any_dry>
void find_waves(std::size_t n, const FluxConstants& constants, Faces& faces) {
    const V dry = all(constants.dry);
    const F zero = all(0.0F), half = all(0.5F), g = all(static_cast<float>(constants.gravity));
    for (std::size_t i = 0; i < n; i += float_lanes) {
        const F h_l = any_dry ? load_signed(&faces.h_l[i], dry) : load_narrow(&faces.h_l[i]);
        const F h_r = any_dry ? load_signed(&faces.h_r[i], dry) : load_narrow(&faces.h_r[i]);
        const F u_l = load_narrow(&faces.u_l[i]), u_r = load_narrow(&faces.u_r[i]);
        const F c_l = hn::Sqrt(g * hn::Abs(h_l)), c_r = hn::Sqrt(g * hn::Abs(h_r));
        const F u_star = half * (u_l + u_r) + (c_l - c_r);
        const F c_star = hn::Max(zero, half * (c_l + c_r) + all(0.25F) * (u_l - u_r));
        F s_l = hn::Min(u_l - c_l, u_star - c_star);
        F s_r = hn::Max(u_r + c_r, u_star + c_star);
        if constexpr (any_dry) {
            s_l = hn::IfThenElse(h_l <= zero, hn::Min(s_l, u_r - (c_r + c_r)), s_l);
            s_r = hn::IfThenElse(h_r <= zero, hn::Max(s_r, u_l + (c_l + c_l)), s_r);
        }
        s_l = hn::Min(s_l, zero);
        s_r = hn::Max(s_r, zero);
        const F range = hn::Max(s_r - s_l, all(1e-20F));
        store(half * (s_r + s_l) / range, &faces.lean[i]);
        store(s_l * s_r / range, &faces.spread[i]);
    }
}

// F = (s_r F_l - s_l F_r + s_l s_r (U_r - U_l)) / (s_r - s_l), in a form that is F_l to the bit if F_l = F_r, lets
// no mass through a mirror, and gives mirrored states the mirrored flux.
// wall: as in find_fluxes(); only read with obstacles. What hits a wall, through which no mass passes, does not push the film on
// the obstacle's top. open: shares of the faces that let water pass; only read of narrowed ones.
template <bool films_rest, bool narrowed, bool obstacles>
void combine_fluxes(Cells lower, Cells lower_rise, Cells upper, Cells upper_rise, const double* wall,
                    const double* open, std::size_t n, const FluxConstants& constants, const Faces& faces,
                    FluxRow flux) {
    const V zero = all(0.0), half = all(0.5), half_g = all(0.5 * constants.gravity), dry = all(constants.dry);
    for (std::size_t i = 0; i < n; i += lanes) {
        const V h_l = load(&faces.h_l[i]), h_r = load(&faces.h_r[i]);
        const V u_l = load(&faces.u_l[i]), u_r = load(&faces.u_r[i]);
        const V lean = load_wide(&faces.lean[i]), spread = load_wide(&faces.spread[i]);
        const V q_l = h_l * u_l, q_r = h_r * u_r;
        const V pressure_l = half_g * h_l * h_l, pressure_r = half_g * h_r * h_r;
        const V f_l = q_l * u_l + pressure_l, f_r = q_r * u_r + pressure_r;
        V mass = half * (q_l + q_r) + lean * (q_l - q_r) + spread * (h_r - h_l);
        const V momentum = half * (f_l + f_r) + lean * (f_l - f_r) + spread * (q_r - q_l);
        V into_lower = momentum - pressure_l, into_upper = momentum - pressure_r;
        if constexpr (films_rest) {
            const auto wet = hn::Or(load(lower.h + i) > dry, load(upper.h + i) > dry);
            mass = hn::IfThenElseZero(wet, mass);
            into_lower = hn::IfThenElseZero(wet, into_lower);
            into_upper = hn::IfThenElseZero(wet, into_upper);
        }
        if constexpr (obstacles) {
            const V side = load(wall + i);
            into_upper = hn::IfThenZeroElse(hn::And(side > zero, mass == zero), into_upper);
            into_lower = hn::IfThenZeroElse(hn::And(side < zero, mass == zero), into_lower);
        }
        const V along_l = load(lower.along + i) + load(lower_rise.along + i);
        const V along_r = load(upper.along + i) - load(upper_rise.along + i);
        V along = mass * hn::IfThenElse(mass > zero, along_l, along_r);
        if constexpr (narrowed) {
            const V share = load(open + i);
            mass = share * mass, along = share * along;
            into_lower = share * into_lower, into_upper = share * into_upper;
        }
        store(mass, flux.mass + i);
        store(along, flux.along + i);
        store(into_lower, flux.into_lower + i);
        store(into_upper, flux.into_upper + i);
    }
}

// Flux through n faces, from `lower` to `upper` cells.
// wall: null, or by face 1 if the upper cell, -1 if the lower cell, is part of an obstacle and the other is not. Where its
// top is dry and no lower than the water beside it the face is a wall: the water meets its mirror image.
// open: null, or by face the share that lets water pass.
inline void find_fluxes(Cells lower, Cells lower_rise, Cells upper, Cells upper_rise, const double* wall,
                        const double* open, std::size_t n, const FluxConstants& constants, const FluxRow& flux) {
    Faces faces;
    for (std::size_t i = 0; i < n; i += Faces::count) {
        const std::size_t m = std::min(Faces::count, n - i);
        const Cells l = lower.from(i), dl = lower_rise.from(i), r = upper.from(i), dr = upper_rise.from(i);
        const double least = wall != nullptr ? reconstruct<true>(l, dl, r, dr, wall + i, m, constants.dry, faces)
                                             : reconstruct<false>(l, dl, r, dr, nullptr, m, constants.dry, faces);
        if (least > constants.dry) {
            find_waves<false>(m, constants, faces);
        } else {
            find_waves<true>(m, constants, faces);
        }
        const auto combine = open != nullptr        ? combine_fluxes<true, true, false>  // of sites, where films rest
                             : constants.films_rest ? combine_fluxes<true, false, false>
                             : wall != nullptr      ? combine_fluxes<false, false, true>
                                                    : combine_fluxes<false, false, false>;
        combine(l, dl, r, dr, wall != nullptr ? wall + i : nullptr, open != nullptr ? open + i : nullptr, m, constants,
                faces, {flux.mass + i, flux.along + i, flux.into_lower + i, flux.into_upper + i});
    }
}

}  // namespace wade::fluid::shallow_water::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
