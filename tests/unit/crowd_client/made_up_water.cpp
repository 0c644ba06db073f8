#include "made_up_water.hpp"

#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"

namespace wade::crowd::testing {

void MadeUpWater::add(double x, double z, double its_mass, double its_vx, double its_vz) {
    mass.push_back(static_cast<float>(its_mass));
    vx.push_back(static_cast<float>(its_vx));
    vy.push_back(0);
    vz.push_back(static_cast<float>(its_vz));
    px.push_back(static_cast<float>(x));
    py.push_back(0.5F);
    pz.push_back(static_cast<float>(z));
}

WaterView MadeUpWater::view() const {
    return ground_view(frame(1), shm::StreamInfo{});
}

shm::Frame MadeUpWater::frame(std::uint64_t number) const {
    shm::Frame f;
    f.frame = number;
    f.tick = number;
    f.count = static_cast<std::uint32_t>(mass.size());
    f.hash = 1000 + number;
    f.mass = mass;
    f.vx = vx;
    f.vy = vy;
    f.vz = vz;
    f.px = px;
    f.py = py;
    f.pz = pz;
    return f;
}

MadeUpWater uniform_water(double x_lo, double x_hi, double z_lo, double z_hi, double depth, double d, double vx,
                          double vz) {
    MadeUpWater water;
    const auto count = [d](double length) { return static_cast<int>(std::lround(length / d)); };
    for (int k = 0; k < count(depth); ++k) {
        for (int j = 0; j < count(z_hi - z_lo); ++j) {
            for (int i = 0; i < count(x_hi - x_lo); ++i) {
                water.add(x_lo + (i + 0.5) * d, z_lo + (j + 0.5) * d, 1000 * d * d * d, vx, vz);
            }
        }
    }
    return water;
}

std::optional<shm::Frame> MadeUpSource::acquire() {
    if (released >= frames_) return std::nullopt;
    current_ = make_(number_of_next);
    shm::Frame f = current_.frame(number_of_next);
    f.tick = tick_of(number_of_next);
    f.final = released + 1 == frames_;
    number_of_next += stride;
    return f;
}

Scene one_agent_scene(double start_x, double start_z, double goal_x, double goal_z, double tau) {
    Scene scene;
    scene.name = "one_agent";
    scene.channel->x = {0, 100};
    scene.channel->z = {11.5, 38.5};
    scene.fluid->particle_spacing = 0.5;
    AgentGroup group;
    group.name = "walkers";
    group.start_x = start_x;
    group.start_z = start_z;
    group.goal_x = goal_x;
    group.goal_z = goal_z;
    group.tau = tau;
    scene.crowd->groups.push_back(group);
    return scene;
}

}  // namespace wade::crowd::testing
