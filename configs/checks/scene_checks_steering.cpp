// What the steering model of the water cannot do.

#include <algorithm>
#include <string>

#include "configs/checks/scene_checks.hpp"
#include "configs/scene/channel.hpp"
#include "configs/scene/fluid.hpp"
#include "configs/scene/interval.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene_capacity.hpp"
#include "configs/scene/steering.hpp"

namespace wade {

namespace {

// By how much lists of neighbours reach further than the neighbourhoods, in spacings.
constexpr double margin = 0.3;

struct Reach {
    double radius = 0;  // in spacings
    std::string pointer;
};

// The largest radius of a behaviour that has a weight.
Reach reach_of(const Steering& s) {
    double widest = 1;
    for (const SteeringClass& c : s.classes) widest = std::max(widest, c.radius);
    Reach reach{widest * s.separation.radius, "/fluid/steering/separation/radius"};
    const auto consider = [&](double weight, double radius, const char* pointer) {
        if (weight > 0 && radius > reach.radius) reach = {radius, pointer};
    };
    consider(s.cohesion.weight, s.cohesion.radius, "/fluid/steering/cohesion/radius");
    consider(s.alignment.weight, s.alignment.radius, "/fluid/steering/alignment/radius");
    consider(s.loss, s.loss_radius, "/fluid/steering/loss/radius");
    return reach;
}

void check_channel(const Scene& scene, const std::string& source) {
    const Channel& channel = scene.channel;
    const auto refuse_key = [&](bool is_set, const std::string& key, const std::string& instead) {
        if (!is_set) return;
        refuse(source, "/fluid/model",
               "\"steering\" does not know /channel/" + key + "; allowed: a scene without it, " + instead +
                   ", or the model \"dfsph\".");
    };
    refuse_key(!channel.no_slip.empty(), "no_slip", "with the friction of /fluid/steering/walls/loss");
    refuse_key(channel.manning_n != 0, "manning_n", "with the friction of /fluid/steering/walls/loss");
}

void check_neighbourhoods(const Scene& scene, const std::string& source) {
    const Reach reach = reach_of(scene.fluid->steering);
    const double d = scene.fluid->particle_spacing;
    const Channel& channel = scene.channel;
    const double waiting = support_radius_of(scene.fluid) / d;
    if (channel.flow == Flow::emitter && reach.radius > waiting * (1 + rounding_tolerance)) {
        refuse(source, reach.pointer,
               "neighbourhoods of " + short_number(reach.radius) +
                   " d reach behind the layers that wait in the emitter; allowed: <= " + short_number(waiting) +
                   " d, or the kernel \"wendland_c2\" for 3 d.");
    }
    // No particle may find a neighbour twice across a periodic boundary. Neighbourhoods are exact, so two radii
    // suffice.
    const double shortest = 2 * (reach.radius + margin) * d;
    const auto check = [&](bool periodic, double length, const char* pointer) {
        if (!periodic || length >= shortest * (1 - rounding_tolerance)) return;
        refuse(
            source, pointer,
            "the period of " + short_number(length) +
                " m is too short for steering particles, which would meet themselves across the joint; allowed: >= " +
                short_number(shortest) + " m.");
    };
    check(channel.flow == Flow::recirculating || channel.flow == Flow::periodic, channel.x.length(),
          "/channel/x_max_m");
    check(channel.sides == Sides::periodic, channel.z.length(), "/channel/z_max_m");
    check(channel.top == Top::periodic, channel.height, "/channel/height_m");
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
        const double thickness = std::min(scene.obstacles[i].x.length(), scene.obstacles[i].z.length());
        if (thickness >= reach.radius * d * (1 - rounding_tolerance)) continue;
        refuse(source, "/obstacles/" + std::to_string(i),
               short_number(thickness) + " m thick: steering particles feel one another through it; allowed: >= " +
                   short_number(reach.radius * d) + " m.");
    }
}

void check_classes(const Steering& s, const std::string& source) {
    double sum = 0;
    for (const SteeringClass& c : s.classes) sum += c.share;
    if (sum > 1 + rounding_tolerance) {
        refuse(source, "/fluid/steering/classes",
               "the shares sum up to " + short_number(sum) + "; allowed: <= 1, the rest are usual particles.");
    }
}

void check_bodies(const Scene& scene, const std::string& source) {
    for (std::size_t i = 0; i < scene.fluid->steering.bodies.size(); ++i) {
        const SteeringBody& body = scene.fluid->steering.bodies[i];
        const std::string pointer = "/fluid/steering/bodies/" + std::to_string(i);
        const double r = body.radius;
        if (r < scene.fluid->particle_spacing) {
            refuse(source, pointer + "/radius_m",
                   short_number(r) + " m would slip between the particles; allowed: >= fluid.particle_spacing_m = " +
                       short_number(scene.fluid->particle_spacing) + " m.");
        }
        const auto check = [&](double at, const Interval& range, const char* key) {
            const double lo = range.lo + r, hi = range.hi - r;
            if (at >= lo - rounding_tolerance && at <= hi + rounding_tolerance) return;
            refuse(source, pointer + key,
                   short_number(at) + " m: the sphere starts outside the channel; allowed: " + short_number(lo) +
                       " to " + short_number(hi) + " m.");
        };
        check(body.place[0], scene.channel->x, "/x_m");
        check(body.place[2], scene.channel->z, "/z_m");
        check(body.place[1], {0, scene.channel->top == Top::open ? 1e5 : scene.channel->height}, "/y_m");
        for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
            const Obstacle& o = scene.obstacles[k];
            if (body.place[0] > o.x.lo - r && body.place[0] < o.x.hi + r && body.place[2] > o.z.lo - r &&
                body.place[2] < o.z.hi + r && body.place[1] < o.height + r) {
                refuse(source, pointer,
                       "the sphere starts in /obstacles/" + std::to_string(k) + "; allowed: clear of it.");
            }
        }
    }
}

}  // namespace

void check_steering(const Scene& scene, const std::string& source) {
    if (scene.fluid->model != ModelKind::steering) return;
    check_channel(scene, source);
    check_neighbourhoods(scene, source);
    check_classes(scene.fluid->steering, source);
    check_bodies(scene, source);
}

}  // namespace wade
