#pragma once
// Settings of the crowd: how people walk, choose routes and respond to the water.

#include <optional>
#include <vector>

#include "configs/scene/fields/people.hpp"

namespace wade {

enum class SpeedRule { pi, per_frame, per_second };
enum class MarkerRule { fixed, redrawn };
enum class BodyRule { none, fast, human };
enum class NavigationRule {
    automatic,  // travel_time for a goal once an obstacle stands between it and an agent
    straight,
    travel_time
};

// A rope that people hold: between two points, or fixed at one with its free end downstream.
struct Rope {
    double from_x = 0, from_z = 0;      // m
    std::optional<double> to_x, to_z;   // m
    std::optional<double> free_length;  // m
};

enum class RagdollCondition { off, paper, local_speed, depth_speed };

// When the water tumbles an animator's character, see the keys.
struct RagdollRule {
    RagdollCondition condition = RagdollCondition::off;
    double tau_min = 0.8;
    double speed = 2;           // m/s, to be exceeded
    double depth_speed = 0.75;  // m2/s, to be reached
    bool random_sign = false;
};

// What is written of the paths.
struct PathSettings {
    double rate = 4;  // frames in a second, at most; no more than steps
};

enum class SlopeRule { level, tobler };  // whether slopes change how fast people walk

// How agents find routes to their goals.
struct NavigationSettings {
    NavigationRule rule = NavigationRule::automatic;
    double cell = 0.5;    // of the fields, m
    double crowding = 0;  // factor on the density of people in travel times
    double every = 1;     // time after which fields with crowding, or in a site, are solved again, s; 0: never
    SlopeRule slope = SlopeRule::level;
    double sight = 20;                   // how far people without a warning see water, m
    std::optional<double> enters_up_to;  // deepest water that people walk into, m; none: by their stability alone
    std::optional<double> safe_above;    // height of ground that is as good as a shelter, m; none: no ground is
};

enum class EvasionRule { off, flee, evasion };  // from where the water is, or will be

// How agents keep away from water that comes.
struct EvasionSettings {
    EvasionRule rule = EvasionRule::off;
    double radius = 2;      // within which they see water, m
    double prediction = 1;  // longest time ahead, s
};

// Hazard of drowning of people adrift, 1/s: an estimate and its limits. `best` acts, the limits are for reports.
struct DriftHazard {
    double low = 0.002, best = 0.006, high = 0.02;
    bool is_under = false;  // instead of a hazard: a drifting mouth counts as under water, a swimmer's never
};

enum class ResponseKind { paper, measured };     // people respond to the water by a given tau, or by their bodies
enum class WalkingLaw { relative, bernardini };  // speed in water: by that on dry ground, or by age

struct Crowd {
    ResponseKind response = ResponseKind::paper;
    WalkingLaw walking_in_water = WalkingLaw::relative;
    bool fatigue = false;                     // legs and hands tire
    std::optional<double> water_temperature;  // C; none: it is not cold
    DriftHazard drift_hazard;
    double air_budget = 60;  // time that a mouth can be under water, s
    bool helping = false;    // standing people hold people who drift past
    std::vector<Rope> ropes;
    SpeedRule speed_rule = SpeedRule::pi;
    double step_rate = 30;      // steps of the crowd in a second
    int markers_per_cell = 64;  // in a cell of 2 x 2 m
    double marker_min_distance = 0.1;
    MarkerRule markers = MarkerRule::fixed;
    double marker_epoch = 0;  // time after which markers are redrawn, s; 0: in each step
    BodyRule bodies = BodyRule::none;
    double body_radius = 0.25;
    NavigationSettings navigation;
    EvasionSettings evasion;
    double perception_radius = 1.0;  // R, markers within it are perceived
    double goal_radius = 3.0;        // an agent within it has arrived
    RagdollRule ragdoll;
    PathSettings paths;
    double pose_rate = 0;           // frames of poses.csv in a second, 0: there is none
    std::vector<PersonRow> people;  // of groups without a table: the agent of a number is the person of this number
    std::vector<AgentGroup> groups;
};

}  // namespace wade
