#include "crowd_client/people/resting.hpp"

#include <algorithm>

namespace wade::crowd {
namespace {

constexpr double clothes = 0.45;  // friction of clothes on the ground [A]

// A part of the body's volume that lies between two heights, of H.
struct Part {
    double share, from, to;
};
struct Shape {
    std::array<Part, 3> parts;
    double top, width, arm;  // of H
    bool on_clothes;
};
constexpr std::array<Shape, rests - 1> shapes{
    Shape{{Part{0.678, 0, 0.52}, {0.200, 0, 0.10}, {0.122, 0, 0.08}}, 0.52, 0.21, 0.25, true},
    Shape{{Part{0.678, 0.24, 0.75}, {0.200, 0.03, 0.27}, {0.122, 0, 0.08}}, 0.75, 0.16, 0.15, true},
    Shape{{Part{0.678, 0.12, 0.62}, {0.200, 0.08, 0.30}, {0.122, 0, 0.27}}, 0.62, 0.18, 0.08, false}};

double submerged_share(const Shape& shape, double x) {
    double share = 0;
    for (const Part& part : shape.parts)
        share += part.share * std::clamp((x - part.from) / (part.to - part.from), 0.0, 1.0);
    return share;
}

}  // namespace

Stance stance_of(Rest posture, const Body& body, double friction, double arm, double depth,
                 const WaterProperties& water, double drag) {
    const double height = body.height;
    if (posture == Rest::stands) {
        return {drag_upright(height, depth, water, drag), std::min(depth, height), weight_on_feet(body, depth, water),
                friction, arm};
    }
    const Shape& shape = shapes[static_cast<std::size_t>(posture)];
    Stance stance;
    stance.wet = std::clamp(depth, 0.0, shape.top * height);
    stance.k = 0.5 * water.density * drag * shape.width * height * stance.wet;
    const double carried = submerged_share(shape, depth / height) * water.density / body_density;
    stance.weight = body.mass * water.gravity * std::max(0.0, 1 - carried);
    stance.friction = shape.on_clothes ? std::min(friction, clothes) : friction;
    stance.arm = shape.arm * height;
    return stance;
}

double demand_at_rest(const Stance& stance, double depth, const Vector2d& stream) {
    constexpr double gets_up = 0.8, shallow = 0.16;  // of v_most; m
    const double rush = rush_demand(std::min(depth, shallow), stream) / (gets_up * gets_up);
    return std::max(rush, std::max(slip_demand(stance.k, stream, Vector2d::Zero(), stance.friction, stance.weight),
                                   topple_demand(stance.k, stream, stance.wet, stance.weight, stance.arm)));
}

}  // namespace wade::crowd
