#include "crowd_client/people/people.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "configs/scene/crowd.hpp"
#include "crowd_client/people/links.hpp"
#include "crowd_client/people/push.hpp"

namespace wade::crowd {
namespace {

constexpr double mean_time = 0.3;      // low-pass of the sampled flow, s
constexpr double dry = 1e-6;           // m; smaller low-passed depths become 0
constexpr double gain_in_lee = 0.11;   // eta: between 0.134 at 0.60 m and 0.092 at 0.35 m (Li et al. 2024)
constexpr double stays_within = 1;     // m, of one position
constexpr double pinned_after = 10;    // s [A]
constexpr double stays_pressed = 1;    // after a motion that was cut, s [A]
constexpr double swimming_force = 45;  // N [A], of 30 to 60: 0.45 m/s through the water

// Range of depths in the stability experiments of Abt, Karvonen and Xia; m.
constexpr double shallowest_measured = 0.2, deepest_measured = 1.2;

Body body_of(const People& people, std::size_t id, double mass) {
    return {people.height[id], mass};
}

double share_of(const FeltStep& felt) {
    return felt.is_first ? 1 : -std::expm1(-felt.dt / mean_time);
}

// Returns V = alpha M^beta with M = |U|^2 h / g + h^2 / 2, m2: walking in 0.2 to 0.7 m of water by age (Bernardini et
// al. 2020); above 68 years less by 1 + 0.016 for each year (Dobbs et al. 1993).
double bernardini_speed(double age, double depth, double speed, double gravity) {
    struct Row {
        double up_to, alpha, beta;
    };
    constexpr std::array rows{Row{12, 0.54, -0.07}, Row{28, 0.36, -0.13}, Row{36, 0.35, -0.19}, Row{44, 0.43, -0.13},
                              Row{52, 0.57, -0.03}, Row{60, 0.32, -0.17}, Row{1e9, 0.16, -0.43}};
    const Row& row = *std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return age <= r.up_to; });
    const double specific_force = speed * speed * depth / gravity + 0.5 * depth * depth;
    return row.alpha * std::pow(specific_force, row.beta) / (1 + 0.016 * std::max(0.0, age - 68));
}

// Returns the strength of bracing legs over that of fresh, warm ones.
double strength_of_legs(const People& people, std::size_t id) {
    const Wear& wear = people.wear[id];
    return (1 - wear.legs) * holding_strength(wear.thigh);
}

bool swims(const People& people, std::size_t id) {
    if (people.can_swim[id] == 0) return false;
    return !people.water_temperature || people.wear[id].swum < swimming_time(*people.water_temperature);
}

double swimming_force_of(const People& people, std::size_t id) {
    return people.wear.empty() ? swimming_force : swimming_force * moving_strength(people.wear[id].thigh);
}

// Returns the load of the legs: the demand over the capacity of fresh legs at the same temperature.
double load_of_legs(const People& people, std::size_t id, const Strain& e) {
    const double slip = e.slip * friction_of(people, id) / people.friction[id];
    const double topple = e.moment > 0 ? e.moment / (e.weight * people.arm[id] + e.hold) : 0;
    return std::min(1.0, std::max(slip, topple) / holding_strength(people.wear[id].thigh));
}

// Advances fatigue of the legs and temperature of the body by dt, s. Legs off the ground neither tire nor rest [A].
void wear_out(People& people, std::size_t id, double dt) {
    constexpr double knee = 0.25, hand = 0.5;  // of H [A]
    Wear& wear = people.wear[id];
    const PersonState state = people.condition[id].state;
    const bool upright = is_on_feet(state);
    if (people.tires && upright) wear.legs = tired_after(wear.legs, wear.load, knee_rates, dt);
    if (!people.water_temperature) return;
    const double depth = people.depth[id], height = people.height[id];
    wear.thigh = thigh_after(wear.thigh, *people.water_temperature, !upright || depth >= knee * height, dt);
    wear.chill = chill_after(wear.chill, !upright || depth >= hand * height, dt);
    if (state == PersonState::afloat) wear.swum += dt;
}

// Returns the stance in a posture, with the present friction, lever arm and drag of the person.
Stance stance_in(const People& people, std::size_t id, double mass, Rest posture, double depth,
                 const WaterProperties& water) {
    return stance_of(posture, body_of(people, id, mass), friction_of(people, id), arm_of(people, id), depth, water,
                     people.drag[id]);
}

