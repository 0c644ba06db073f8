#include "fluid_server/people/pushes.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "configs/numbers/portable.hpp"
#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

namespace {

// With fewer people than this the threads would wait for one another longer than they work.
constexpr std::size_t alone_below = 64;

}  // namespace

void take_pushes(const AgentsView& agents, PeopleInWater& people) {
    people.pushes.clear();
    if (agents.jx.empty()) return;
    people.told = true;
    const auto number = [](std::span<const float> values, std::size_t k) { return static_cast<double>(values[k]); };
    for (std::size_t k = 0; k < agents.jx.size(); ++k) {
        if (agents.jx[k] == 0 && agents.jz[k] == 0) continue;
        people.pushes.push_back({{number(agents.px, k), number(agents.pz, k)},
                                 {number(agents.vx, k), number(agents.vz, k)},
                                 {number(agents.jx, k), number(agents.jz, k)},
                                 number(agents.submerged, k),
                                 number(agents.spread, k)});
    }
}

GroundVector impulse_now(const Push& push, double share, const NearWater& water, MomentumAccount& account) {
    const GroundVector wanted{push.impulse[0] * share, push.impulse[1] * share};
    double part = 0;
    if (water.weight > 0) {
        const double ux = water.momentum[0] / water.weight - push.velocity[0];
        const double uz = water.momentum[1] / water.weight - push.velocity[1];
        const double most = length_of(ux, uz) * water.weight * water.weight / water.squares;
        const double asked = length_of(wanted[0], wanted[1]);
        part = asked > most ? most / asked : 1;
    }
    for (std::size_t axis = 0; axis < 2; ++axis) account.missing[axis] += (1 - part) * wanted[axis];
    return {part * wanted[0], part * wanted[1]};
}

void note_people(const PeopleInWater& people, shm::Diagnostics& diagnostics) {
    if (!people.told) return;
    diagnostics.taken_by_people_x_n_s = people.account.taken[0];
    diagnostics.taken_by_people_z_n_s = people.account.taken[1];
    diagnostics.missing_for_people_x_n_s = people.account.missing[0];
    diagnostics.missing_for_people_z_n_s = people.account.missing[1];
}

float top_of_column(const Push& push, const GroundAt& ground, double spacing) {
    return (ground ? ground(push.place) : 0) + static_cast<float>(push.submerged + 0.5 * spacing);
}

void add_particles(const NearParticles& near, const Particles& p, double mass, NearWater& sum) {
    double weight = 0, squares = 0, x = 0, z = 0;
    for (std::size_t n = 0; n < near.size; ++n) {
        const std::size_t i = near.index[n];
        const auto w = static_cast<double>(near.weight[n]);
        weight += w;
        squares += w * w;
        x += w * static_cast<double>(p.vx[i]);
        z += w * static_cast<double>(p.vz[i]);
    }
    sum.weight += mass * weight;
    sum.squares += mass * squares;
    sum.momentum[0] += mass * x;
    sum.momentum[1] += mass * z;
}

GroundVector take_from(const NearParticles& near, const GroundVector& impulse, double weight, double mass,
                       Particles& p) {
    if (impulse[0] == 0 && impulse[1] == 0) return {};
    const double slower_x = impulse[0] / weight, slower_z = impulse[1] / weight;
    double lost_x = 0, lost_z = 0;  // m/s
    for (std::size_t n = 0; n < near.size; ++n) {
        const std::size_t i = near.index[n];
        const auto w = static_cast<double>(near.weight[n]);
        const double vx = static_cast<double>(p.vx[i]), vz = static_cast<double>(p.vz[i]);
        p.vx[i] = static_cast<float>(vx - w * slower_x);
        p.vz[i] = static_cast<float>(vz - w * slower_z);
        lost_x += vx - static_cast<double>(p.vx[i]);
        lost_z += vz - static_cast<double>(p.vz[i]);
    }
    return {mass * lost_x, mass * lost_z};
}

void find_strips(const std::vector<Push>& pushes, double period, PushStrips& strips) {
    double reach = 0, lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Push& push : pushes) {
        reach = std::max(reach, push.spread);
        lo = std::min(lo, push.place[1]);
        hi = std::max(hi, push.place[1]);
    }
    // The discs of two strips that go together do not touch, whatever is rounded; more strips than people are of no use.
    const double extent = period > 0 ? period : hi - lo;
    double width = std::max(2.001 * reach, extent / static_cast<double>(pushes.size()));
    std::size_t count = width > 0 ? 1 + static_cast<std::size_t>(extent / width) : 1;
    if (period > 0) {
        count = std::max<std::size_t>(1, 2 * static_cast<std::size_t>(period / (2 * width)));
        width = period / static_cast<double>(count);
    }
    const auto strip_of = [&](const Push& push) {
        const double z = push.place[1], from_lo = period > 0 ? z - period * std::floor(z / period) : z - lo;
        return std::min(count - 1, static_cast<std::size_t>(from_lo / width));
    };
    strips.begin.assign(count + 1, 0);
    strips.people.resize(pushes.size());
    for (const Push& push : pushes) ++strips.begin[strip_of(push)];
    std::partial_sum(strips.begin.begin(), strips.begin.end(), strips.begin.begin());
    for (std::size_t k = pushes.size(); k-- > 0;) {  // from the end of each strip to its begin
        strips.people[--strips.begin[strip_of(pushes[k])]] = static_cast<std::uint32_t>(k);
    }
}

void push_particles(PeopleInWater& people, double share, double gain, const CellGrid& grid, const GroundAt& ground,
                    double spacing, double mass, Particles& particles) {
    const std::vector<Push>& pushes = people.pushes;
    if (pushes.empty()) return;
    const std::size_t threads =
        pushes.size() < alone_below ? 1 : std::min(static_cast<std::size_t>(omp_get_max_threads()), most_shares);
    people.accounts.assign(pushes.size(), {});
    people.near.resize(std::max(people.near.size(), threads));
    find_strips(pushes, grid.period(2), people.strips);
    const auto push_by = [&](std::size_t k, NearParticles& near) {
        find_near(
            pushes[k], grid, particles, top_of_column(pushes[k], ground, spacing), [](float) { return 1.0; }, near);
        NearWater water;
        add_particles(near, particles, mass, water);
        const GroundVector impulse = impulse_now(pushes[k], share, water, people.accounts[k]);
        people.accounts[k].taken = take_from(near, impulse, water.weight, mass, particles);
    };
    const PushStrips& strips = people.strips;
    for (const std::size_t first : {0U, 1U}) {
        for_each_item((strips.count() + 1 - first) / 2, threads, [&](std::size_t item, std::size_t thread) {
            const std::size_t strip = first + 2 * item;
            for (std::size_t n = strips.begin[strip]; n < strips.begin[strip + 1]; ++n) {
                push_by(strips.people[n], people.near[thread]);
            }
        });
    }
    for (const MomentumAccount& now : people.accounts) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            people.account.taken[axis] += gain * now.taken[axis];
            people.account.missing[axis] += gain * now.missing[axis];
        }
    }
}

}  // namespace wade::fluid
