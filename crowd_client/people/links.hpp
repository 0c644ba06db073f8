#pragma once
// Links between people by hands and arms, and to ropes and lines. A link pulls; arms across backs also push.
//
//   T = clamp(K (L' - L_0) + c dL'/dt, -T_push, T_grip)      L' the distance of both ends after the step, L_0 at rest, m
//   K = 2 kN/m, c = 0.4 kN s/m [A];   T_push = T_grip for arms, else 0;
//   L_0 = 0.7 m, except for lines and ropes with a free end
//   T_grip = 220 N of men, 140 N of women [A]: half of a hand's strength of 45 and 28 kg; of a link the smaller;
//   both hands hold a rope or a line, with 2 T_grip
//
// A link that needs more than T_grip for 0.3 s lets go. Holding on to a standing person adds the moment 0.8 H T_grip
// against toppling. A file in a stream needs arms: the water drives the first person onto the second, and hands do not
// push back.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crowd_client/people/person.hpp"

namespace wade::crowd {

inline constexpr double link_length = 0.7, link_reach = 0.8;     // at rest, and largest when a hand is taken, m
inline constexpr double grip_of_men = 220, grip_of_women = 140;  // N [A]

// Kinds of links: hands of a and b; hands of a on a rope; a line from rescuer a to b.
enum class LinkKind : std::uint8_t { hands, rope, line };

// The leader of two people that walk in file.
enum class Lead : std::uint8_t { nobody, a, b };

struct Link {
    std::uint32_t a = 0, b = 0;  // ids; of a rope b is a as well
    bool pushes = false;
    double grip = 0;            // T_grip, N
    double pull = 0;            // T of the last step, N; below 0 it pushes
    double overdue = 0;         // time for which T has been at the grip, s
    double rest = link_length;  // L_0, m
    LinkKind kind = LinkKind::hands;
    std::size_t rope = 0;             // its index in the list of the scene
    Vector2d tie = Vector2d::Zero();  // held point of the rope, or its fixed end if one end is free, m
    Lead leads = Lead::nobody;
};

[[nodiscard]] inline double grip_of(Sex sex) {
    return sex == Sex::male ? grip_of_men : grip_of_women;
}

// Current action of a rescuer (rescue.hpp).
struct Rescuer {
    std::uint32_t id = 0;
    bool has_line = false;                // as of the last step
    bool stands = false;                  // wants to stay where it is
    std::optional<Vector2d> way;          // displacement to take instead of the route to its goal, m
    Vector2d retreat = Vector2d::Zero();  // where it takes the person on its line, m
    double next_throw = 0;                // earliest time of the next throw, s
    std::vector<Vector2d> round;          // waypoints of a detour to a person, the last comes next, m
    double next_look = 0;                 // earliest time of the next search for a detour, s
    bool lost_feet = false;               // at any time so far
};

struct Rescues {
    std::vector<Rescuer> rescuers;         // by id
    std::vector<std::uint8_t> brought_in;  // by id
};

// Returns M_hold that a grip gives a person of height H, N m.
[[nodiscard]] inline double moment_of_hold(double height, double grip) {
    return 0.8 * height * grip;
}

// A person with links in a step, or the fixed point of a rope.
struct LinkedPerson {
    PersonInWater person;
    bool is_fixed = false;                 // the fixed point
    Vector2d velocity = Vector2d::Zero();  // before the step, m/s
    Vector2d pulls = Vector2d::Zero();     // sum of T over its links, N
    Vector2d next = Vector2d::Zero();      // after the step, m/s
};

// Indices of a link's two ends in a list of people, and the vector from a to b, m.
struct LinkPlaces {
    std::size_t a = 0, b = 0;
    Vector2d way = Vector2d::Zero();
};

// Computes the velocities of linked people after a step of dt, s, in `next`, and the pulls of their links. Four
// Gauss-Seidel rounds solve each link in list order, with the current pulls of all others. On entry, people[k].next is
// the velocity after a step without links.
void pull_links(std::span<LinkedPerson> people, std::span<Link> links, std::span<const LinkPlaces> places, double dt);

// Returns true if the link lets go after the step.
[[nodiscard]] bool lets_go(const Link& link, double dt);

}  // namespace wade::crowd
