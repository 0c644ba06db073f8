#include "crowd_client/people/wear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wade::crowd {
namespace {

constexpr double cooling_rate = 1.2e-4;                     // of a thigh, 1/s
constexpr double holding_loss = 0.02, moving_loss = 0.027;  // of strength, a degree
constexpr double chill_time = 120, warming_time = 800;      // of hands, s
constexpr double skin = 35, grip_loss = 0.16 / (skin - 5);  // C; a degree

double held_for_ever(const MuscleRates& rates) {
    return rates.recovery / (rates.fatigue + rates.recovery);
}

double towards(double value, double end, double rate, double dt) {
    return end + (value - end) * std::exp(-rate * dt);
}

// Returns the time for which a muscle, tired by less than 1 - load, holds a load above its sustainable one.
double time_left(double tired, double load, const MuscleRates& rates) {
    const double end = rates.fatigue * load / rates.recovery;  // limit of M_F for an unlimited muscle
    return std::log((end - tired) / (end - (1 - load))) / rates.recovery;
}

double strength_of(double thigh, double loss) {
    return std::clamp(1 - loss * (warm_muscle - thigh), 0.0, 1.0);
}

}  // namespace

double tired_after(double tired, double load, const MuscleRates& rates, double dt) {
    const double fatigue = rates.fatigue, recovery = rates.recovery;
    load = std::clamp(load, 0.0, 1.0);
    if (load <= held_for_ever(rates)) {
        const double faster = rest_multiplier * recovery;
        return towards(tired, fatigue * load / faster, faster, dt);
    }
    if (tired < 1 - load) {
        const double held = time_left(tired, load, rates);
        if (held >= dt) return towards(tired, fatigue * load / recovery, recovery, dt);
        tired = 1 - load;
        dt -= held;
    }
    return towards(tired, fatigue / (fatigue + recovery), fatigue + recovery, dt);  // all the rest works
}

double endurance_time(double load, const MuscleRates& rates) {
    if (load <= held_for_ever(rates)) return std::numeric_limits<double>::infinity();
    return load < 1 ? time_left(0, load, rates) : 0;
}

double braced_with(double fresh, double of_dummy, double strength) {
    const double least = std::min(fresh, of_dummy);
    return least + (fresh - least) * strength;
}

double thigh_after(double thigh, double water, bool in_water, double dt) {
    return towards(thigh, in_water ? std::min(water, warm_muscle) : warm_muscle, cooling_rate, dt);
}

double holding_strength(double thigh) {
    return strength_of(thigh, holding_loss);
}

double moving_strength(double thigh) {
    return strength_of(thigh, moving_loss);
}

double chill_after(double chill, bool in_water, double dt) {
    return in_water ? towards(chill, 1, 1 / chill_time, dt) : towards(chill, 0, 1 / warming_time, dt);
}

double chilled_grip(double chill, double water) {
    return 1 - chill * grip_loss * std::max(0.0, skin - water);
}

double breath_in(double water) {
    return 15.01 + 0.92 * std::min(water, 35.0);
}

double swimming_time(double water) {
    constexpr double cool = 10, cold = 4.7, in_cool = 90 * 60, in_cold = 7.6 * 60;  // C; s
    const double share = (std::max(water, cold) - cold) / (cool - cold);
    return in_cold * std::pow(in_cool / in_cold, share);
}

}  // namespace wade::crowd
