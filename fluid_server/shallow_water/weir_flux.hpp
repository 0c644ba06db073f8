#pragma once
// Water over a flood wall, which is thinner than a cell: the flux through the face that it closes.
//
// H is the level of the higher water over the crest, H_d that of the other side, at least 0, P the height of the crest over the bed
// of the higher side. Rehbock's law of a sharp-crested weir, drowned as by Villemonte (Chow 1959, Open-Channel Hydraulics, section
// 14-1; Villemonte 1947, Engineering News-Record 139):
//
//   q = (2/3) C sqrt(2 g) H^1.5 (1 - (H_d / H)^1.5)^0.385,   C = 0.611 + 0.08 min(H / P, 5)
//
// q is at most what levels both sides in two and a half steps, as the law would swing about equal levels otherwise. The higher side
// loses the momentum q u, u = q / h of it. The other side gets q times the velocity at critical depth, 3 q / (2 H), or
// q times the velocity of the water flowing off, q / h, if this is less. The rest is lost where the water plunges in,
// so that the level beside the wall is the tailwater level, which H_d measures. The wall stops velocities towards it
// beyond those of q, and pushes as in openings.hpp.

#include <algorithm>
#include <cmath>

namespace wade::fluid::shallow_water {

// Water at one side of a face: depth and level, m, velocity normal to the face and along it, m/s.
struct WeirSide {
    double h = 0, eta = 0, normal = 0, along = 0;
};

// What passes the face towards +normal per width; normal momentum without the pressure of the side's own depth (face_flux.hpp).
struct WeirFlux {
    double mass = 0, along = 0, into_lower = 0, into_upper = 0;
};

// Returns the discharge of a weir per width, m^2/s. head, drowned: H and H_d, m; height: P, m.
[[nodiscard]] inline double weir_discharge(double gravity, double head, double drowned, double height) {
    constexpr double largest_ratio = 5;  // of Rehbock's experiments
    if (head <= 0) return 0;
    const double ratio = height * largest_ratio > head ? head / height : largest_ratio;
    const double root = std::sqrt(head), free = 2.0 / 3 * (0.611 + 0.08 * ratio) * std::sqrt(2 * gravity) * head * root;
    if (drowned <= 0) return free;
    const double share = drowned / head;
    return free * std::pow(std::max(0.0, 1 - share * std::sqrt(share)), 0.385);
}

// length: of the wall over that of the face. per_length: time step over the distance of the cells, s/m.
[[nodiscard]] inline WeirFlux weir_flux(const WeirSide& lower, const WeirSide& upper, double crest, double length,
                                        double gravity, double dry, double per_length) {
    constexpr double share_of_difference = 0.4;  // that a step levels, from each side
    const bool rising = upper.eta > lower.eta;
    const WeirSide &from = rising ? upper : lower, &to = rising ? lower : upper;
    const double head = from.h > dry ? from.eta - crest : 0, drowned = std::max(0.0, to.eta - crest);
    double q = 0, jet = 0;
    if (head > drowned) {
        q = std::min(length * weir_discharge(gravity, head, drowned, crest - (from.eta - from.h)),
                     share_of_difference * (head - drowned) / per_length);
        jet = std::min(1.5 * q / head, q / std::max(to.h, dry));
    }
    // towards: velocity towards the wall.
    const auto push = [gravity](double h, double towards) {
        const double c = std::sqrt(gravity * h);
        return std::max(h * towards * (towards + std::max(c + 0.5 * towards, c - towards)), -0.5 * gravity * h * h);
    };
    const auto of_higher = [&](const WeirSide& side, double towards) {
        return q > 0 ? push(side.h, towards - q / side.h) + q * q / side.h : push(side.h, towards);
    };
    // away: velocity away from the wall; the part below that of the arriving water is the arriving water's own.
    const auto of_other = [&](const WeirSide& side, double away) {
        return push(side.h, away > 0 ? -std::max(0.0, away - jet) : -away) + q * jet;
    };
    if (rising) return {-q, -q * upper.along, of_other(lower, -lower.normal), of_higher(upper, -upper.normal)};
    return {q, q * lower.along, of_higher(lower, lower.normal), of_other(upper, upper.normal)};
}

}  // namespace wade::fluid::shallow_water
