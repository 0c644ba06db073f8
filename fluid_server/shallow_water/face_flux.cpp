#include "fluid_server/shallow_water/face_flux.hpp"

#include <cmath>

namespace wade::fluid::shallow_water {

namespace {

// As the processor's instructions have them, so that loops vectorise.
template <typename Real>
inline Real larger(Real a, Real b) {
    return a > b ? a : b;
}
template <typename Real>
inline Real smaller(Real a, Real b) {
    return a < b ? a : b;
}

// Monotonised central limiter of the differences to both neighbours: their mean, at most twice the smaller one.
inline double limited(double to_lower, double to_upper) {
    const double a = std::abs(to_lower), b = std::abs(to_upper);
    const double least = smaller(2 * smaller(a, b), 0.5 * std::abs(to_lower + to_upper));
    return to_lower * to_upper > 0 ? std::copysign(least, to_lower) : 0.0;
}

void limit_one(const double* below, const double* here, const double* above, std::size_t n, double* slope) {
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) slope[i] = limited(here[i] - below[i], above[i] - here[i]);
}

template <bool obstacles>
void fluxes(const Cells& lower, const Cells& lower_slopes, const Cells& upper, const Cells& upper_slopes,
            const double* wall, std::size_t n, const FluxConstants& constants, const FluxRow& flux) {
    // Pointers of the loop's own, so that the compiler knows that no store changes them.
    const double *const h_lower = lower.h, *const eta_lower = lower.eta;
    const double *const u_lower = lower.normal, *const v_lower = lower.along;
    const double *const h_upper = upper.h, *const eta_upper = upper.eta;
    const double *const u_upper = upper.normal, *const v_upper = upper.along;
    const double *const dh_lower = lower_slopes.h, *const deta_lower = lower_slopes.eta;
    const double *const du_lower = lower_slopes.normal, *const dv_lower = lower_slopes.along;
    const double *const dh_upper = upper_slopes.h, *const deta_upper = upper_slopes.eta;
    const double *const du_upper = upper_slopes.normal, *const dv_upper = upper_slopes.along;
    double *const mass_flux = flux.mass, *const along_flux = flux.along;
    double *const into_lower = flux.into_lower, *const into_upper = flux.into_upper;
    const double half_g = 0.5 * constants.gravity;
    const auto g = static_cast<float>(constants.gravity);
    const double dry = constants.dry;
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) {
        // States on both sides, on the beds of their own.
        const double eta_l = eta_lower[i] + 0.5 * deta_lower[i];
        const double eta_r = eta_upper[i] - 0.5 * deta_upper[i];
        const double depth_l = h_lower[i] + 0.5 * dh_lower[i];
        const double depth_r = h_upper[i] - 0.5 * dh_upper[i];
        double u_l = u_lower[i] + 0.5 * du_lower[i];
        double u_r = u_upper[i] - 0.5 * du_upper[i];
        const double along_l = v_lower[i] + 0.5 * dv_lower[i];
        const double along_r = v_upper[i] - 0.5 * dv_upper[i];

        // Hydrostatic reconstruction.
        const double bed = larger(eta_l - depth_l, eta_r - depth_r);
        double h_l = larger(0.0, eta_l - bed);
        double h_r = larger(0.0, eta_r - bed);
        if constexpr (obstacles) {
            const bool above = (wall[i] > 0) & (depth_r <= dry) & (eta_l <= eta_r);
            const bool below = (wall[i] < 0) & (depth_l <= dry) & (eta_r <= eta_l);
            h_l = above ? depth_l : h_l;
            h_r = below ? depth_r : h_r;
            h_r = above ? depth_l : h_r;
            h_l = below ? depth_r : h_l;
            u_r = above ? -u_l : u_r;
            u_l = below ? -u_r : u_l;
        }

        // Fastest waves; single precision is enough for them and gives half of the speed.
        const auto fu_l = static_cast<float>(u_l), fu_r = static_cast<float>(u_r);
        const float c_l = std::sqrt(g * static_cast<float>(h_l)), c_r = std::sqrt(g * static_cast<float>(h_r));
        const float u_star = 0.5F * (fu_l + fu_r) + (c_l - c_r);
        const float c_star = larger(0.0F, 0.5F * (c_l + c_r) + 0.25F * (fu_l - fu_r));
        float s_l = smaller(fu_l - c_l, u_star - c_star);
        float s_r = larger(fu_r + c_r, u_star + c_star);
        const bool dry_l = h_l <= dry, dry_r = h_r <= dry;
        s_l = smaller(smaller(s_l, dry_l ? fu_r - 2 * c_r : s_l), 0.0F);
        s_r = larger(larger(s_r, dry_r ? fu_l + 2 * c_l : s_r), 0.0F);
        const float range = larger(s_r - s_l, 1e-20F);
        const auto lean = static_cast<double>(0.5F * (s_r + s_l) / range);
        const auto spread = static_cast<double>(s_l * s_r / range);

        // F = (s_r F_l - s_l F_r + s_l s_r (U_r - U_l)) / (s_r - s_l), in a form that is F_l to the bit if F_l = F_r, lets
        // no mass through a mirror, and gives mirrored states the mirrored flux.
        const double q_l = h_l * u_l, q_r = h_r * u_r;
        const double pressure_l = half_g * h_l * h_l, pressure_r = half_g * h_r * h_r;
        const double f_l = q_l * u_l + pressure_l, f_r = q_r * u_r + pressure_r;
        const double mass = 0.5 * (q_l + q_r) + lean * (q_l - q_r) + spread * (h_r - h_l);
        const double momentum = 0.5 * (f_l + f_r) + lean * (f_l - f_r) + spread * (q_r - q_l);
        mass_flux[i] = mass;
        along_flux[i] = mass * (mass > 0 ? along_l : along_r);
        into_lower[i] = momentum - pressure_l;
        into_upper[i] = momentum - pressure_r;
    }
}

}  // namespace

void limited_slopes(const Cells& below, const Cells& here, const Cells& above, std::size_t n, const SlopeRow& slopes) {
    limit_one(below.h, here.h, above.h, n, slopes.h);
    limit_one(below.eta, here.eta, above.eta, n, slopes.eta);
    limit_one(below.normal, here.normal, above.normal, n, slopes.normal);
    limit_one(below.along, here.along, above.along, n, slopes.along);
}

void face_fluxes(const Cells& lower, const Cells& lower_slopes, const Cells& upper, const Cells& upper_slopes,
                 const double* wall, std::size_t n, const FluxConstants& constants, const FluxRow& flux) {
    if (wall != nullptr) {
        fluxes<true>(lower, lower_slopes, upper, upper_slopes, wall, n, constants, flux);
    } else {
        fluxes<false>(lower, lower_slopes, upper, upper_slopes, wall, n, constants, flux);
    }
}

}  // namespace wade::fluid::shallow_water
