#include "crowd_client/people/links.hpp"

#include <algorithm>
#include <cmath>

namespace wade::crowd {
namespace {

constexpr double stiffness = 2000, damping = 400;  // K, N/m; c, N s/m
constexpr double patience = 0.3;                   // s, before an overloaded link lets go
constexpr int rounds = 4, halvings = 40;

// One link between two people, under the given pulls of their other links.
class Pair {
 public:
    Pair(LinkedPerson& a, LinkedPerson& b, const Vector2d& way, const Link& link, double dt)
        : a_(a),
          b_(b),
          dt_(dt),
          length_(std::sqrt(way.squaredNorm())),
          rest_(link.rest),
          along_(unit_or(way, Vector2d(1, 0))),
          others_a_(a.pulls - link.pull * along_),
          others_b_(b.pulls + link.pull * along_) {}

    // Returns K (L' - L_0) + c dL'/dt after a step with the pull T; it decreases with T.
    [[nodiscard]] double asked(double pull) {
        a_.pulls = others_a_ + pull * along_;
        b_.pulls = others_b_ - pull * along_;
        move(a_);
        move(b_);
        const double growth = (b_.next - a_.next).dot(along_);
        return stiffness * (length_ + dt_ * growth - rest_) + damping * growth;
    }

 private:
    void move(LinkedPerson& one) const {
        if (!one.is_fixed) one.next = step_in_water(one.person, one.velocity, one.pulls, dt_).velocity;
    }

    LinkedPerson &a_, &b_;
    double dt_;
    double length_, rest_;
    Vector2d along_, others_a_, others_b_;
};

// Finds T = asked(T) by bisection, between the largest push and the largest pull of the link.
void solve(Link& link, Pair pair) {
    double lo = link.pushes ? -link.grip : 0, hi = link.grip;
    if (pair.asked(hi) >= hi) {
        link.pull = hi;
        return;
    }
    if (pair.asked(lo) <= lo) {
        link.pull = lo;
        return;
    }
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (lo + hi);
        (pair.asked(middle) > middle ? lo : hi) = middle;
    }
    link.pull = 0.5 * (lo + hi);
    static_cast<void>(pair.asked(link.pull));
}

}  // namespace

void pull_links(std::span<LinkedPerson> people, std::span<Link> links, std::span<const LinkPlaces> places, double dt) {
    for (LinkedPerson& person : people) person.pulls.setZero();
    for (std::size_t i = 0; i < links.size(); ++i) {  // from the pulls of the step before
        const Vector2d pull = links[i].pull * unit_or(places[i].way, Vector2d(1, 0));
        people[places[i].a].pulls += pull;
        people[places[i].b].pulls -= pull;
    }
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < links.size(); ++i) {
            const LinkPlaces& place = places[i];
            solve(links[i], Pair(people[place.a], people[place.b], place.way, links[i], dt));
        }
    }
    for (Link& link : links) link.overdue = link.pull >= link.grip ? link.overdue + dt : 0;
}

bool lets_go(const Link& link, double dt) {
    return link.overdue >= patience - 0.5 * dt;
}

}  // namespace wade::crowd
