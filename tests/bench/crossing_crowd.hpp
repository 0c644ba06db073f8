#pragma once
// A crowd on an open square. Each person walks to a goal of its own and draws a new one there, so that all paths cross.

#include <cstdint>
#include <vector>

#include "crowd_client/crowd_world.hpp"

namespace wade::bench {

struct Crossing {
    crowd::CrowdWorld crowd;
    std::vector<std::uint32_t> goals_reached;  // by agent
};

inline constexpr double goal_reach = 1.0;  // m; an agent this close to its goal gets the next one

// `people` at `density` (1/m2) on a square, on a jittered grid that keeps them more than a body apart up to 2 people/m2;
// goals uniform over the square. All of `crowd` but the groups holds for them. Boxes of 1 x 1 m, at most as many as people,
// stand evenly between the start positions.
[[nodiscard]] Crossing make_crossing(std::size_t people, double density, const Crowd& crowd, std::uint64_t seed = 1,
                                     std::size_t boxes = 0);

// The goal that an agent gets after having reached `draw` others, m.
[[nodiscard]] crowd::Vector2d goal_drawn(const Crossing& crossing, std::size_t id, std::uint64_t draw);

// Takes one step of the crowd on dry ground, then draws new goals for agents that have reached theirs.
void walk(Crossing& crossing);

// Pairs of overlapping people: discs of `radius` m, or less where shoulders are turned.
struct Overlaps {
    std::uint64_t pairs = 0;
    double deepest = 0;  // m
};
void add_overlaps(const crowd::Agents& agents, double radius, Overlaps& sum);

}  // namespace wade::bench