// Returns the largest speed through still water, m/s, that keeps D of the own motion below 0.8; infinite if afloat.
double speed_of_firm_feet(const People& people, std::size_t id, double mass, const WaterProperties& water) {
    constexpr double keeps_below = 0.8;  // D of the own motion [A]
    const double depth = people.depth[id];
    if (depth >= chin * people.height[id]) return std::numeric_limits<double>::infinity();
    const Stance stance = stance_in(people, id, mass, Rest::stands, depth, water);
    const Vector2d one(1, 0);
    const double demand = std::max(slip_demand(stance.k, one, Vector2d::Zero(), stance.friction, stance.weight),
                                   topple_demand(stance.k, one, stance.wet, stance.weight, stance.arm));
    return std::sqrt(keeps_below / demand);
}

// Returns the motion limited to the speed of firm feet: legs and means lag behind while the water gets deeper.
Vector2d firm_part_of(const Vector2d& motion, double most) {
    const double squared = motion.squaredNorm();
    return squared > most * most ? Vector2d(most / std::sqrt(squared) * motion) : motion;
}

// Returns true if the next state depends on D at rest.
bool asks_for_rest(PersonState state) {
    return !is_on_feet(state) && state != PersonState::toppled;
}

Strain strain_of(const People& people, std::size_t id, double mass, const Vector2d& velocity,
                 const WaterProperties& water) {
    const double height = people.height[id], depth = people.depth[id], wet = std::min(depth, height);
    const double k = drag_upright(height, depth, water, people.drag[id]);
    const Vector2d stream = mean_stream(people, id);
    const double most = speed_of_firm_feet(people, id, mass, water);
    const bool slides = people.condition[id].state == PersonState::sliding;  // moves with the stream, not by its legs
    Strain e;
    e.weight = weight_on_feet(body_of(people, id, mass), depth, water);
    e.slip = slip_demand(k, stream, firm_part_of(people.wanted[id], most), friction_of(people, id), e.weight);
    e.rush = rush_demand(depth, stream);
    e.moment = 0.5 * k * (stream - (slides ? velocity : firm_part_of(velocity, most))).squaredNorm() * wet;
    e.height = height;
    e.arm = arm_of(people, id);
    if (asks_for_rest(people.condition[id].state)) {
        for (std::size_t n = 0; n < rests; ++n) {
            e.at_rest[n] =
                demand_at_rest(stance_in(people, id, mass, static_cast<Rest>(n), depth, water), depth, stream);
        }
    }
    e.depth = depth;
    e.can_swim = swims(people, id);
    e.air = people.water_temperature ? std::min(people.air, breath_in(*people.water_temperature)) : people.air;
    e.drifts_under = people.drift_hazard.is_under;
    e.drowns_at = people.drowns_at[id];
    const Condition& condition = people.condition[id];
    if (is_adrift(condition.state)) {
        if (!e.drifts_under) e.hazard = people.drift_hazard.best;
        const double speed = std::sqrt(stream.squaredNorm());
        e.drift_weight = drift_weight({height, e.can_swim, speed, depth, water.gravity}) *
                         cold_weight(people.water_temperature, condition.drift.time);
    }
    e.hold = people.hold[id];
    const Stop& stop = people.stop[id];
    const bool is_held = stop.pressed > 0 || condition.state == PersonState::pinned;
    e.is_pressed = is_held && stop.time >= pinned_after;
    return e;
}

// Returns true for states that follow worse ones.
bool is_on_its_way_back(PersonState state) {
    return state == PersonState::recovering || state == PersonState::holding;
}

// Returns C of a lying body, as of an upright one with the width area_lying / depth.
double drag_of_lying(const People& people, std::size_t id, double depth) {
    if (!(people.disc_width[id] > 0) || !(depth > 0)) return body_drag;
    return drag_on_slowed_stream(body_drag, area_lying(depth) / depth, people.disc_width[id]);
}

bool is_beyond_measured(const Condition& condition, double depth) {
    const bool strains = condition.state == PersonState::effort || condition.state == PersonState::sliding;
    return strains && (depth < shallowest_measured || depth > deepest_measured);
}

// H m, m kg, of the largest small children and of the smallest adults (Cox et al. 2010).
constexpr double smallest_size = 25, largest_size = 50;

// Returns the skill that `by_size` stands for; `by_size` itself between children and adults.
Skill skill_of_size(const Body& body) {
    const double size = body.height * body.mass;
    return size <= smallest_size ? Skill::unaware : size < largest_size ? Skill::by_size : Skill::normal;
}

}  // namespace

Bracing bracing_of(Skill skill) {
    switch (skill) {
        case Skill::braced:
            return {0.80, 0.20};
        case Skill::good:
            return {0.64, 0.10};
        case Skill::unaware:
            return {0.34, 0.04};
        case Skill::poor:
            return {0.07, 0.011};
        case Skill::normal:
        case Skill::by_size:
            break;
    }
    return {0.45, 0.09};
}

