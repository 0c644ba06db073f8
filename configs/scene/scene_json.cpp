#include "configs/scene/scene_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/scene_schema.hpp"

namespace wade {

namespace {

using nlohmann::json;

template <typename Choice>
Choice choice_of(const json& value) {
    if (const auto choice = choice_named<Choice>(value.get<std::string>())) return *choice;
    throw std::logic_error("the schema allows a choice that the scene does not know: " + value.dump());
}

Interval interval(const json& box, const char* lo, const char* hi) {
    return {box.at(lo), box.at(hi)};
}
Interval x_of(const json& box) {
    return interval(box, "x_min_m", "x_max_m");
}
Interval z_of(const json& box) {
    return interval(box, "z_min_m", "z_max_m");
}

std::array<double, 3> velocity_of(const json& j) {
    return {j.at("velocity_x_m_s"), j.at("velocity_y_m_s"), j.at("velocity_z_m_s")};
}

Channel channel_from(const json& j) {
    Channel channel;
    channel.x = x_of(j);
    channel.z = z_of(j);
    channel.flow = choice_of<Flow>(j.at("flow"));
    channel.sides = choice_of<Sides>(j.at("sides"));
    channel.top = choice_of<Top>(j.at("top"));
    channel.height = j.at("height_m");
    for (const json& point : j.at("bed_points")) channel.bed_points.push_back({point.at("x_m"), point.at("y_m")});
    channel.slope = j.at("slope");
    channel.manning_n = j.at("manning_n");
    for (const json& wall : j.at("no_slip")) {
        channel.no_slip.push_back({choice_of<Plane>(wall.at("plane")), velocity_of(wall)});
    }
    channel.depth = j.at("depth_m");
    channel.velocity = j.at("velocity_m_s");
    for (const json& point : j.at("velocity_history")) {
        channel.velocity_history.push_back({point.at("time_s"), point.at("velocity_m_s")});
    }
    channel.initial_river = choice_of<InitialRiver>(j.at("initial_river"));
    for (const json& block : j.at("water_blocks")) {
        channel.water_blocks.push_back(
            {x_of(block), z_of(block), block.at("depth_m"), block.at("y_min_m"), velocity_of(block)});
    }
    return channel;
}

PressureSolve solve_from(const json& j) {
    return {j.at("tolerance"), j.at("min_iterations"), j.at("max_iterations")};
}

Kinematic kinematic_from(const json& j) {
    return {choice_of<VelocityProfile>(j.at("profile")), j.at("roughness_length_m"), j.at("transport_factor"),
            choice_of<Arrangement>(j.at("arrangement")), j.at("jitter")};
}

FlockBehaviour behaviour_from(const json& j) {
    return {j.at("radius"), j.at("angle_deg"), j.at("weight")};
}

Steering steering_from(const json& j) {
    Steering s;
    s.separation = behaviour_from(j.at("separation"));
    s.alignment = behaviour_from(j.at("alignment"));
    s.cohesion = behaviour_from(j.at("cohesion"));
    s.cohesion_form = choice_of<CohesionForm>(j.at("cohesion").at("form"));
    s.only_where_needed = j.at("only_where_needed");
    s.loss = j.at("loss").at("weight");
    s.loss_radius = j.at("loss").at("radius");
    s.loss_form = choice_of<LossForm>(j.at("loss").at("form"));
    const json& walls = j.at("walls");
    s.walls = choice_of<SteeringWalls>(walls.at("rule"));
    s.wall_radius = walls.at("radius");
    s.wall_weight = walls.at("weight");
    s.wall_loss = walls.at("loss");
    s.max_force = j.at("max_force");
    s.max_speed = j.at("max_speed");
    for (const json& c : j.at("classes")) s.classes.push_back({c.at("share"), c.at("radius"), c.at("mass")});
    for (const json& b : j.at("bodies")) {
        s.bodies.push_back({{b.at("x_m"), b.at("y_m"), b.at("z_m")},
                            velocity_of(b),
                            b.at("time_s"),
                            b.at("radius_m"),
                            b.at("density_kg_m3")});
    }
    return s;
}

MixedWindow mixed_from(const json& j) {
    MixedWindow mixed;
    if (j.contains("x_min_m")) mixed.x_min = j["x_min_m"].get<double>();
    if (j.contains("x_max_m")) mixed.x_max = j["x_max_m"].get<double>();
    if (j.contains("margin_m")) mixed.margin = j["margin_m"].get<double>();
    mixed.chunk = j.at("chunk_m");
    mixed.obstacles = j.at("obstacles");
    return mixed;
}

Fluid fluid_from(const json& j) {
    Fluid fluid;
    fluid.model = choice_of<ModelKind>(j.at("model"));
    fluid.max_impulse_error = j.at("max_impulse_error");
    fluid.kinematic = kinematic_from(j.at("kinematic"));
    fluid.shallow_water.cell_size = j.at("shallow_water").at("cell_size_m");
    fluid.mixed = mixed_from(j.at("mixed"));
    fluid.steering = steering_from(j.at("steering"));
    fluid.particle_spacing = j.at("particle_spacing_m");
    fluid.kernel = choice_of<KernelKind>(j.at("kernel"));
    fluid.support_in_spacings = j.at("support_in_spacings");
    fluid.rest_density = j.at("rest_density_kg_m3");
    fluid.kinematic_viscosity = j.at("viscosity_m2_s");
    fluid.max_particles = j.at("max_particles");
    fluid.cfl = j.at("cfl");
    fluid.density_solve = solve_from(j.at("density_solve"));
    fluid.divergence_solve = solve_from(j.at("divergence_solve"));
    return fluid;
}

Spread spread_of(const json& j) {
    if (j.is_object()) return {j.at("min").get<double>(), j.at("max").get<double>()};
    return j.get<double>();
}

AgentGroup group_from(const json& j) {
    AgentGroup group;
    group.name = j.at("name");
    group.columns = j.at("columns");
    group.rows = j.at("rows");
    group.count = j.at("count");
    group.start_x = j.at("start").at("x_m");
    group.start_z = j.at("start").at("z_m");
    group.pitch_x = j.at("start").at("pitch_x_m");
    group.pitch_z = j.at("start").at("pitch_z_m");
    group.start_jitter = j.at("start").at("jitter_m");
    group.goal_x = j.at("goal").at("x_m");
    group.goal_z = j.at("goal").at("z_m");
    group.desired_speed = j.at("desired_speed_m_s");
    group.mass = spread_of(j.at("mass_kg"));
    group.tau = spread_of(j.at("tau"));
    return group;
}

RagdollRule ragdoll_from(const json& j) {
    return {choice_of<RagdollCondition>(j.at("condition")), j.at("tau_min"), j.at("speed_m_s"),
            j.at("depth_speed_m2_s"), j.at("random_sign")};
}

NavigationSettings navigation_from(const json& j) {
    return {choice_of<NavigationRule>(j.at("rule")), j.at("cell_m"), j.at("crowding"), j.at("every_s")};
}

Crowd crowd_from(const json& j) {
    Crowd crowd;
    crowd.speed_rule = choice_of<SpeedRule>(j.at("speed_rule"));
    crowd.step_rate = j.at("step_rate_hz");
    crowd.markers_per_cell = j.at("markers_per_cell");
    crowd.marker_min_distance = j.at("marker_min_distance_m");
    crowd.markers = choice_of<MarkerRule>(j.at("markers"));
    crowd.marker_epoch = j.at("marker_epoch_s");
    crowd.bodies = choice_of<BodyRule>(j.at("bodies"));
    crowd.body_radius = j.at("body_radius_m");
    crowd.navigation = navigation_from(j.at("navigation"));
    const json& evasion = j.at("evasion");
    crowd.evasion = {choice_of<EvasionRule>(evasion.at("rule")), evasion.at("radius_m"), evasion.at("prediction_s")};
    crowd.perception_radius = j.at("perception_radius_m");
    crowd.goal_radius = j.at("goal_radius_m");
    crowd.ragdoll = ragdoll_from(j.at("ragdoll"));
    for (const json& group : j.at("groups")) crowd.groups.push_back(group_from(group));
    return crowd;
}

TauEvent event_from(const json& j) {
    TauEvent event;
    event.frame = j.at("frame");
    if (j.contains("agent")) event.agent = j["agent"].get<int>();
    if (j.contains("group")) event.group = j["group"].get<std::string>();
    event.tau = j.at("tau");
    return event;
}

// The first frame at or after `time`; a time that is a frame's up to rounding means this frame.
std::uint64_t frame_at(double time, double frame_rate) {
    constexpr double rounding = 1e-6;  // frames
    return static_cast<std::uint64_t>(std::ceil(std::max(0.0, time * frame_rate - rounding)));
}

constexpr const char* count_schema = "/properties/crowd/properties/groups/items/properties/count";

// Here, as groups that take the value do not know where it was written, and there may be none.
void check_limits(const json& crowd, const std::string& key, const std::string& source) {
    const json& limits = crowd[key];
    if (!limits.is_object() || limits["min"] <= limits["max"]) return;
    throw ConfigurationError(source + ": /crowd/" + key + ": min " + limits["min"].dump() + " is above max " +
                             limits["max"].dump() + "; allowed: min <= max.");
}

// Gives the crowd's value of `key` to the groups that have none.
void inherit(json& crowd, const std::string& key, bool must_be_used, const std::string& source) {
    bool used = crowd["groups"].empty();
    for (json& group : crowd["groups"]) {
        if (group.contains(key)) continue;
        group[key] = crowd[key];
        used = true;
    }
    if (must_be_used && !used) {
        throw ConfigurationError(source + ": /crowd/" + key + ": " + crowd[key].dump() +
                                 " has no effect, as every group sets its own; set /crowd/groups/0/" + key +
                                 " instead.");
    }
}

void count_agents(json& group, std::size_t index, const std::string& source) {
    const std::int64_t places = group["columns"].get<std::int64_t>() * group["rows"].get<std::int64_t>();
    const std::string pointer = "/crowd/groups/" + std::to_string(index) + "/count";
    if (!group.contains("count")) {
        group["count"] = places;
        check_against_schema(group["count"], scene_schema().at(json::json_pointer(count_schema)), pointer, source);
    } else if (group["count"].get<std::int64_t>() > places) {
        throw ConfigurationError(source + ": " + pointer + ": " + group["count"].dump() + " agents do not fit on the " +
                                 "start grid of " + group["columns"].dump() + " columns and " + group["rows"].dump() +
                                 " rows; allowed: <= " + std::to_string(places) + ".");
    }
}

}  // namespace

const std::vector<std::string>& inherited_by_groups() {
    static const std::vector<std::string> keys = {"tau", "mass_kg", "desired_speed_m_s"};
    return keys;
}

void resolve_shorthands(json& document, const std::vector<std::string>& must_be_used, const std::string& source) {
    json& crowd = document["crowd"];
    for (const std::string& key : inherited_by_groups()) {
        check_limits(crowd, key, source);
        inherit(crowd, key, std::count(must_be_used.begin(), must_be_used.end(), key) > 0, source);
        crowd.erase(key);
    }
    for (std::size_t i = 0; i < crowd["groups"].size(); ++i) count_agents(crowd["groups"][i], i, source);
    const double frame_rate = document["frame_rate_hz"];
    if (!crowd.contains("step_rate_hz")) crowd["step_rate_hz"] = frame_rate;
    for (std::size_t i = 0; i < document["events"].size(); ++i) {
        json& event = document["events"][i];
        if (event.contains("frame") == event.contains("time_s")) {
            throw ConfigurationError(source + ": /events/" + std::to_string(i) + ": an event needs exactly one of " +
                                     "\"frame\" and \"time_s\", and has " +
                                     (event.contains("frame") ? "both." : "neither."));
        }
        if (event.contains("time_s")) {
            event["frame"] = frame_at(event["time_s"], frame_rate);
            event.erase("time_s");
        }
    }
}

Scene scene_from_json(const json& document) {
    Scene scene;
    scene.name = document.at("name");
    scene.description = document.at("description");
    scene.seed = document.at("seed");
    scene.duration = document.at("duration_s");
    scene.frame_rate = document.at("frame_rate_hz");
    scene.stop_when_no_agent_is_active = document.at("stop_when_no_agent_is_active");
    scene.lockstep_depth = document.at("lockstep_depth");
    const json& world = document.at("world");
    scene.world = {world.at("length_m"), world.at("width_m"), world.at("gravity_m_s2"),
                   choice_of<Ends>(world.at("ends"))};
    scene.channel = channel_from(document.at("channel"));
    for (const json& obstacle : document.at("obstacles")) {
        scene.obstacles.push_back({x_of(obstacle), z_of(obstacle), obstacle.at("height_m")});
    }
    scene.fluid = fluid_from(document.at("fluid"));
    scene.crowd = crowd_from(document.at("crowd"));
    const json& coupling = document.at("coupling");
    scene.coupling = {choice_of<ContactRule>(coupling.at("contact_rule")),
                      choice_of<CouplingRule>(coupling.at("rule")),
                      coupling.at("sampling_rate_hz"),
                      coupling.at("agent_radius_m"),
                      coupling.at("particle_radius_m"),
                      choice_of<AgentsStream>(coupling.at("agents_stream"))};
    for (const json& event : document.at("events")) scene.events.push_back(event_from(event));
    return scene;
}

}  // namespace wade
