#pragma once
// The scene: all that describes a run, as typed plain data in SI units.
//
// x runs along the stream's axis, z across it, y is up; the bed is the plane y = 0. The stream flows towards -x.
// What a member holds in a new struct is the default of its key; names, units, ranges and meanings of the keys stand in
// fields/. A Scene is what remains once a file was read, merged with those that it extends and checked.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "configs/numbers/normal.hpp"
#include "configs/scene/fields/people.hpp"
#include "configs/scene/fields/place_keys.hpp"
#include "configs/scene/place.hpp"

namespace wade {

struct Interval {
    double lo = 0;
    double hi = 0;
    [[nodiscard]] double length() const { return hi - lo; }
    [[nodiscard]] bool contains(double v) const { return lo <= v && v <= hi; }
};

enum class Ends {
    open,     // the world ends at x = 0, the fall, and at x = length
    periodic  // x = length is x = 0 again
};

// Walkable ground, [0, length] x [0, width].
struct World {
    double length = 100;
    double width = 50;
    double gravity = 9.81;
    Ends ends = Ends::open;

    // Length after which the world repeats along x, m; 0 where it does not.
    [[nodiscard]] double period() const { return ends == Ends::periodic ? length : 0; }
};

enum class Flow {
    emitter,        // an emitter at x.hi feeds the channel, particles that pass x.lo return to its stock
    recirculating,  // periodic along x, the bulk speed held at `velocity`
    periodic,       // periodic along x, driven by slope and held up by friction
    closed          // walls at both ends
};
enum class Sides { walls, periodic };
enum class Top { open, wall, periodic };
enum class InitialRiver { dry, filled };

// A block of water at t = 0.
struct WaterBlock {
    Interval x, z;
    double depth = 0;
    double y_min = 0;  // 0: stands on the bed
    std::array<double, 3> velocity{};
};

// A point of the bed's height along x.
struct BedPoint {
    double x = 0;
    double y = 0;
};

enum class Plane { bed, top, x_min, x_max, z_min, z_max, obstacles };

// A plane at which viscous water takes the plane's velocity.
struct NoSlip {
    Plane plane = Plane::bed;
    std::array<double, 3> velocity{};
};

// A point of v_F in time.
struct VelocityPoint {
    double time = 0;
    double velocity = 0;
};

// The channel that confines the water: bed y = 0 unless bed_points raise it, banks at z.lo and z.hi.
struct Channel {
    Interval x, z;
    Flow flow = Flow::emitter;
    Sides sides = Sides::walls;
    Top top = Top::open;
    double height = 1;                 // y of the top, unless it is open
    std::vector<BedPoint> bed_points;  // ascending x
    double slope = 0;                  // fall of the bed towards -x
    double manning_n = 0;              // of the bed, s/m^(1/3)
    std::vector<NoSlip> no_slip;
    double depth = 1;                             // depth of the emitter's opening and of a filled river
    double velocity = 0;                          // v_F of the paper: emitter velocity or bulk speed, along -x
    std::vector<VelocityPoint> velocity_history;  // v_F in time; empty: `velocity` throughout
    InitialRiver initial_river = InitialRiver::dry;
    std::vector<WaterBlock> water_blocks;
};

// A solid box that stands on the bed, for the water and for the crowd.
struct Obstacle {
    Interval x, z;
    double height = 1;
};

enum class ModelKind {
    dfsph,
    kinematic,
    shallow_water,
    steering,
    mixed,
    automatic  // one of the others, by max_impulse_error
};

enum class VelocityProfile { uniform, logarithmic };
enum class Arrangement { random, lattice };

// The kinematic model: nothing is solved, depth and velocity are given.
struct Kinematic {
    VelocityProfile profile = VelocityProfile::uniform;
    double roughness_length = 0.005;  // z_0 of the logarithmic profile
    double transport_factor = 1;      // particles and front move at this factor times their velocity
    Arrangement arrangement = Arrangement::random;
    double jitter = 0;  // of a lattice: width of the deviation from its points, in cells, [0, 1]
};

// The shallow-water model: depth and depth-averaged velocity on a grid.
struct ShallowWaterGrid {
    double cell_size = 0.5;  // m
};

// The mixed model: particles in a window of the channel, shallow water elsewhere.
struct MixedWindow {
    std::optional<double> x_min, x_max;  // m, where there are particles all the time
    std::optional<double> margin;        // m, round agents and obstacles; 3 depths of the water if not given
    double chunk = 4;                    // m, by which the window moves
    bool obstacles = false;              // whether there are particles round them all the time
};

// One behaviour of a flock: whom it looks at, and how strong it is.
struct FlockBehaviour {
    double radius = 0;   // of the neighbourhood, in spacings d
    double angle = 180;  // between the velocity and the way to a neighbour, degrees; 180: all round
    double weight = 0;   // see the key for the unit
};

enum class CohesionForm { equal, growing };  // each neighbour pulls alike, or with the square of its distance
enum class LossForm { relative, absolute };
enum class SteeringWalls { force, constraint, both };

// Particles that differ from the others: a liquid of a density of its own.
struct SteeringClass {
    double share = 0;   // of all particles
    double radius = 1;  // of separation, over that of the others
    double mass = 1;    // over that of the others
};

// A sphere that falls into the water.
struct SteeringBody {
    std::array<double, 3> place{};  // of its centre at `time`, m
    std::array<double, 3> velocity{};
    double time = 0;  // when it appears, s
    double radius = 0.1;
    double density = 1000;
};

// The steering model: each particle is a vehicle of Reynolds that steers by its neighbours.
struct Steering {
    FlockBehaviour separation{1.12, 180, 4}, alignment{2, 180, 0}, cohesion{2, 180, 0};
    CohesionForm cohesion_form = CohesionForm::equal;
    bool only_where_needed = true;
    double loss = 0.1;         // near neighbours
    double loss_radius = 1.5;  // in spacings
    LossForm loss_form = LossForm::relative;
    SteeringWalls walls = SteeringWalls::both;
    double wall_radius = 0.6;  // in spacings
    double wall_weight = 4;
    double wall_loss = 0.02;
    double max_force = 20;
    double max_speed = 4;
    std::vector<SteeringClass> classes;
    std::vector<SteeringBody> bodies;
};

enum class KernelKind {
    cubic_spline,
    quartic_spline,
    wendland_c2,
    automatic  // one of the others, see kernel_choice.hpp; no scene that is loaded has it
};

struct PressureSolve {
    double tolerance = 0;  // mean error that ends the iteration, see the key for what it is relative to
    int min_iterations = 0;
    int max_iterations = 0;
};

enum class Publish { all, near_agents };  // which columns of shallow water a frame holds

struct Fluid {
    ModelKind model = ModelKind::dfsph;
    double max_impulse_error = 0;  // of `automatic`, relative; else 0
    Kinematic kinematic;
    ShallowWaterGrid shallow_water;
    MixedWindow mixed;
    Steering steering;
    double particle_spacing = 0.4642;  // d; particle mass = rest_density * d^3
    KernelKind kernel = KernelKind::cubic_spline;
    double support_in_spacings = 2;  // of the cubic spline: h / d
    double rest_density = 1000;
    double kinematic_viscosity = 0.01;
    int max_particles = 100000;
    Publish publish = Publish::all;
    double cfl = 0.5;  // time step <= cfl * d / (largest speed + sqrt(g * depth))
    PressureSolve density_solve{5e-4, 2, 100};
    PressureSolve divergence_solve{1e-3, 1, 100};  // max_iterations = 0 switches it off
};

enum class SpeedRule { pi, per_frame, per_second };
enum class MarkerRule { fixed, redrawn };
enum class BodyRule { none, fast, human };
enum class NavigationRule {
    automatic,  // travel_time for the goals of whom an obstacle stands in the way
    straight,
    travel_time
};

// A rope that people hold on to: between two places, or fixed at one, its free end down the stream.
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

// How agents find the way to their goal.
struct NavigationSettings {
    NavigationRule rule = NavigationRule::automatic;
    double cell = 0.5;    // of the fields, m
    double crowding = 0;  // weight of people in the way
    double every = 1;     // time after which fields with crowding, or in a place, are solved again, s; 0: never
    SlopeRule slope = SlopeRule::level;
    double sight = 20;                   // how far who is not warned sees water, m
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

enum class ResponseKind { paper, measured };     // people answer the water by a given tau, or by their bodies
enum class WalkingLaw { relative, bernardini };  // speed in water: by that on dry ground, or by age

struct Crowd {
    ResponseKind response = ResponseKind::paper;
    WalkingLaw walking_in_water = WalkingLaw::relative;
    bool fatigue = false;                     // legs and hands tire
    std::optional<double> water_temperature;  // C; none: it is not cold
    bool helping = false;                     // who stands takes hold of whom the water carries past
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

enum class ContactRule { difference, sum };
enum class CouplingRule {
    per_frame,  // Eq. 9 in each step
    continuous  // agents tend to the velocity of Eq. 9, in continuous time
};
enum class AgentsStream { off, serial, parallel };  // the way back, coupling lag 0 or 1

enum class Shelter { off, wake };  // of people behind people; a wake finer than the water shows

struct Coupling {
    ContactRule contact_rule = ContactRule::difference;
    CouplingRule rule = CouplingRule::per_frame;
    double sampling_rate = 0;   // of the water by the rule `continuous`, 1/s; up to the crowd's step rate: once a step
    double agent_radius = 0.5;  // r_a
    double particle_radius = 0.25;  // r_p
    AgentsStream agents_stream = AgentsStream::off;
    bool two_way = false;  // the water loses the momentum that people get
    Shelter shelter = Shelter::off;
};

// Sets tau of one agent, of a group or, if neither is named, of all agents from a frame on.
struct TauEvent {
    std::uint64_t frame = 0;
    std::optional<int> agent;
    std::optional<std::string> group;
    double tau = 0;
};

struct Scene {
    // In one source, as they are long and most sources would have them.
    Scene();
    Scene(const Scene& other);
    Scene(Scene&& other) noexcept;
    Scene& operator=(const Scene& other);
    Scene& operator=(Scene&& other) noexcept;
    ~Scene();

    std::string name;
    std::string description;
    std::uint64_t seed = 1;
    double duration = 400;
    double frame_rate = 30;
    bool stop_when_no_agent_is_active = true;
    int lockstep_depth = 2;  // frames the fluid may be ahead of the crowd, 1 to 3
    World world;
    Channel channel;                      // of a scene with a place: closed, of the world's size, and nothing else
    std::optional<PlaceKeys> place_keys;  // as the file says it
    std::optional<Place> place;           // the same with what its files hold, instead of the channel
    std::vector<Obstacle> obstacles;
    Fluid fluid;
    Crowd crowd;
    Coupling coupling;
    std::vector<TauEvent> events;

    std::uint64_t hash = 0;  // of the resolved scene, the same on both sides of a run
};

}  // namespace wade