Bracing bracing_of(Skill skill, const Body& body) {
    if (skill != Skill::by_size) return bracing_of(skill);
    const Bracing of_small = bracing_of(Skill::unaware), of_large = bracing_of(Skill::normal);
    const double size = body.height * body.mass;
    const double share = std::clamp((size - smallest_size) / (largest_size - smallest_size), 0.0, 1.0);
    return {of_small.friction + share * (of_large.friction - of_small.friction),
            of_small.arm_share + share * (of_large.arm_share - of_small.arm_share)};
}

double add_person(People& people, const AgentGroup& group, const PersonRow& row, bool by_body,
                  const PersonDraws& draws) {
    const BodySettings& body = group.body;
    const SexRule sex = row.sex.value_or(body.sex);
    const bool is_male = sex == SexRule::any ? draws.sex >= 0.5 : sex == SexRule::male;
    const double age = row.age.value_or(body.age.at(draws.age));
    const PersonSize size = size_of_person(group, row, age, is_male, draws);
    const Skill skill = row.skill.value_or(body.skill);
    people.skill.push_back(skill == Skill::by_size ? skill_of_size({size.height, size.mass}) : skill);
    const Bracing bracing = bracing_of(people.skill.back(), {size.height, size.mass});
    const double ground = body.ground_friction ? body.ground_friction->at(draws.friction) : bracing.friction;
    people.sex.push_back(is_male ? Sex::male : Sex::female);
    people.height.push_back(size.height);
    people.age.push_back(age);
    people.friction.push_back(row.ground_friction.value_or(ground));
    people.drag.push_back(body_drag);
    people.disc_width.push_back(0);
    const double arm = row.bracing_arm.value_or(body.bracing_arm.value_or(bracing.arm_share));
    people.arm.push_back(arm * people.height.back());
    people.can_swim.push_back(row.can_swim.value_or(body.can_swim) ? 1 : 0);
    people.by_body.push_back(by_body ? 1 : 0);
    people.dry_speed.push_back(group.desired_speed);
    people.depth.push_back(0);
    people.flow.push_back(Vector2d::Zero());
    people.lee.push_back(0);
    people.wanted.push_back(Vector2d::Zero());
    people.slip.push_back(0);
    people.topple.push_back(0);
    people.hold.push_back(0);
    people.condition.push_back({});
    people.worst.push_back(PersonState::walking);
    people.beyond.push_back(0);
    people.drowns_at.push_back(-std::log1p(-draws.drowns));
    people.stop.emplace_back();
    return size.mass;
}

void start_wear(People& people, const Crowd& crowd) {
    people.drift_hazard = crowd.drift_hazard;
    people.air = crowd.air_budget;
    for (Condition& condition : people.condition) condition.air = people.air;
    people.tires = crowd.fatigue;
    people.water_temperature = crowd.water_temperature;
    if (people.tires || people.water_temperature) people.wear.resize(people.size());
}

double friction_of(const People& people, std::size_t id) {
    if (people.wear.empty()) return people.friction[id];
    return braced_with(people.friction[id], bracing_of(Skill::unaware).friction, strength_of_legs(people, id));
}

double arm_of(const People& people, std::size_t id) {
    if (people.wear.empty()) return people.arm[id];
    const double of_dummy = bracing_of(Skill::unaware).arm_share * people.height[id];
    return braced_with(people.arm[id], of_dummy, strength_of_legs(people, id));
}

double grip_of(const People& people, std::size_t id) {
    const double fresh = grip_of(people.sex[id]);
    if (people.wear.empty()) return fresh;
    const Wear& wear = people.wear[id];
    const double warm = people.water_temperature ? chilled_grip(wear.chill, *people.water_temperature) : 1;
    return fresh * (1 - wear.hands) * warm;
}

void tire_hands(People& people, std::size_t id, double load, double dt) {
    double& tired = people.wear[id].hands;
    if (people.tires) tired = tired_after(tired, load, hand_rates, dt);
}

Vector2d mean_stream(const People& people, std::size_t id) {
    return people.depth[id] > 0 ? Vector2d(people.flow[id] / people.depth[id]) : Vector2d(0, 0);
}

void feel(People& people, std::size_t id, const FeltStep& felt) {
    const double share = share_of(felt);
    people.lee[id] += (felt.lee - people.lee[id]) * share;
    people.depth[id] += (felt.depth - people.depth[id]) * share;
    people.flow[id] += (felt.depth * felt.stream - people.flow[id]) * share;
    if (people.depth[id] >= dry) return;
    people.depth[id] = 0;
    people.flow[id].setZero();
}

