#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "fluid_server/particles/make_channel_ends.hpp"
#include "scenes.hpp"

using namespace wade;
using namespace wade::fluid;

namespace {

// Two particles at 3 m/s and 1 m/s towards -x.
Particles two_particles() {
    Particles p(500);
    p.add({1, 0.5F, 0.5F}, {-3, 0, 0}, Kind::fluid);
    p.add({2, 0.5F, 0.5F}, {-1, 0, 0}, Kind::fluid);
    return p;
}

}  // namespace

TEST_CASE("nothing happens at the ends of closed and periodic channels", "[fluid][ends]") {
    Scene scene = test::tank(4, 2, 1, 0.25);
    scene.channel.flow = GENERATE(Flow::closed, Flow::periodic);
    Particles p = two_particles();
    const auto ends = make_channel_ends(scene, p);
    ends->begin_step(p, 0, 0.1);
    ends->take_out(1);
    ends->end_step(p, {}, 0.1);
    CHECK(p.count == 2);
    CHECK(p.vx[0] == -3);
    CHECK_FALSE(ends->driving_acceleration(p, 0.1, 0.1));
    CHECK_FALSE(ends->state());
    CHECK_FALSE(ends->carry_inflow());
    CHECK(p.x[0] > ends->outflow_x());
}

TEST_CASE("a recirculating channel is driven to its velocity within the step", "[fluid][ends]") {
    Scene scene = test::tank(4, 2, 1, 0.25);
    scene.channel.flow = Flow::recirculating;
    scene.channel.velocity = 2.5;
    const Particles p = two_particles();
    Particles filled = p;
    const auto ends = make_channel_ends(scene, filled);
    // The mean, 2 m/s, lacks 0.5 m/s towards -x in 0.1 s.
    CHECK(ends->driving_acceleration(p, 0.1, 0.1).value() == Approx(5));
    CHECK_FALSE(ends->state());
}

TEST_CASE("an emitter waits behind its opening and takes back what left", "[fluid][ends]") {
    const Scene scene = test::emitter_channel(1.5, 9.81, 400);
    Particles p(400);
    const auto ends = make_channel_ends(scene, p);
    REQUIRE(p.count > 0);
    REQUIRE(ends->state());
    CHECK(p.count + ends->state()->stock == 400);
    CHECK(p.kind[0] == Kind::inflow);
    CHECK(ends->outflow_x() == 0);
    CHECK(ends->opening_x() == 10);
    ends->take_out(7);
    CHECK(ends->state()->recycled == 7);
    EmitterState earlier = *ends->state();
    earlier.stock = 11;
    ends->restore(earlier, p, 0);
    CHECK(ends->state()->stock == 11);
}

TEST_CASE("water from inside does not pass an opening, and passes where there is none", "[fluid][ends]") {
    CHECK(held_by_opening(10, 9, 50, 0.1F) == Approx(10));  // 1 m in 0.1 s
    CHECK(held_by_opening(10, 9, 5, 0.1F) == 5);
    CHECK(held_by_opening(10, 11, 5, 0.1F) == 0);
    CHECK(held_by_opening(10, 11, -5, 0.1F) == -5);
    const float none = std::numeric_limits<float>::infinity();
    CHECK(held_by_opening(none, 9, 50, 0.1F) == 50);
    CHECK(std::isnan(held_by_opening(none, 9, std::nanf(""), 0.1F)));  // found by the checks of the step
}
