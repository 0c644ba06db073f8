// What the water does to people.

#include <numbers>

#include "cases.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water/water_bins.hpp"
#include "impulse.hpp"

namespace wade::validation {
namespace {

// rho pi r^2 h v_F T towards -x: what a stream of uniform speed brings into the contact distance r of an agent.
crowd::Vector2d uniform_stream(const Scene& scene) {
    const double r = crowd::contact_distance(scene.coupling);
    const double mass = scene.fluid->rest_density * std::numbers::pi * r * r * scene.channel->depth;
    return {-mass * scene.channel->velocity * scene.duration, 0};
}

Result run_impulse_river(const Request& request) {
    const std::string name = "impulse_river";
    const Scene scene = scene_for(request, "validation/" + name + ".json");
    const ImpulseRun reference = read_reference(request, name);
    Result result;
    const ImpulseRun people = run_impulse(scene, result);
    compare_impulse(people, reference, result);
    compare_with_uniform_stream(people, uniform_stream(scene), result);
    return result;
}

Case impulse_case(const std::string& name, const std::string& truth, Result (*run)(const Request&)) {
    Case c;
    c.name = name;
    c.truth = "our own finest run (tests/validation/data/" + name + "_*.csv): " + truth;
    c.reference = "finest run";
    c.spacings = {0.4642, 0.2321, 0.1161};
    c.quick = true;
    c.run = run;
    return c;
}

}  // namespace

Case impulse_river_case() {
    return impulse_case("impulse_river",
                        "16 people stand and 12 walk in a recirculating river of 12 m x 6 m, 1 m deep, 1.5 m/s; and "
                        "rho pi r^2 h v T of a uniform stream.",
                        run_impulse_river);
}

// The front of a dam break on standing and walking people.
Case impulse_front_case() {
    return impulse_case(
        "impulse_front",
        "the front of a dam break, 1 m of water 5 m long, meets 16 people who stand and 9 who walk on a "
        "dry bed.",
        [](const Request& request) { return run_impulse_case(request, "impulse_front"); });
}

// People in the lee of a block that stands in a stream.
Case impulse_lee_case() {
    return impulse_case("impulse_lee",
                        "a block of 1.2 m x 1.2 m in a stream of 1 m/s, 9 people stand in its lee, 6 beside it, 8 walk "
                        "through the lee.",
                        [](const Request& request) { return run_impulse_case(request, "impulse_lee"); });
}

}  // namespace wade::validation
