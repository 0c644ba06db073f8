#include "crowd_client/people/pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wade::crowd {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double felt_time = 0.3;  // low-pass of the sampled flow, s
constexpr double begins_at = 0.5, ends_at = 0.2;
constexpr double least_wish = 0.1;         // smaller velocities of the legs count as 0, m/s
constexpr double walk_ratio = 0.24;        // s / (n H) with n in 1/s: 0.004 * 60
constexpr double most_steps = 182.0 / 60;  // 1/s, walking (Inman et al. 1981)
constexpr double foot_share = 0.04,
                 centre_share = 0.55;  // of H: lever arm of the feet without a lean, height of the centre of mass

// Hip heights while getting up, of H; kneeling with a knee at 0.285 H and a thigh of 0.245 H [A].
constexpr double sitting_hip = 0.06, kneeling_hip = 0.27, squatting_hip = 0.3;
constexpr double chin_to_hip = 0.87 - hip_share;
constexpr double swimming_hip = 0.15, swimming_lean = 1.2;  // m below the surface, rad [A]

Vector2d direction(double angle) {
    return {std::cos(angle), std::sin(angle)};
}

double angle_of(const Vector2d& v) {
    return std::atan2(v.y(), v.x());
}

Vector2d rotated(const Vector2d& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

// Returns the lean of a standing person against a stream, rad.
double lean_against(const Pose& pose, const People& people, std::size_t id, const PoseStep& step) {
    const double height = people.height[id], wet = std::min(pose.depth, height);
    const double k = drag_upright(height, pose.depth, step.water, people.drag[id]);
    const double weight = weight_on_feet({height, step.mass}, pose.depth, step.water);
    const Vector2d past = mean_stream(pose) - pose.velocity.value;
    const double topple = topple_demand(k, past, wet, weight, people.arm[id]);
    const double arm = std::min(1.0, topple) * people.arm[id] / height;
    return std::asin(std::clamp((arm - foot_share) / centre_share, 0.0, 1.0));
}

Vector2d lean_aim(const Pose& pose, const People& people, std::size_t id, const PoseStep& step) {
    const Vector2d ahead = direction(pose.heading.value);
    switch (pose.posture) {
        case Posture::upright:
            return -lean_against(pose, people, id, step) * unit_or(mean_stream(pose), Vector2d::Zero());
        case Posture::falling:
        case Posture::lying:
            return 0.5 * pi * direction(pose.fallen);
        case Posture::swimming:
            return swimming_lean * ahead;
        case Posture::kneeling:
        case Posture::rising:
            return 0.2 * ahead;
        case Posture::squatting:
            return 0.5 * ahead;
        case Posture::floating:
        case Posture::sitting:
            break;
    }
    return Vector2d::Zero();
}

double hip_aim(const Pose& pose, double height, const Vector2d& lean) {
    switch (pose.posture) {
        case Posture::upright:
            return hip_share * height * std::cos(std::sqrt(lean.squaredNorm()));
        case Posture::falling:
        case Posture::lying:
            return std::max(pose.depth, body_thickness) - 0.5 * body_thickness;
        case Posture::floating:
            return pose.depth - chin_to_hip * height;
        case Posture::swimming:
            return pose.depth - swimming_hip;
        case Posture::sitting:
            return sitting_hip * height;
        case Posture::kneeling:
            return kneeling_hip * height;
        case Posture::squatting:
            return squatting_hip * height;
        case Posture::rising:
            break;
    }
    return hip_share * height;
}

Vector3d turning_aim(const Pose& pose, const PoseStep& step) {
    if (has_ground(pose.posture)) return Vector3d::Zero();
    Vector3d aim(0, step.spin, 0);
    if (pose.posture == Posture::falling || pose.posture == Posture::lying) {
        const double per_depth = 1 / std::max(pose.depth, body_thickness);
        const Vector2d stream = mean_stream(pose);
        aim.x() = 0.5 * stream.y() * per_depth;
        aim.z() = -0.5 * stream.x() * per_depth;
    }
    return aim.cwiseMax(-fastest_tumbling).cwiseMin(fastest_tumbling);
}

// Returns the turn that the heading still has to make, rad, limited so that its rate is at most fastest_turn.
double turn_wanted(const Pose& pose) {
    if (!has_ground(pose.posture) || pose.wish.value.squaredNorm() < least_wish * least_wish) return 0;
    const double turn = std::remainder(angle_of(pose.wish.value) - pose.heading.value, 2 * pi);
    const double most = 2 * fastest_turn / body_pace;
    return std::clamp(turn, -most, most);
}

void feel_water(Pose& pose, const PoseStep& step) {
    const double share = -std::expm1(-step.dt / felt_time);
    pose.depth += (step.depth - pose.depth) * share;
    pose.flow += (step.depth * step.stream - pose.flow) * share;
}

void take_posture(Pose& pose, Posture posture) {
    const auto is_down = [](Posture p) { return p == Posture::falling || p == Posture::lying; };
    if (is_down(posture) && !is_down(pose.posture)) {
        pose.fallen = angle_of(unit_or(mean_stream(pose), direction(pose.heading.value)));
    }
    pose.posture = posture;
}

// Turns the body with the water; a turn about y moves z towards x.
void turn_with_water(Pose& pose, double dt) {
    const double angle = -pose.turning.value.y() * dt;
    pose.heading.value += angle;
    pose.fallen += angle;
    pose.lean = {rotated(pose.lean.value, angle), rotated(pose.lean.rate, angle)};
}

void walk_on(Pose& pose, double height, const Vector2d& velocity, double dt) {
    const double forward = std::max(0.0, velocity.dot(direction(pose.heading.value)));
    const bool walks = pose.posture == Posture::upright;
    follow(pose.step_length, walks ? step_length_at(forward, height) : 0.0, body_pace, dt);
    const double strides = pose.gait_phase + 0.5 * dt * cadence_of(pose.step_length.value, height);
    pose.gait_phase = strides - std::floor(strides);
}

}  // namespace

