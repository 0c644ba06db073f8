// Chains in streams of 1 m, of people of 1.70 m and 65 kg on ground of 0.45. Closed forms: alone one slides at
// u = sqrt(mu N / k); whoever is linked shares what all of the chain hold.

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "crowd_client/people/links.hpp"

namespace wade::crowd::links_test {

const double drag = drag_upright(1.7, 1, {}), weight = weight_on_feet({1.7, 65}, 1, {});
const double mass = mass_with_water(65, submerged_share(1.7, 1), {});
const double alone = std::sqrt(0.45 * weight / drag);  // 1.060 m/s

struct Chain {
    std::vector<LinkedPerson> people;
    std::vector<Link> links;
    std::vector<LinkPlaces> places;
    std::vector<Vector2d> position;
};

// People `pitch` apart along a direction, each with a friction and a fraction of the drag; the first is upstream.
Chain chain_of(const std::vector<double>& friction, const std::vector<double>& shelter, const Vector2d& direction,
               bool pushes, double pitch = link_length) {
    Chain chain;
    for (std::size_t i = 0; i < friction.size(); ++i) {
        LinkedPerson one;
        one.person.footing = {shelter[i] * drag, mass, friction[i] * weight};
        chain.people.push_back(one);
        chain.position.emplace_back(static_cast<double>(i) * pitch * direction);
        if (i == 0) continue;
        chain.links.push_back({static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i), pushes, grip_of_men});
        chain.places.push_back({i - 1, i, Vector2d::Zero()});
    }
    return chain;
}

// Walks the chain for a time in a stream towards -x; returns the largest speed at the end, m/s.
double walk(Chain& chain, double stream, double time, double dt = 1 / 30.0) {
    for (LinkedPerson& one : chain.people) one.person.stream = {-stream, 0};
    for (int i = 0; i < std::lround(time / dt); ++i) {
        for (LinkedPerson& one : chain.people) {
            one.next = step_in_water(one.person, one.velocity, Vector2d::Zero(), dt).velocity;
        }
        for (LinkPlaces& place : chain.places) place.way = chain.position[place.b] - chain.position[place.a];
        pull_links(chain.people, chain.links, chain.places, dt);
        for (std::size_t k = 0; k < chain.people.size(); ++k) {
            chain.people[k].velocity = chain.people[k].next;
            chain.position[k] += dt * chain.people[k].next;
        }
    }
    double fastest = 0;
    for (const LinkedPerson& one : chain.people) fastest = std::max(fastest, one.velocity.norm());
    return fastest;
}

// Returns the smallest speed of the stream, m/s, that moves a person of the chain at 0.02 m/s after a time.
double critical_speed(const Chain& chain, double time = 6) {
    double lo = 0.5, hi = 4;
    for (int i = 0; i < 14; ++i) {
        const double middle = 0.5 * (lo + hi);
        Chain trial = chain;
        (walk(trial, middle, time) > 0.02 ? hi : lo) = middle;
    }
    return lo;
}

const Vector2d abreast(0, 1), in_file(-1, 0);

TEST_CASE("Equal people abreast slide as one alone does") {
    const double critical = critical_speed(chain_of({0.45, 0.45, 0.45}, {1, 1, 1}, abreast, false));
    CHECK(alone == Approx(1.060).epsilon(0.001));
    CHECK(critical == Approx(critical_speed(chain_of({0.45}, {1}, abreast, false))).epsilon(1e-3));
    CHECK(critical == Approx(alone + 0.02).epsilon(1e-3));  // a sliding person is slower than the stream by `alone`
}

// Rigid: u^2 = (n - 1/2) / n mu N / k, 0.968 m/s. Links stretch until they pull, and then aslant.
TEST_CASE("A weak one between two is held by them") {
    const double critical = critical_speed(chain_of({0.45, 0.225, 0.45}, {1, 1, 1}, abreast, false), 3);
    CHECK(critical > 1.2 * alone / std::sqrt(2));
    CHECK(critical < std::sqrt(2.5 / 3) * alone * 1.01);
    CHECK(critical == Approx(0.949).epsilon(0.03));
}

