#pragma once
// What people take from the water during a frame, and the account of it.
//
//   w(r) = max(0, 1 - r / R)               the cone round a person, r the distance in the ground plane
//   S = sum w_i m_i,  theta = sum w_i^2 m_i / S,  U = sum w_i m_i v_i / S      over the water i of the person's column
//   v_i -= w_i J' / S,  J' = J dt / (length of the frame)                      in each sub-step dt
//
// The sum of m_i w_i J' / S is J', whatever the water: momentum goes nowhere else. Weights are those of the moment, so that the
// water that a person pushed may have flowed away. J' is at most |U - V| S / theta, V the person's velocity: a film that is
// left of the water which the crowd saw is stopped by people, not thrown back. What is missing then is booked apart.
//
// Particles are pushed by strips of people along x, each at least as wide as two discs: first all even strips, then all odd ones,
// in each the people in their order. No two of the strips that are at work at once reach the same particle, so that the bits do
// not depend on the threads.
//
//     0   1   2   3   4   5      even: 0, 2, 4 at once        A period is cut into an even number of strips, so that
//   | . | o | . | o | . | o |    odd:  1, 3, 5 at once        the last one and the first do not go together.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "fluid_server/fluid_model.hpp"
#include "fluid_server/particles/bed_profile.hpp"
#include "fluid_server/particles/cell_grid.hpp"
#include "fluid_server/particles/particles.hpp"

namespace wade::fluid {

using GroundVector = std::array<double, 2>;  // along x and across

struct Push {
    GroundVector place{};     // m
    GroundVector velocity{};  // V, m/s
    GroundVector impulse{};   // J, N s of the frame, that the water loses
    double submerged = 0;     // m above the bed
    double spread = 0;        // R, m
};

// Sums over the water near a person, mass as a measure.
struct NearWater {
    double weight = 0;        // S, kg
    double squares = 0;       // S theta, kg
    GroundVector momentum{};  // S U, kg m/s

    void add(double w, double mass, double vx, double vz) {
        weight += w * mass;
        squares += w * w * mass;
        momentum[0] += w * mass * vx;
        momentum[1] += w * mass * vz;
    }
};

// N s since the start.
struct MomentumAccount {
    GroundVector taken{};    // what the water lost
    GroundVector missing{};  // what people got from water that was no longer there
};

// Particles near one person, with their weights.
struct NearParticles {
    std::size_t size = 0;  // entries in use; the lists may be longer
    std::vector<std::uint32_t> index;
    std::vector<float> weight;
};

// People by strips along x, side by side across.
struct PushStrips {
    std::vector<std::uint32_t> begin;  // of each strip in `people`, and their number behind the last
    std::vector<std::uint32_t> people;

    [[nodiscard]] std::size_t count() const { return begin.size() - 1; }
};

struct PeopleInWater {
    std::vector<Push> pushes;  // of the current frame, without zeros, in the order of the agents
    double frame_time = 0;     // s
    MomentumAccount account;
    bool told = false;  // a crowd has ever sent impulses

    // Of the moment; kept for their memory.
    PushStrips strips;
    std::vector<MomentumAccount> accounts;  // by push
    std::vector<NearParticles> near;        // by thread

    [[nodiscard]] bool push() const { return !pushes.empty(); }
};

// The pushes of the frame that follows; none where the agents bring no impulses.
void take_pushes(const AgentsView& agents, PeopleInWater& people);

// J' of a person, given the water near it and `share` of the frame; books what is missing.
[[nodiscard]] GroundVector impulse_now(const Push& push, double share, const NearWater& water,
                                       MomentumAccount& account);

// Writes the account into the diagnostics of a frame, once there are impulses.
void note_people(const PeopleInWater& people, shm::Diagnostics& diagnostics);

// Finds the particles of the water column round a person: nearer in plan than the spread R and lower than `top`, m
// (top_of_column()), none that an emitter or a guard moves. grid: sorted. counts: fraction of a particle at x that
// belongs to the water, [0, 1].
template <typename Counts>
void find_near(const Push& push, const CellGrid& grid, const Particles& p, float top, Counts&& counts,
               NearParticles& near) {
    const auto x = static_cast<float>(push.place[0]), z = static_cast<float>(push.place[1]);
    const auto reach = static_cast<float>(push.spread);
    const Vec3 lo{x - reach, 0, z - reach}, hi{x + reach, top, z + reach};
    std::size_t found = 0;
    grid.for_each_period(lo, hi, [&](const Vec3& shift) {
        const Vec3 from{lo[0] - shift[0], lo[1] - shift[1], lo[2] - shift[2]};
        const Vec3 to{hi[0] - shift[0], hi[1] - shift[1], hi[2] - shift[2]};
        grid.for_each_run(from, to, [&](std::uint32_t begin, std::uint32_t end) {
            near.index.resize(std::max(near.index.size(), found + (end - begin)));
            near.weight.resize(near.index.size());
            // Most are too far away: no branch depends on that.
            for (std::uint32_t i = begin; i < end; ++i) {
                const float dx = p.x[i] + shift[0] - x, dz = p.z[i] + shift[2] - z, y = p.y[i];
                const Kind kind = p.kind[i];
                const float square = dx * dx + dz * dz;
                near.index[found] = i;
                near.weight[found] = square;
                const bool is_near = square < reach * reach && y < top && kind == Kind::fluid;
                found += is_near ? 1U : 0U;
            }
        });
    });
    for (std::size_t n = 0; n < found; ++n) near.weight[n] = std::max(0.0F, 1 - std::sqrt(near.weight[n]) / reach);
    std::size_t kept = 0;
    for (std::size_t n = 0; n < found; ++n) {
        const std::uint32_t i = near.index[n];
        const auto counted = static_cast<float>(static_cast<double>(near.weight[n]) * counts(p.x[i]));
        near.index[kept] = i;
        near.weight[kept] = counted;
        kept += counted > 0 ? 1U : 0U;
    }
    near.size = kept;
}

// The height of the ground at a position, m; empty: 0.
using GroundAt = std::function<float(const GroundVector& place)>;

// That of a channel's bed.
[[nodiscard]] inline GroundAt ground_of_bed(const std::vector<BedFacet>& bed) {
    return [&bed](const GroundVector& place) { return bed_height(bed, static_cast<float>(place[0])); };
}

// Returns the upper limit of particle centres in the column of a person, m: some part of a lower particle is no higher
// than the submerged part of the person.
[[nodiscard]] float top_of_column(const Push& push, const GroundAt& ground, double spacing);

// Adds these particles, each of `mass` kg, to the sums.
void add_particles(const NearParticles& near, const Particles& particles, double mass, NearWater& sum);

// Takes J' = `impulse` from them and other water of together the weight S; returns what they lost, N s.
GroundVector take_from(const NearParticles& near, const GroundVector& impulse, double weight, double mass,
                       Particles& particles);

// Sorts people into strips. period: after which z repeats, m; 0: it does not.
void find_strips(const std::vector<Push>& pushes, double period, PushStrips& strips);

// Every person takes its share of the frame. gain: the velocities changed here count so many times in the end (midpoint.hpp).
void push_particles(PeopleInWater& people, double share, double gain, const CellGrid& grid, const GroundAt& ground,
                    double spacing, double mass, Particles& particles);

}  // namespace wade::fluid
