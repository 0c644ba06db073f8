#pragma once
// Settings of the coupling of water and crowd.

namespace wade {

enum class ContactRule { difference, sum };
enum class CouplingRule {
    per_frame,  // Eq. 9 in each step
    continuous  // agents tend to the velocity of Eq. 9, in continuous time
};
enum class AgentsStream { off, serial, parallel };  // from the crowd to the water; coupling lag 0 or 1

enum class Shelter { off, wake };  // wake shielding of people behind people, finer than the water resolves

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

}  // namespace wade
