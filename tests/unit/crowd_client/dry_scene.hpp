#pragma once
// Dry ground between obstacles, and people on it.

#include <utility>
#include <vector>

#include "configs/scene/scene.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd::testing {

// A closed channel without water that fills the world, 10 steps a second.
inline Scene dry_scene(double length, double width, std::vector<Obstacle> obstacles = {}) {
    Scene scene;
    scene.world.length = length;
    scene.world.width = width;
    scene.channel.x = {0, length};
    scene.channel.z = {0, width};
    scene.channel.flow = Flow::closed;
    scene.frame_rate = scene.crowd.step_rate = 10;
    scene.obstacles = std::move(obstacles);
    scene.crowd.goal_radius = 0.5;
    return scene;
}

// `columns` people along x from `start` on, `pitch` apart, m.
inline AgentGroup row_of_people(int columns, const Vector2d& start, double pitch, const Vector2d& goal) {
    AgentGroup group;
    group.columns = group.count = columns;
    group.start_x = start.x();
    group.start_z = start.y();
    group.pitch_x = pitch;
    group.goal_x = goal.x();
    group.goal_z = goal.y();
    return group;
}

}  // namespace wade::crowd::testing
