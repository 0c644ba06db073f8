#pragma once
// Hands and arms: people who hold one another, a rope or a line. A link pulls; of arms across backs it also pushes.
//
//   T = clamp(K (L' - L_0) + c dL'/dt, -T_push, T_grip)      L' the distance of both ends after the step, L_0 at rest, m
//   K = 2 kN/m, c = 0.4 kN s/m [A];   T_push = 0 but for arms, there T_grip;   L_0 = 0.7 m but for lines and ropes with a free end
//   T_grip = 220 N of men, 140 N of women [A]: half of the strength of a hand of 45 and 28 kg; of a link the lesser of both;
//   a rope and a line are held with both hands, with 2 T_grip
//
// A link whose pull would be above T_grip for 0.3 s lets go. Who holds on to somebody on his feet has the moment 0.8 H T_grip
// more before he topples. A file in a stream needs arms: its first is driven onto the second, and hands do not push back.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crowd_client/people/person.hpp"

namespace wade::crowd {

inline constexpr double link_length = 0.7, link_reach = 0.8;     // at rest and at most where one takes a hand, m
inline constexpr double grip_of_men = 220, grip_of_women = 140;  // N [A]

// What a link joins: hands of a and of b, those of a and a rope, those of a rescuer a and of b at either end of a line.
enum class LinkKind : std::uint8_t { hands, rope, line };

// Of two who walk in file, the one behind whom the other walks.
enum class Lead : std::uint8_t { nobody, a, b };

struct Link {
    std::uint32_t a = 0, b = 0;  // ids; of a rope b is a as well
    bool pushes = false;
    double grip = 0;            // T_grip, N
    double pull = 0;            // T of the last step, N; below 0 it pushes
    double overdue = 0;         // how long more than the grip has been asked of it, s
    double rest = link_length;  // L_0, m
    LinkKind kind = LinkKind::hands;
    std::size_t rope = 0;             // its place in the list of the scene
    Vector2d tie = Vector2d::Zero();  // where the rope is held, or fixed if its end is free, m
    Lead leads = Lead::nobody;
};

[[nodiscard]] inline double grip_of(Sex sex) {
    return sex == Sex::male ? grip_of_men : grip_of_women;
}

// What a rescuer does at the moment (rescue.hpp).
struct Rescuer {
    std::uint32_t id = 0;
    bool has_line = false;                // as of the last step
    bool stands = false;                  // wants to stay where it is
    std::optional<Vector2d> way;          // that it takes instead of the one to its goal, m
    Vector2d retreat = Vector2d::Zero();  // where it brings whom it holds, m
    double next_throw = 0;                // not before this time, s
    std::vector<Vector2d> round;          // places of a way round obstacles to somebody, the last the next, m
    double next_look = 0;                 // for such a way, not before this time, s
    bool lost_feet = false;               // at some time
};

struct Rescues {
    std::vector<Rescuer> rescuers;         // by id
    std::vector<std::uint8_t> brought_in;  // by id
};

// M_hold that a grip gives somebody of height H, N m.
[[nodiscard]] inline double moment_of_hold(double height, double grip) {
    return 0.8 * height * grip;
}

// A person in a step with links, or a place to which a rope is tied.
struct LinkedPerson {
    PersonInWater person;
    bool is_fixed = false;                 // the place
    Vector2d velocity = Vector2d::Zero();  // before the step, m/s
    Vector2d pulls = Vector2d::Zero();     // sum of T along its links, N
    Vector2d next = Vector2d::Zero();      // after it, m/s
};

// Whom of a list of people a link joins, and the way from one to the other, m.
struct LinkPlaces {
    std::size_t a = 0, b = 0;
    Vector2d way = Vector2d::Zero();
};

// The velocities of linked people after a step of dt, s, into `next`, and the pulls of their links: each link in turn, by its
// place in the list, is solved with both of its people as the others leave them, four times round. people[k].next is that of
// a step without links before.
void pull_links(std::span<LinkedPerson> people, std::span<Link> links, std::span<const LinkPlaces> places, double dt);

// Whether it lets go after the step.
[[nodiscard]] bool lets_go(const Link& link, double dt);

}  // namespace wade::crowd
