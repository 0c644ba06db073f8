#include "crowd_client/people/states.hpp"

#include <algorithm>
#include <limits>

namespace wade::crowd {
namespace {

constexpr double effort_from = 0.5, walking_below = 0.45;                               // D
constexpr double firm_below = 0.9;                                                      // S
constexpr double slip_time = 0.1, topple_time = 0.3, firm_time = 0.3, lost_time = 0.3;  // s
constexpr double ground_again = 0.8, lies = 0.25, may_sit = 0.6, mouth_sitting = 0.5;   // of H
constexpr double sits_below = 0.5;                                                      // T(sit)
constexpr std::array posture_arm{0.25, 0.15, 0.08};  // of H: sit, kneel, squat [A]; then that of who stands
constexpr double breathes_in = 3;                    // as fast as air is used up

double demand(double moment, double held) {
    if (!(moment > 0)) return 0;
    return held > 0 ? moment / held : std::numeric_limits<double>::infinity();
}

// Whether a time is over, to the nearest step.
bool over(double time, double limit, double dt) {
    return time >= limit - 0.5 * dt;
}

double counted(double time, bool goes_on, double dt) {
    return goes_on ? time + dt : 0;
}

PersonState on_feet(const Condition& now, const Strain& e, double dt) {
    const double topple = topple_demand(e), largest = std::max(e.slip, topple);
    if (e.depth >= chin * e.height) return PersonState::afloat;
    if (over(now.toppling, topple_time, dt)) return PersonState::toppled;
    if (over(now.slipping, slip_time, dt)) return PersonState::sliding;
    if (now.state == PersonState::sliding) return over(now.firm, firm_time, dt) ? PersonState::effort : now.state;
    const bool strains = largest >= (now.state == PersonState::effort ? walking_below : effort_from);
    return strains ? PersonState::effort : PersonState::walking;
}

// T of who gets up, were it still, in a posture.
double demand_of_posture(const Strain& e, std::size_t posture) {
    const double arm = posture < posture_arm.size() ? posture_arm[posture] * e.height : e.arm;
    return demand(e.moment_at_rest, e.weight * arm);
}

PersonState carried_on(const Strain& e) {
    if (e.can_swim && e.depth >= chin * e.height) return PersonState::afloat;
    const double sitting = demand_of_posture(e, 0);
    const bool can_sit =
        (e.depth < lies * e.height && sitting < 1) || (e.depth < may_sit * e.height && sitting < sits_below);
    if (can_sit) return PersonState::recovering;
    return e.hold > 0 ? PersonState::holding : PersonState::carried;
}

// Up through the postures. Who would topple in one goes back to the highest below that holds, and waits there for the next.
PersonState getting_up(Condition& now, const Strain& e, double dt) {
    if (e.depth >= chin * e.height) return PersonState::afloat;
    constexpr std::size_t standing = posture_arm.size();
    const auto reached = std::min(standing, static_cast<std::size_t>(now.in_state / posture_time));
    std::size_t posture = reached;
    while (posture > 0 && demand_of_posture(e, posture) >= 1) --posture;
    if (demand_of_posture(e, posture) >= 1) return PersonState::carried;
    if (posture < reached) now.in_state = posture_time * static_cast<double>(posture + 1) - 0.5 * dt;
    const bool is_up = over(now.in_state, posture_time * static_cast<double>(standing + 1), dt);
    return is_up ? PersonState::effort : PersonState::recovering;
}

// `now` loses time that was spent in a posture in which it cannot stay.
PersonState next_state(Condition& now, const Strain& e, double dt) {
    switch (now.state) {
        case PersonState::walking:
        case PersonState::effort:
        case PersonState::sliding:
            return on_feet(now, e, dt);
        case PersonState::toppled:
            return over(now.in_state, lost_time, dt) ? PersonState::carried : now.state;
        case PersonState::afloat:
            if (e.depth < ground_again * e.height) return PersonState::recovering;
            return !e.can_swim && over(now.in_state, lost_time, dt) ? PersonState::carried : now.state;
        case PersonState::carried:
        case PersonState::holding:
            return now.air > 0 ? carried_on(e) : PersonState::drowned;
        case PersonState::recovering:
            return now.air > 0 ? getting_up(now, e, dt) : PersonState::drowned;
        case PersonState::drowned:
            break;
    }
    return PersonState::drowned;
}

}  // namespace

double topple_demand(const Strain& e) {
    return demand(e.moment, e.weight * e.arm + e.hold);
}

Condition next_condition(const Condition& before, const Strain& e, double dt) {
    Condition now = before;
    const double topple = topple_demand(e);
    now.in_state += dt;
    now.slipping = counted(now.slipping, e.slip >= 1 || topple >= 1, dt);
    now.toppling = counted(now.toppling, topple >= 1, dt);
    now.firm = counted(now.firm, e.slip < firm_below, dt);
    const bool sits = now.state == PersonState::recovering &&
                      now.in_state < posture_time + 1.25 * dt;  // a step later, not by rounding
    const bool is_under = (now.state == PersonState::carried && e.depth >= lies * e.height) ||
                          (sits && e.depth >= mouth_sitting * e.height);
    now.air = is_under ? std::max(0.0, std::min(e.air, now.air) - dt) : std::min(e.air, now.air + breathes_in * dt);
    now.state = next_state(now, e, dt);
    if (now.state == before.state) return now;
    now.in_state = 0;
    // Who gets up or floats begins anew to slip and topple.
    if (!has_ground(now.state) || now.state == PersonState::recovering) now.slipping = now.toppling = now.firm = 0;
    return now;
}

}  // namespace wade::crowd