// People behind the first take 0.119 of the drag. Rigid: 1.65 m/s for all three.
TEST_CASE("A file needs links that push") {
    const std::vector<double> friction(3, 0.45), shelter{1, 0.119, 0.119};
    const double pulls = critical_speed(chain_of(friction, shelter, in_file, false), 1.5);
    const double pushes = critical_speed(chain_of(friction, shelter, in_file, true), 1.5);
    CHECK(pulls == Approx(alone).epsilon(0.03));
    CHECK(pushes > 1.4 * alone);
    CHECK(pushes < std::sqrt(3 / 1.238) * alone * 1.02);
}

TEST_CASE("A body in the stream pulls the one who holds it with its drag, at any rate") {
    for (const double rate : {15.0, 30.0, 120.0}) {
        Chain chain = chain_of({1e6, 0}, {1, 1}, in_file, false);
        chain.people[1].person.has_ground = false;
        chain.people[1].person.footing.k = 275.0 / 2;
        CHECK(walk(chain, 1, 20, 1 / rate) < 1e-3);
        CHECK(chain.links[0].pull == Approx(137.5).epsilon(0.01));
        CHECK(!lets_go(chain.links[0], 1 / rate));
    }
}

TEST_CASE("A grip lets go after 0.3 s of more than it holds, and not of less") {
    for (const double rate : {15.0, 30.0, 60.0, 120.0}) {
        Chain chain = chain_of({1e6, 0}, {1, 1}, in_file, false);
        chain.people[1].person.has_ground = false;
        chain.people[1].person.footing.k = 275;
        walk(chain, 0.85, 20, 1 / rate);  // 199 N
        CHECK(!lets_go(chain.links[0], 1 / rate));
        double time = 0;
        while (time < 10 && !lets_go(chain.links[0], 1 / rate)) {
            walk(chain, 1.5, 1 / rate, 1 / rate);  // 619 N
            time += 1 / rate;
        }
        CHECK(time == Approx(0.3).margin(2 / rate));
    }
}

// T = k u^2 with k = 137.5 kg/m of a body that lies in 0.125 m: 440 N at 1.789 m/s.
TEST_CASE("A rope pulls whom it holds with his drag, and both hands hold it up to 1.79 m/s, at any rate") {
    for (const double rate : {15.0, 30.0, 120.0}) {
        const auto pull_at = [&](double stream) {
            Chain chain = chain_of({1e6, 0}, {1, 1}, in_file, false);
            chain.people[0].is_fixed = true;
            chain.people[1].person.has_ground = false;
            chain.people[1].person.footing.k = drag_lying(0.125, {});
            chain.links[0].kind = LinkKind::rope;
            chain.links[0].grip = 2 * grip_of_men;
            for (double speed = 0.5; speed < stream; speed += 0.05) walk(chain, speed, 1, 1 / rate);
            walk(chain, stream, 20, 1 / rate);
            CHECK(chain.position[0] == Vector2d(0, 0));
            return lets_go(chain.links[0], 1 / rate) ? 0.0 : chain.links[0].pull;
        };
        CHECK(pull_at(1) == Approx(137.5).epsilon(1e-3));
        CHECK(pull_at(1.5) == Approx(309.4).epsilon(1e-3));
        CHECK(pull_at(1.78) == Approx(435.7).epsilon(1e-3));
        CHECK(pull_at(1.80) == 0);
    }
}

TEST_CASE("What one of a pair gains the other loses") {
    Chain chain = chain_of({0, 0}, {0, 0}, in_file, true, 0.78);
    for (LinkedPerson& one : chain.people) one.person.has_ground = false;
    chain.people[0].velocity = {1, 0.2};
    walk(chain, 0, 1);
    const Vector2d sum = chain.people[0].velocity + chain.people[1].velocity;
    CHECK((sum - Vector2d(1, 0.2)).norm() < 1e-12);
    CHECK((chain.position[1] - chain.position[0]).norm() == Approx(link_length).margin(0.15));
}

}  // namespace wade::crowd::links_test
