#include "crowd_client/people/states.hpp"

#include <algorithm>
#include <limits>

namespace wade::crowd {
namespace {

constexpr double effort_from = 0.5, walking_below = 0.45;                               // D
constexpr double firm_below = 0.9, calm_below = 0.64;                                   // S; R, 0.8 of v_most
constexpr double slip_time = 0.1, topple_time = 0.3, firm_time = 0.3, lost_time = 0.3;  // s
constexpr double ground_again = 0.8, lies = 0.25, may_sit = 0.6, mouth_sitting = 0.44;  // of H
constexpr double feet_down_below = 0.8;                                                 // D(stands)
constexpr double breathes_in = 3;                                                       // as fast as air is used up

double demand(double moment, double held) {
    if (!(moment > 0)) return 0;
    return held > 0 ? moment / held : std::numeric_limits<double>::infinity();
}

// Returns true if a time that has begun is over, to the nearest step.
bool over(double time, double limit, double dt) {
    return time > 0 && time >= limit - 0.5 * dt;
}

double counted(double time, bool goes_on, double dt) {
    return goes_on ? time + dt : 0;
}

PersonState on_feet(const Condition& now, const Strain& e, double dt) {
    const double topple = topple_demand(e), largest = std::max({e.slip, topple, e.rush});
    if (e.depth >= chin * e.height) return PersonState::afloat;
    if (over(now.toppling, topple_time, dt)) return PersonState::toppled;
    if (over(now.slipping, slip_time, dt)) return PersonState::sliding;
    if (now.state == PersonState::sliding) return over(now.firm, firm_time, dt) ? PersonState::effort : now.state;
    const bool strains = largest >= (now.state == PersonState::effort ? walking_below : effort_from);
    return strains ? PersonState::effort : PersonState::walking;
}

double demand_in(const Strain& e, Rest posture) {
    return e.at_rest[static_cast<std::size_t>(posture)];
}

// Returns true if a person getting up can be in the posture. Squatting is skipped where standing holds.
bool can_pass(const Strain& e, std::size_t posture) {
    const bool may_skip = posture == static_cast<std::size_t>(Rest::squats) && demand_in(e, Rest::stands) < 1;
    return e.at_rest[posture] < 1 || may_skip;
}

PersonState carried_on(const Strain& e) {
    const bool is_pinned = e.is_pressed && demand_in(e, Rest::stands) >= 1;
    if (e.can_swim && e.depth >= chin * e.height) return is_pinned ? PersonState::pinned : PersonState::afloat;
    const bool feet_down = e.depth < ground_again * e.height && demand_in(e, Rest::stands) < feet_down_below;
    const bool gets_up =
        e.depth < may_sit * e.height && (demand_in(e, Rest::sits) < 1 || demand_in(e, Rest::kneels) < 1);
    const bool floats = e.depth >= lies * e.height;
    if (gets_up && !(floats && feet_down)) return PersonState::recovering;
    if (feet_down) return PersonState::sliding;
    if (e.hold > 0) return PersonState::holding;
    return is_pinned ? PersonState::pinned : PersonState::carried;
}

// Advances through the postures. A person falls back to the highest posture below that holds, and waits there for the next.
PersonState getting_up(Condition& now, const Strain& e, double dt) {
    if (e.depth >= chin * e.height) return PersonState::afloat;
    const auto reached = static_cast<std::size_t>(posture_of(now));
    std::size_t posture = reached;
    while (posture > 0 && !can_pass(e, posture)) --posture;
    if (!can_pass(e, posture)) return PersonState::carried;
    if (posture < reached) now.in_state = posture_time * static_cast<double>(posture + 1) - 0.5 * dt;
    return over(now.in_state, posture_time * rests, dt) ? PersonState::effort : PersonState::recovering;
}

// Returns true if the exposure adrift has reached the limit of the person.
bool drowns_adrift(const Condition& now, const Strain& e) {
    const double reached = e.hazard * now.drift.exposure;
    return is_adrift(now.state) && reached > 0 && reached >= e.drowns_at;
}

// Returns the next state. `now` loses the time of a posture that no longer holds.
PersonState next_state(Condition& now, const Strain& e, double dt) {
    if (drowns_adrift(now, e)) return PersonState::drowned;
    switch (now.state) {
        case PersonState::walking:
        case PersonState::effort:
        case PersonState::sliding:
            return on_feet(now, e, dt);
        case PersonState::toppled:
            return over(now.in_state, lost_time, dt) ? PersonState::carried : now.state;
        case PersonState::afloat:
            if (e.depth < ground_again * e.height) return PersonState::sliding;
            if (e.is_pressed && demand_in(e, Rest::stands) >= 1) return PersonState::pinned;
            return !e.can_swim && over(now.in_state, lost_time, dt) ? PersonState::carried : now.state;
        case PersonState::carried:
        case PersonState::holding:
        case PersonState::pinned:
            return now.air > 0 ? carried_on(e) : PersonState::drowned;
        case PersonState::recovering:
            return now.air > 0 ? getting_up(now, e, dt) : PersonState::drowned;
        case PersonState::drowned:
            break;
    }
    return PersonState::drowned;
}

DriftEnd end_of_drift(PersonState next) {
    switch (next) {
        case PersonState::afloat:
        case PersonState::carried:
        case PersonState::drowned:
            return DriftEnd::adrift;
        case PersonState::recovering:
            return DriftEnd::got_up;
        case PersonState::holding:
            return DriftEnd::held;
        case PersonState::pinned:
            return DriftEnd::pinned;
        case PersonState::walking:
        case PersonState::effort:
        case PersonState::sliding:
        case PersonState::toppled:
            break;
    }
    return DriftEnd::feet_down;
}

}  // namespace

Rest posture_of(const Condition& recovering) {
    const double posture = recovering.in_state / posture_time;
    return posture < rests - 1 ? static_cast<Rest>(posture) : Rest::stands;
}

double topple_demand(const Strain& e) {
    return demand(e.moment, e.weight * e.arm + e.hold);
}

Condition next_condition(const Condition& before, const Strain& e, double dt) {
    Condition now = before;
    const double topple = topple_demand(e);
    now.in_state += dt;
    now.slipping = counted(now.slipping, std::max({e.slip, topple, e.rush}) >= 1, dt);
    now.toppling = counted(now.toppling, topple >= 1, dt);
    now.firm = counted(now.firm, e.slip < firm_below && e.rush < calm_below, dt);
    const bool sits = now.state == PersonState::recovering &&
                      now.in_state < posture_time + 1.25 * dt;  // a step later, not by rounding
    const bool is_deep = e.depth >= lies * e.height;
    const bool is_under = (e.drifts_under && now.state == PersonState::carried && is_deep) ||
                          (now.state == PersonState::pinned && is_deep) ||
                          (sits && e.depth >= mouth_sitting * e.height);
    now.air = is_under ? std::max(0.0, std::min(e.air, now.air) - dt) : std::min(e.air, now.air + breathes_in * dt);
    is_adrift(now.state) ? drift_on(now.drift, e.drift_weight, is_deep, dt) : breathe(now.drift, dt);
    now.state = next_state(now, e, dt);
    if (is_adrift(now.state) || is_adrift(before.state)) now.drift.end = end_of_drift(now.state);
    if (now.state == before.state) return now;
    const bool kneels_first = now.state == PersonState::recovering && demand_in(e, Rest::sits) >= 1;
    now.in_state = kneels_first ? posture_time : 0;
    // The times of slipping and toppling restart when a person starts or stops standing.
    if (!is_on_feet(before.state) || !is_on_feet(now.state)) now.slipping = now.toppling = now.firm = 0;
    return now;
}

}  // namespace wade::crowd