double speed_in_water(const People& people, std::size_t id, double mass, WalkingLaw law, const WaterProperties& water) {
    const double depth = people.depth[id], dry_speed = people.dry_speed[id], gravity = water.gravity;
    if (!(depth > 0)) return dry_speed;
    const double flow = std::sqrt(mean_stream(people, id).squaredNorm());
    const double speed = law == WalkingLaw::relative
                             ? dry_speed * walking_speed_ratio(people.sex[id], depth, flow, gravity)
                             : std::min(dry_speed, bernardini_speed(people.age[id], depth, flow, gravity));
    const double drag_left = (1 - people.lee[id]) * (1 - people.lee[id]);
    const double in_lee = speed + gain_in_lee * (1 - drag_left) * (dry_speed - speed);
    return std::min(in_lee, speed_of_firm_feet(people, id, mass, water));
}

double demand_at(const People& people, std::size_t id, double mass, const Vector2d& along, const WaterProperties& water,
                 const FeltStep& felt) {
    const double height = people.height[id], depth = felt.depth;
    if (depth >= chin * height) return std::numeric_limits<double>::infinity();
    const double speed = std::sqrt(felt.stream.squaredNorm());
    const Vector2d walking =
        people.dry_speed[id] * walking_speed_ratio(people.sex[id], depth, speed, water.gravity) * along;
    const Stance stance = stance_in(people, id, mass, Rest::stands, depth, water);
    return std::max({slip_demand(stance.k, felt.stream, walking, stance.friction, stance.weight),
                     topple_demand(stance.k, felt.stream - walking, stance.wet, stance.weight, stance.arm),
                     rush_demand(depth, felt.stream)});
}

void note_condition(People& people, std::size_t id, double mass, const Vector2d& velocity, const Vector2d& wanted,
                    const WaterProperties& water, const FeltStep& felt) {
    people.wanted[id] += (wanted - people.wanted[id]) * share_of(felt);
    if (!people.wear.empty()) wear_out(people, id, felt.dt);
    Condition& condition = people.condition[id];
    if (people.depth[id] == 0 && condition.state == PersonState::walking) {  // on dry ground, as most are
        people.slip[id] = people.topple[id] = 0;
        condition.slipping = condition.toppling = 0;
        condition.air = people.air;
        breathe(condition.drift, felt.dt);
        if (!people.wear.empty()) people.wear[id].load = 0;
        return;
    }
    const Strain strain = strain_of(people, id, mass, velocity, water);
    people.slip[id] = std::max(strain.slip, strain.rush);
    people.topple[id] = topple_demand(strain);
    if (!people.wear.empty()) people.wear[id].load = load_of_legs(people, id, strain);
    condition = next_condition(condition, strain, felt.dt);
    const bool is_worse = condition.state > people.worst[id];
    if (is_worse && !is_on_its_way_back(condition.state)) people.worst[id] = condition.state;
    if (is_beyond_measured(condition, people.depth[id])) people.beyond[id] += felt.dt;
}

void note_stop(People& people, std::size_t id, const Vector2d& position, const Vector2d& motion, const Vector2d& wanted,
               double dt) {
    Stop& stop = people.stop[id];
    const PersonState state = people.condition[id].state;
    const Vector2d lost = wanted - motion;
    const bool is_cut = lost.squaredNorm() > 0.25 * wanted.squaredNorm() && lost.dot(people.flow[id]) > 0;
    stop.pressed = is_cut ? stays_pressed : std::max(0.0, stop.pressed - dt);
    if (is_on_feet(state) || (position - stop.at).squaredNorm() > stays_within * stays_within) {
        stop.at = position;
        stop.time = 0;
        return;
    }
    stop.time += dt;
    if (stop.time <= stop.longest || state == PersonState::drowned) return;
    stop.longest = stop.time;
    stop.state = state;
}

PersonInWater person_in_water(const People& people, std::size_t id, double mass, const Vector2d& wanted,
                              const WaterProperties& water, const FeltStep& felt) {
    const double height = people.height[id];
    const PersonState state = people.condition[id].state;
    PersonInWater person;
    person.stream = felt.stream;
    person.most_impulse = felt.most_impulse;
    person.has_ground = has_ground(state);
    if (!person.has_ground && state != PersonState::afloat) {
        constexpr double thickness = 0.25;  // of a body that lies, m
        const double share = std::min(1.0, felt.depth / thickness);
        person.footing = {drag_lying(felt.depth, water, drag_of_lying(people, id, felt.depth)),
                          mass_with_water(mass, share, water), 0};
        return person;
    }
    const bool recovers = state == PersonState::recovering;
    const Stance stance =
        stance_in(people, id, mass, recovers ? posture_of(people.condition[id]) : Rest::stands, felt.depth, water);
    const double grip = grip_in_stream(stance.friction * stance.weight, stance.k, felt.depth, felt.stream);
    person.footing = {stance.k, mass_with_water(mass, submerged_share(height, felt.depth), water), grip};
    if (!recovers) person.wanted = wanted;
    if (swims(people, id)) person.swimming = swimming_force_of(people, id) * unit_or(wanted, Vector2d::Zero());
    return person;
}

}  // namespace wade::crowd
