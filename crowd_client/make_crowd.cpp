// Makes a crowd before its first step, and fits it to a stream.

#include <algorithm>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/scene/choices.hpp"
#include "configs/scene/coupling.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fields/residents.hpp"
#include "configs/scene/fluid.hpp"
#include "crowd_client/crowd_motion.hpp"
#include "crowd_client/crowd_world.hpp"
#include "crowd_client/hands.hpp"
#include "crowd_client/rescue.hpp"
#include "crowd_client/responses/registry.hpp"
#include "crowd_client/start_warnings.hpp"
#include "crowd_client/water/contacts.hpp"
#include "crowd_client/water_warnings.hpp"

namespace wade::crowd {
namespace {

void check_coupling(const Scene& scene) {
    const double distance = contact_distance(scene.coupling);
    std::ostringstream message;
    if (!(distance > 0)) {
        message << "/coupling: agent_radius_m and particle_radius_m are both " << scene.coupling->agent_radius
                << ", so that with contact_rule 'difference' no water ever touches an agent";
    } else if (distance > GroundGrid::cell_size) {
        message << "/coupling: contact distance " << distance << " m, allowed is up to " << GroundGrid::cell_size
                << " m (the size of a cell)";
    } else if (!(scene.frame_rate > 0)) {
        message << "/frame_rate_hz is " << scene.frame_rate << ", allowed is more than 0";
    } else if (!(scene.crowd->step_rate > 0)) {
        message << "/crowd/step_rate_hz is " << scene.crowd->step_rate << ", allowed is more than 0";
    } else {
        return;
    }
    throw ConfigurationError(message.str());
}

void move_out_of_faces(Agents& agents, const Walls& walls) {
    for (std::size_t id = 0; id < agents.size(); ++id) {
        if (agents.outcome[id] == Outcome::indoors) continue;  // before its door, where there is room
        const std::optional<Vector2d> place = place_outside(walls, agents.position[id]);
        if (!place) {
            std::ostringstream message;
            message << "/crowd/groups/" << agents.group[id] << ": agent " << id << " starts at ("
                    << agents.position[id].x() << ", " << agents.position[id].y() << "), inside an obstacle";
            throw ConfigurationError(message.str());
        }
        agents.position[id] = *place;
    }
}

// Moves agents outdoors apart. Agents in houses are let out only where there is room.
void make_room_outdoors(CrowdWorld& crowd) {
    const double radius = crowd.scene.crowd->body_radius;
    if (crowd.indoors.inside == 0) return make_room_for_bodies(crowd.agents, crowd.walls, radius);
    Agents outdoors;
    for (const std::uint32_t id : crowd.active) {
        outdoors.position.push_back(crowd.agents.position[id]);
        outdoors.group.push_back(crowd.agents.group[id]);
    }
    make_room_for_bodies(outdoors, crowd.walls, radius);
    for (std::size_t k = 0; k < crowd.active.size(); ++k) crowd.agents.position[crowd.active[k]] = outdoors.position[k];
}

void feel_and_push(const Scene& scene, const Vector2d& column, CrowdWorld& crowd) {
    const bool has_poses = scene.crowd->pose_rate > 0;
    if (scene.crowd->response == ResponseKind::measured || scene.coupling->two_way || has_poses) {
        crowd.feeling = make_feeling(scene, column);
    }
    if (scene.coupling->two_way) crowd.pushing = start_pushing(scene, *crowd.feeling, crowd.agents);
}

// Returns the settings of the water, with the stream's model and spacing where the scene leaves them open.
Fluid fluid_of_stream(const Fluid& of_scene, const StreamWater& water) {
    Fluid fluid = of_scene;
    if (fluid.model != ModelKind::automatic || !water.model) return fluid;
    fluid.model = *water.model;
    if (water.spacing > 0) fluid.particle_spacing = water.spacing;
    return fluid;
}

void warn_of_water(CrowdWorld& crowd, const StreamWater& water) {
    Scene scene = crowd.scene;
    const ModelChoice choice =
        scene.fluid->model == ModelKind::automatic ? ModelChoice::of_server : ModelChoice::of_scene;
    scene.fluid = fluid_of_stream(scene.fluid, water);
    for (std::string& warning : water_warnings(scene, choice)) crowd.warnings.push_back(std::move(warning));
}

}  // namespace

CrowdWorld make_crowd(const Scene& given) {
    check_coupling(given);
    CrowdWorld crowd;
    crowd.scene = given;
    const Scene& scene = crowd.scene;
    count_lodgers(crowd.scene);
    crowd.dt = 1 / scene.crowd->step_rate;
    std::stable_sort(crowd.scene.events.begin(), crowd.scene.events.end(),
                     [](const TauEvent& a, const TauEvent& b) { return a.frame < b.frame; });
    crowd.agents = make_agents(scene);
    for (std::uint32_t id = 0; id < crowd.agents.size(); ++id) {
        if (crowd.agents.outcome[id] == Outcome::active) crowd.active.push_back(id);
    }
    crowd.indoors = indoors_of(crowd.agents, crowd.dt);
    crowd.walls = make_walls(scene);
    move_out_of_faces(crowd.agents, crowd.walls);
    if (scene.crowd->bodies != BodyRule::none) {
        crowd.bodies.rule = scene.crowd->bodies;
        crowd.bodies.style = body_style(scene.crowd->bodies);
        crowd.bodies.radius = scene.crowd->body_radius;
        crowd.bodies.seed = scene.seed;
        make_room_outdoors(crowd);
        begin_bodies(crowd.agents, scene.crowd->body_radius);
        crowd.clock = body_clock(crowd.dt);
    } else if (scene.crowd->response == ResponseKind::measured || crowd.dt > longest_of_points * (1 + rounding)) {
        crowd.clock.parts = body_clock(crowd.dt).parts;
    }
    crowd.agents.stay = crowd.agents.position;
    crowd.navigation = scene.site ? make_site_routes(scene, crowd.agents) : make_navigation(scene, crowd.agents);
    const std::string shut_in = choose_doors(crowd.navigation, scene, crowd.agents);
    crowd.indoors = indoors_of(crowd.agents, crowd.dt);
    crowd.warnings = start_warnings(scene, crowd.agents, crowd.navigation);
    if (!shut_in.empty()) crowd.warnings.push_back(shut_in);
    crowd.markers = crowd.agents.size() == 0 ? Markers{} : place_markers(scene);
    crowd.markers.grid = GroundGrid::over(scene.world);
    crowd.markers.cell_start.resize(crowd.markers.grid.cells() + 1);
    crowd.water = empty_bins(scene);
    feel_and_push(scene, Vector2d::Zero(), crowd);
    for (std::size_t id = 0; scene.crowd->pose_rate > 0 && id < crowd.agents.size(); ++id) {
        crowd.poses.push_back(standing_pose(crowd.agents.people, id, crowd.agents.heading[id]));
    }
    crowd.links = links_of_scene(scene, crowd.agents);
    if (!scene.crowd->ropes.empty()) crowd.hands_spent.assign(crowd.agents.size(), 0.0);
    crowd.rescues = rescues_of_scene(scene, crowd.agents);
    crowd.response = make_response(name_of(scene.crowd->response), scene);
    return crowd;
}

void suit_to_stream(CrowdWorld& crowd, const StreamWater& water) {
    if (water.model) warn_of_water(crowd, water);
    if (!crowd.feeling) return;
    crowd.scene.fluid = fluid_of_stream(crowd.scene.fluid, water);
    feel_and_push(crowd.scene, water.column, crowd);
    // The water of this project's models has the spacing that the scene states: water_warnings.hpp.
    if (!water.model && crowd.scene.crowd->response == ResponseKind::measured) {
        crowd.density.emplace(*crowd.feeling, crowd.scene.fluid->particle_spacing);
    }
}

}  // namespace wade::crowd
