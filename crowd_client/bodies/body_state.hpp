#pragma once
// State and working memory of a step with bodies. Symbols as in bodies.hpp.

#include <cstdint>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/bodies/body_cells.hpp"
#include "crowd_client/bodies/body_looks.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd {

// Constants of the rule.
struct BodyStyle {
    double lead_time = 0.4;         // tau, s
    double side_turn = 0.1;         // phi, rad
    double detour_turn = 1.5;       // alpha, rad
    double discount = 0.9;          // delta; at 1 crowds jam
    double contest_distance = 0.4;  // D, m
    double patience = 0.7;          // T_b, s
    double slow_share = 0.5;        // beta
    double spacing_rate = 0;        // gamma, 1/m2; 0: no following
    double passing_ground = 0.7;    // A_0, m2
};
[[nodiscard]] BodyStyle body_style(BodyRule rule);

// u.n <= gap.
struct Limit {
    double nx = 0, nz = 0;  // unit vector towards the neighbour or obstacle
    double gap = 0;         // m, >= 0
};

// Pairs of agents that may come near each other in a step, sorted by agent, and the limits between them in a motion.
struct NearPairs {
    std::size_t count = 0;
    std::vector<std::uint32_t> own, other;  // indices in the list of people
    std::vector<double> shift;              // of a periodic image, along x, m; else 0
    std::vector<Limit> limit;

    void make_room_for(std::size_t more) {
        if (count + more <= own.size()) return;
        const std::size_t size = 2 * (count + more);
        for (std::vector<std::uint32_t>* v : {&own, &other}) v->resize(size);
        shift.resize(size, 0.0);
        limit.resize(size);
    }
};

struct Bodies {
    BodyRule rule = BodyRule::none;
    BodyStyle style;
    double radius = 0.25;    // r, m
    std::uint64_t seed = 0;  // of the random draws for yielding

    // Working memory of a decision, by index in the list of active agents.
    std::vector<Vector2d> site, velocity, turned_goal;
    std::vector<double> desired_speed, discount;
    std::vector<Vector2d> heading, way, bearing;  // unit vectors: last motion, route, straight to the goal
    std::vector<double> followed, opposed;        // current values; empty in decisions without an update
    Looks looks;
    BodyCells cells;
    bool are_sorted = false;  // cells hold the positions at the start of the current step

    // Working memory of a motion, by the same index.
    std::vector<Vector2d> place, next_place;  // m
    std::vector<double> radius_now;           // r_i before growth, m
    std::vector<double> radius_wished;        // aim of turning shoulders, m
    std::vector<Vector2d> wish;               // w, m
    std::vector<double> growth;               // desired dr, m
    std::vector<double> least_gap;            // smallest gap to neighbours, m
    std::vector<std::uint32_t> is_bound;      // 1: neighbours may shorten w, else 0
    std::vector<std::uint32_t> neighbours;    // number of agents that may come near
    std::vector<NearPairs> near;              // by thread
    std::vector<Vector2d> step;               // u, of all motions in a step, m
};

}  // namespace wade::crowd
