#include "fluid_server/people/pushes.hpp"

#include <cmath>

#include "fluid_server/particles/parallel.hpp"

namespace wade::fluid {

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
        const double most = std::hypot(ux, uz) * water.weight * water.weight / water.squares;
        const double asked = std::hypot(wanted[0], wanted[1]);
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

float top_of_column(const Push& push, const std::vector<BedFacet>& bed, double spacing) {
    return bed_height(bed, static_cast<float>(push.place[0])) + static_cast<float>(push.submerged + 0.5 * spacing);
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

void push_particles(PeopleInWater& people, double share, double gain, const CellGrid& grid,
                    const std::vector<BedFacet>& bed, double spacing, double mass, Particles& particles) {
    const std::vector<Push>& pushes = people.pushes;
    // Places do not change here, so that all can be looked for at once; velocities do, so that people push in their order.
    people.near.resize(std::max(people.near.size(), pushes.size()));
    const auto look = [&](std::size_t k) {
        find_near(
            pushes[k], grid, particles, top_of_column(pushes[k], bed, spacing), [](float) { return 1.0; },
            people.near[k]);
    };
    for_each_block(pushes.size(), [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) look(k);
    });
    for (std::size_t k = 0; k < pushes.size(); ++k) {
        NearWater water;
        add_particles(people.near[k], particles, mass, water);
        MomentumAccount now;
        const GroundVector impulse = impulse_now(pushes[k], share, water, now);
        now.taken = take_from(people.near[k], impulse, water.weight, mass, particles);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            people.account.taken[axis] += gain * now.taken[axis];
            people.account.missing[axis] += gain * now.missing[axis];
        }
    }
}

}  // namespace wade::fluid
