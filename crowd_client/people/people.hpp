#pragma once
// Properties and states of people in water: one array a property, the index is the agent's id.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "configs/scene/person_size.hpp"
#include "crowd_client/people/person.hpp"
#include "crowd_client/people/states.hpp"
#include "crowd_client/people/wear.hpp"

namespace wade::crowd {

// How long a person off its feet stays within a metre of one position. A person counts as pressed for 1 s after a solid
// or other people cut more than half of its motion, if the lost part points downstream.
struct Stop {
    Vector2d at = Vector2d::Zero();            // m
    double time = 0;                           // so far, s
    double pressed = 0;                        // time left in which it counts as pressed, s
    double longest = 0;                        // of all, s
    PersonState state = PersonState::walking;  // at the end of the longest one
};

struct People {
    std::vector<double> height;  // H, m
    std::vector<Sex> sex;
    std::vector<double> age;  // years
    std::vector<Skill> skill;
    std::vector<double> friction;    // mu of the feet
    std::vector<double> drag;        // C on the sampled flow: C_D, or more with two-way exchange (push.hpp)
    std::vector<double> disc_width;  // W_e with two-way exchange, m; else 0
    std::vector<double> arm;         // l = lambda H, m
    std::vector<std::uint8_t> can_swim;
    std::vector<std::uint8_t> by_body;  // 1: response `measured`, from its body; 0: from a given tau
    std::vector<double> dry_speed;      // walking speed on dry ground, m/s

    // As of the last step, low-passed with 0.3 s: a stride takes 0.5 s, and stability depends on means.
    std::vector<double> depth;     // h, m
    std::vector<Vector2d> flow;    // h U, m2/s
    std::vector<double> lee;       // delta of the wake that it walks in (push.hpp), [0, 1]; 0 without shielding
    std::vector<Vector2d> wanted;  // walking velocity, m/s
    std::vector<double> slip;      // S
    std::vector<double> topple;    // T
    std::vector<double> hold;      // M_hold of its links to standing people or ropes, N m; 0 for most
    std::vector<Condition> condition;
    std::vector<PersonState> worst;  // state so far, in the order of PersonState; recovering and holding do not count
    std::vector<double> beyond;      // time on its feet beyond what was measured, s
    std::vector<double> drowns_at;   // E of drift.hpp
    std::vector<Stop> stop;

    std::vector<Wear> wear;  // empty unless people tire or the water has a temperature
    bool tires = false;
    std::optional<double> water_temperature;  // C
    DriftHazard drift_hazard;
    double air = air_budget;  // that lasts, s

    [[nodiscard]] std::size_t size() const { return height.size(); }
};

// The person's surroundings in a step.
struct FeltStep {
    double depth = 0;                                               // h sampled, m
    Vector2d stream = Vector2d::Zero();                             // U sampled, m/s
    double dt = 0;                                                  // s
    bool is_first = false;                                          // of the run: no earlier samples
    double most_impulse = std::numeric_limits<double>::infinity();  // that the water can give in the step, N s
    double lee = 0;                                                 // delta of the wake that the person walks in
};

// Constants mu and lambda of a skill; sources in docs/people_in_water.md.
struct Bracing {
    double friction, arm_share;
};
[[nodiscard]] Bracing bracing_of(Skill skill);

// The same for a person of a size. by_size: `unaware` up to H m = 25 m kg, `normal` from 50 m kg on, linear between.
[[nodiscard]] Bracing bracing_of(Skill skill, const Body& body);

// Adds a person, from a table or drawn at random, and returns its mass, kg.
double add_person(People& people, const AgentGroup& group, const PersonRow& row, bool by_body,
                  const PersonDraws& draws);

// Sets up fatigue, cold, air and the drowning hazard as in the scene.
void start_wear(People& people, const Crowd& crowd);

// Return mu and l of the legs, and the grip of the hands, N, after fatigue and cold.
[[nodiscard]] double friction_of(const People& people, std::size_t id);
[[nodiscard]] double arm_of(const People& people, std::size_t id);
[[nodiscard]] double grip_of(const People& people, std::size_t id);

// Advances the fatigue of the hands by dt, s, under a load, [0, 1] of the fresh grip.
void tire_hands(People& people, std::size_t id, double load, double dt);

// Returns the low-passed U, m/s; 0 without water.
[[nodiscard]] Vector2d mean_stream(const People& people, std::size_t id);

// Updates the low-passed depth, flow and wake with the sampled flow of a step.
void feel(People& people, std::size_t id, const FeltStep& felt);

// Returns the walking speed in the low-passed water, m/s. In the wake of another person, v of the law becomes
// v + eta (1 - s) (v_dry - v), s = (1 - lee)^2 the remaining fraction of the drag, eta = 0.11.
// The speed is limited so that the own motion through still water keeps D below 0.8 [A].
[[nodiscard]] double speed_in_water(const People& people, std::size_t id, double mass, WalkingLaw law,
                                    const WaterProperties& water);

// Returns D of a person that walks along a unit vector, or stands if it is 0, in the sampled water; infinite where the
// person floats.
[[nodiscard]] double demand_at(const People& people, std::size_t id, double mass, const Vector2d& along,
                               const WaterProperties& water, const FeltStep& felt);

// Updates S, T and the state after a step. `velocity`: of the person; `wanted`: desired walking velocity, m/s.
void note_condition(People& people, std::size_t id, double mass, const Vector2d& velocity, const Vector2d& wanted,
                    const WaterProperties& water, const FeltStep& felt);

// Records the motion of a step of dt, s, that ends at `position`, m, and the wanted motion. Updates `stop`.
void note_stop(People& people, std::size_t id, const Vector2d& position, const Vector2d& motion, const Vector2d& wanted,
               double dt);

// Returns the terms of the person's step, with the walking velocity `wanted`; stream and depth as sampled, unfiltered.
[[nodiscard]] PersonInWater person_in_water(const People& people, std::size_t id, double mass, const Vector2d& wanted,
                                            const WaterProperties& water, const FeltStep& felt);

}  // namespace wade::crowd
