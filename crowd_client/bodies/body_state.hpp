#pragma once
// What a step with bodies works with. Letters are those of bodies.hpp.

#include <cstdint>
#include <vector>

#include "configs/scene/crowd.hpp"
#include "crowd_client/bodies/body_cells.hpp"
#include "crowd_client/bodies/body_looks.hpp"
#include "crowd_client/equations.hpp"

namespace wade::crowd {

// The numbers of the rule.
struct BodyStyle {
    double lead_time = 0.4;         // tau, s
    double side_turn = 0.1;         // phi, rad
    double detour_turn = 1.5;       // alpha, rad
    double discount = 0.9;          // delta; at 1 crowds jam
    double contest_distance = 0.4;  // D, m
    double patience = 0.7;          // T_b, s
    double slow_share = 0.5;        // beta
    double spacing_rate = 0;        // gamma, 1/m2; 0: nobody follows
    double passing_ground = 0.7;    // A_0, m2
};
[[nodiscard]] BodyStyle body_style(BodyRule rule);

// u.n <= gap.
struct Limit {
    double nx = 0, nz = 0;  // unit vector towards what is in the way
    double gap = 0;         // m, >= 0
};

// Those who may come near one another in a step, person by person, and the limits that they set one another in a motion.
struct NearPairs {
    std::size_t count = 0;
    std::vector<std::uint32_t> own, other;  // places in the list of people
    std::vector<double> shift;              // of an image in a periodic world, along x, m; else 0
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
    std::uint64_t seed = 0;  // of who yields when

    // Working memory of a decision, by place in the list of the active.
    std::vector<Vector2d> site, velocity, turned_goal;
    std::vector<double> desired_speed, discount;
    std::vector<Vector2d> heading, way, bearing;  // unit vectors of the last motion, the way and to the goal
    std::vector<double> followed, opposed;        // as seen; empty in decisions without a look
    Looks looks;
    BodyCells cells;
    bool are_sorted = false;  // cells hold people where they stand at the begin of the step at hand

    // Working memory of a motion, by place.
    std::vector<Vector2d> place, next_place;  // m
    std::vector<double> radius_now;           // r_i before growth, m
    std::vector<double> radius_wished;        // that shoulders turn to, m
    std::vector<Vector2d> wish;               // w, m
    std::vector<double> growth;               // dr that the body would take, m
    std::vector<double> least_gap;            // towards others, m
    std::vector<std::uint32_t> is_bound;      // 1: others may shorten w, else 0
    std::vector<std::uint32_t> neighbours;    // number of those who may come near
    std::vector<NearPairs> near;              // by thread
    std::vector<Vector2d> step;               // u, of all motions in a step, m
};

}  // namespace wade::crowd
