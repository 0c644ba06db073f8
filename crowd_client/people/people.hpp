#pragma once
// What people bring into the water and what it does to them: one array a property, the index is the agent's id.

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

// How long a person off its feet stays within a metre of one position. A person is pressed where a solid or others cut more than half
// of a motion, against the stream, within the last second.
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
    std::vector<double> drag;        // C on the water that it feels: C_D, or more of who pushes the water (push.hpp)
    std::vector<double> disc_width;  // W_e of people who push the water, m; else 0
    std::vector<double> arm;         // l = lambda H, m
    std::vector<std::uint8_t> can_swim;
    std::vector<std::uint8_t> by_body;  // answers the water by its body (response measured) and not by a given tau
    std::vector<double> dry_speed;      // at which it walks on dry ground, m/s

    // As of the last step, low-passed with 0.3 s: a stride takes 0.5 s, and people fail on means.
    std::vector<double> depth;     // h, m
    std::vector<Vector2d> flow;    // h U, m2/s
    std::vector<double> lee;       // delta of the wake in which it walks (push.hpp), [0, 1]; 0 without shelter
    std::vector<Vector2d> wanted;  // walking velocity, m/s
    std::vector<double> slip;      // S
    std::vector<double> topple;    // T
    std::vector<double> hold;      // M_hold of those it holds on to who stand, N m; 0 for most
    std::vector<Condition> condition;
    std::vector<PersonState> worst;  // state so far, in the order of PersonState; recovering and holding do not count
    std::vector<double> beyond;      // time on its feet beyond what was measured, s
    std::vector<double> drowns_at;   // E of drift.hpp
    std::vector<Stop> stop;

    std::vector<Wear> wear;  // empty where nobody tires and the water is not cold
    bool tires = false;
    std::optional<double> water_temperature;  // C
    DriftHazard drift_hazard;
    double air = air_budget;  // that lasts, s

    [[nodiscard]] std::size_t size() const { return height.size(); }
};

// The person's surroundings in a step.
struct FeltStep {
    double depth = 0;                                               // h felt, m
    Vector2d stream = Vector2d::Zero();                             // U felt, m/s
    double dt = 0;                                                  // s
    bool is_first = false;                                          // of the run: nothing was felt before
    double most_impulse = std::numeric_limits<double>::infinity();  // that the water has to give in the step, N s
    double lee = 0;                                                 // delta of the wake in which it walks
};

// mu and lambda of a skill; docs/people_in_water.md has their sources.
struct Bracing {
    double friction, arm_share;
};
[[nodiscard]] Bracing bracing_of(Skill skill);

// The same of a person of a size. by_size: up to H m = 25 m kg that of `unaware`, from 50 m kg on that of `normal`, linear between.
[[nodiscard]] Bracing bracing_of(Skill skill, const Body& body);

// Adds a person, of a table or drawn, and returns its mass, kg.
double add_person(People& people, const AgentGroup& group, const PersonRow& row, bool by_body,
                  const PersonDraws& draws);

// Lets time act upon people, as the scene says.
void start_wear(People& people, const Crowd& crowd);

// mu and l of the legs, and the grip of the hands, N, as time has left them.
[[nodiscard]] double friction_of(const People& people, std::size_t id);
[[nodiscard]] double arm_of(const People& people, std::size_t id);
[[nodiscard]] double grip_of(const People& people, std::size_t id);

// A step of dt, s, of hands that hold `load` of what fresh ones hold, [0, 1].
void tire_hands(People& people, std::size_t id, double load, double dt);

// U as low-passed, m/s; 0 without water.
[[nodiscard]] Vector2d mean_stream(const People& people, std::size_t id);

// Takes what a person feels into the means.
void feel(People& people, std::size_t id, const FeltStep& felt);

// How fast it walks in the water that it has felt, m/s. In the lee of somebody who walks before it, v of the law becomes
// v + eta (1 - s) (v_dry - v), s = (1 - lee)^2 the share of the drag that is left, eta = 0.11.
// No faster than the own motion through still water keeps D below 0.8 [A].
[[nodiscard]] double speed_in_water(const People& people, std::size_t id, double mass, WalkingLaw law,
                                    const WaterProperties& water);

// D of somebody who would walk along a unit vector, or stand if it is 0, where the water is as felt; infinite where one floats.
[[nodiscard]] double demand_at(const People& people, std::size_t id, double mass, const Vector2d& along,
                               const WaterProperties& water, const FeltStep& felt);

// S, T and the state after a step, of somebody who goes at `velocity` and wants to walk at `wanted`.
void note_condition(People& people, std::size_t id, double mass, const Vector2d& velocity, const Vector2d& wanted,
                    const WaterProperties& water, const FeltStep& felt);

// Takes a motion of a step of dt, s, that ends at a position, m, in place of a wanted one.
void note_stop(People& people, std::size_t id, const Vector2d& position, const Vector2d& motion, const Vector2d& wanted,
               double dt);

// The person as it is in the step, wanting to walk at `wanted`; stream and depth as felt, raw.
[[nodiscard]] PersonInWater person_in_water(const People& people, std::size_t id, double mass, const Vector2d& wanted,
                                            const WaterProperties& water, const FeltStep& felt);

}  // namespace wade::crowd
