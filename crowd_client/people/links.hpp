#pragma once
// Hands and arms: people who hold one another. A link pulls; of arms across backs it also pushes.
//
//   T = clamp(K (L' - 0.7 m) + c dL'/dt, -T_push, T_grip)      L' the distance of the two at the end of the step, m
//   K = 2 kN/m, c = 0.4 kN s/m [A];   T_push = 0 for hands, T_grip for arms
//   T_grip = 220 N of men, 140 N of women [A]: half of the strength of a hand of 45 and 28 kg; of a link the lesser of both
//
// A link whose pull would be above T_grip for 0.3 s lets go. Who holds on to somebody on his feet has the moment 0.8 H T_grip
// more before he topples. A file in a stream needs arms: its first is driven onto the second, and hands do not push back.

#include <cstdint>
#include <span>

#include "crowd_client/people/person.hpp"

namespace wade::crowd {

inline constexpr double link_length = 0.7, link_reach = 0.8;     // at rest and at most where one takes a hand, m
inline constexpr double grip_of_men = 220, grip_of_women = 140;  // N [A]

struct Link {
    std::uint32_t a = 0, b = 0;  // ids
    bool pushes = false;
    double grip = 0;     // T_grip, N
    double pull = 0;     // T of the last step, N; below 0 it pushes
    double overdue = 0;  // how long more than the grip has been asked of it, s
};

[[nodiscard]] inline double grip_of(Sex sex) {
    return sex == Sex::male ? grip_of_men : grip_of_women;
}

// M_hold that a grip gives somebody of height H, N m.
[[nodiscard]] inline double moment_of_hold(double height, double grip) {
    return 0.8 * height * grip;
}

// A person in a step with links.
struct LinkedPerson {
    PersonInWater person;
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