void note(LastingCondition& lasting, bool holds_now, double dt) {
    lasting.share += ((holds_now ? 1 : 0) - lasting.share) * -std::expm1(-dt / felt_time);
    lasting.holds = lasting.share >= (lasting.holds ? ends_at : begins_at);
}

Pose standing_pose(const People& people, std::size_t id, const Vector2d& heading) {
    Pose pose;
    pose.heading.value = angle_of(heading);
    pose.hip.value = hip_share * people.height[id];
    return pose;
}

Posture posture_of(const People& people, std::size_t id, bool swept) {
    if (people.by_body[id] == 0) return swept ? Posture::lying : Posture::upright;
    constexpr std::array rises{Posture::sitting, Posture::kneeling, Posture::squatting, Posture::rising};
    const Condition& condition = people.condition[id];
    switch (condition.state) {
        case PersonState::walking:
        case PersonState::effort:
        case PersonState::sliding:
            return Posture::upright;
        case PersonState::toppled:
            return Posture::falling;
        case PersonState::afloat:
            return people.can_swim[id] != 0 ? Posture::swimming : Posture::floating;
        case PersonState::recovering:
            return rises[static_cast<std::size_t>(posture_of(condition))];
        case PersonState::carried:
        case PersonState::holding:
        case PersonState::pinned:
        case PersonState::drowned:
            break;
    }
    return Posture::lying;
}

bool has_ground(Posture posture) {
    return posture != Posture::falling && posture != Posture::lying && posture != Posture::floating &&
           posture != Posture::swimming;
}

Vector2d mean_stream(const Pose& pose) {
    constexpr double dry = 1e-6;  // m
    return pose.depth > dry ? Vector2d(pose.flow / pose.depth) : Vector2d(0, 0);
}

double step_length_at(double speed, double height) {
    return std::min(std::sqrt(walk_ratio * height * speed), walk_ratio * height * most_steps);
}

double cadence_of(double step_length, double height) {
    return step_length / (walk_ratio * height);
}

void advance_pose(Pose& pose, const People& people, std::size_t id, Posture posture, const PoseStep& step) {
    const double dt = step.dt, height = people.height[id];
    feel_water(pose, step);
    take_posture(pose, posture);
    follow(pose.velocity, step.velocity, speed_pace, dt);
    follow(pose.wish, step.wanted, speed_pace, dt);
    follow(pose.heading, pose.heading.value + turn_wanted(pose), body_pace, dt);
    follow(pose.turning, turning_aim(pose, step), body_pace, dt);
    turn_with_water(pose, dt);
    const Vector2d lean = lean_aim(pose, people, id, step);
    follow(pose.lean, lean, body_pace, dt);
    follow(pose.hip, hip_aim(pose, height, lean), body_pace, dt);
    walk_on(pose, height, step.velocity, dt);
}

}  // namespace wade::crowd
