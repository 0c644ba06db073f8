#include "responses/conformance.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "crowd_client/markers/counter_random.hpp"
#include "crowd_client/water/contacts.hpp"
#include "made_up_water.hpp"

namespace wade::crowd::testing {
namespace {

constexpr std::size_t people = 40;

// People scattered over a stream, each with a velocity, a mass and a tau of its own.
struct People {
    Scene scene;
    Agents agents;
    WaterBins water;
    std::vector<std::uint32_t> active;
    std::vector<Vector2d> positions, walking;
    std::vector<Contact> contacts;
    std::vector<FeltWater> felt;

    [[nodiscard]] FrozenCrowd frozen() const {
        return {scene, 1 / scene.crowd->step_rate, agents, active, positions, walking, contacts, water, felt};
    }
};

double drawn(std::uint64_t purpose, std::uint64_t i) {
    return counter_uniform(1, purpose, i);
}

MadeUpWater stream() {
    MadeUpWater water;
    for (std::uint64_t i = 0; i < 6000; ++i) {
        water.add(20 + 20 * drawn(0, i), 12 + 20 * drawn(1, i), 60, -1 - drawn(2, i), drawn(3, i) - 0.5);
    }
    return water;
}

void find_contacts(People& p) {
    std::vector<WaterParticle> touching;
    p.contacts.clear();
    for (const Vector2d& at : p.positions) {
        p.contacts.push_back(find_contact(p.water, at, contact_distance(p.scene.coupling), touching));
    }
}

People people_in(const Scene& scene, const MadeUpWater& water) {
    People p;
    p.scene = scene;
    p.agents = make_agents(scene);
    for (std::uint32_t id = 0; id < people; ++id) {
        p.agents.position[id] = {21 + 18 * drawn(4, id), 13 + 18 * drawn(5, id)};
        p.agents.momentary[id] = {drawn(6, id) - 0.5, drawn(7, id)};
        p.agents.mass[id] = 40 + 60 * drawn(8, id);
        p.agents.tau[id] = drawn(9, id);
        if (id % 7 == 3) continue;  // an agent that has arrived
        p.active.push_back(id);
        p.positions.push_back(p.agents.position[id]);
        p.walking.emplace_back(1.3 * drawn(10, id), 1.3 * drawn(11, id));
    }
    p.water = empty_bins(scene);
    bin_water(p.water, water.view(), p.positions);
    find_contacts(p);
    feel_water(make_feeling(scene), p.water, p.positions, 1, p.felt);
    return p;
}

NextVelocities answer(const Response& response, const People& p) {
    NextVelocities next;
    next.mean.assign(3, Vector2d(7, 7));  // of another step
    next.at_end.assign(5, Vector2d(7, 7));
    response.respond(p.frozen(), next);
    return next;
}

bool all_finite(const std::vector<Vector2d>& velocities) {
    return std::all_of(velocities.begin(), velocities.end(), [](const Vector2d& v) { return v.allFinite(); });
}

// The same people in another order.
People reversed(const People& p) {
    People other = p;
    std::reverse(other.active.begin(), other.active.end());
    std::reverse(other.positions.begin(), other.positions.end());
    std::reverse(other.walking.begin(), other.walking.end());
    std::reverse(other.contacts.begin(), other.contacts.end());
    std::reverse(other.felt.begin(), other.felt.end());
    return other;
}

// Takes the velocities of a step for the begin of the next one.
void go_on(People& p, const NextVelocities& next) {
    for (std::size_t k = 0; k < next.at_end.size(); ++k) p.agents.momentary[p.active[k]] = next.at_end[k];
}

// Whoever walks already at the walking velocity goes on so, to rounding; others come to it within ten seconds.
void check_walks_on(const Response& response, People p) {
    for (std::size_t k = 0; k < p.active.size(); ++k) p.agents.momentary[p.active[k]] = p.walking[k];
    const NextVelocities now = answer(response, p);
    for (std::size_t k = 0; k < p.active.size(); ++k) REQUIRE((now.mean[k] - p.walking[k]).norm() < 1e-12);
    for (const std::uint32_t id : p.active) p.agents.momentary[id] = {5, -5};
    const int steps = static_cast<int>(10 * p.scene.crowd->step_rate);
    for (int i = 0; i < steps; ++i) go_on(p, answer(response, p));
    const NextVelocities later = answer(response, p);
    for (std::size_t k = 0; k < p.active.size(); ++k) REQUIRE((later.mean[k] - p.walking[k]).norm() < 1e-6);
}

}  // namespace

std::vector<Scene> coupled_scenes() {
    Scene scene = one_agent_scene(25, 15, 75, 50, 0.5);
    scene.crowd->groups[0].count = scene.crowd->groups[0].columns = people;
    std::vector<Scene> scenes;
    for (const CouplingRule rule : {CouplingRule::per_frame, CouplingRule::continuous}) {
        for (const ContactRule contact : {ContactRule::difference, ContactRule::sum}) {
            for (const double sampling : {0.0, 240.0}) {
                scene.coupling->rule = rule;
                scene.coupling->contact_rule = contact;
                scene.coupling->sampling_rate = sampling;
                scene.crowd->response = ResponseKind::paper;
                scene.crowd->groups[0].tau = 0.5;
                scenes.push_back(scene);
                scene.crowd->response = ResponseKind::measured;
                scene.crowd->groups[0].tau.reset();
                scenes.push_back(scene);
            }
        }
    }
    return scenes;
}

std::string name_of(const Scene& scene) {
    const Coupling& coupling = scene.coupling;
    return std::string(coupling.rule == CouplingRule::continuous ? "continuous" : "per_frame") +
           (coupling.contact_rule == ContactRule::sum ? ", sum" : ", difference") + ", sampled at " +
           std::to_string(coupling.sampling_rate) + " Hz" + (scene.crowd->groups[0].tau ? "" : ", no tau");
}

void check_response(const RegisteredResponse& entry, const Scene& scene) {
    const std::unique_ptr<Response> response = make_response(entry.name, scene, {&entry, 1});
    const People p = people_in(scene, stream());
    REQUIRE(std::any_of(p.contacts.begin(), p.contacts.end(), [](const Contact& c) { return c.mass > 0; }));

    const NextVelocities next = answer(*response, p);
    REQUIRE(next.mean.size() == p.active.size());
    REQUIRE((next.at_end.empty() || next.at_end.size() == p.active.size()));
    CHECK(all_finite(next.mean));
    CHECK(all_finite(next.at_end));

    const NextVelocities again = answer(*make_response(entry.name, scene, {&entry, 1}), p);
    CHECK(again.mean == next.mean);
    CHECK(again.at_end == next.at_end);

    NextVelocities backwards = answer(*response, reversed(p));
    std::reverse(backwards.mean.begin(), backwards.mean.end());
    std::reverse(backwards.at_end.begin(), backwards.at_end.end());
    CHECK(backwards.mean == next.mean);
    CHECK(backwards.at_end == next.at_end);

    check_walks_on(*response, people_in(scene, MadeUpWater{}));
    if (scene.crowd->groups[0].tau) {
        People unmoved = p;
        std::fill(unmoved.agents.tau.begin(), unmoved.agents.tau.end(), 0.0);
        check_walks_on(*response, unmoved);
    }
    People yielding = p;
    std::fill(yielding.agents.tau.begin(), yielding.agents.tau.end(), 1.0);
    CHECK(answer(*response, yielding).mean != p.walking);
    const People nobody{scene, p.agents, p.water, {}, {}, {}, {}, {}};
    CHECK(answer(*response, nobody).mean.empty());
}

}  // namespace wade::crowd::testing
