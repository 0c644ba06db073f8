#pragma once
// Frames of water that tests make up, and a source that hands them out without shared memory; dry ground with people on it.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "configs/scene/channel.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/obstacle.hpp"
#include "configs/scene/scene.hpp"
#include "configs/scene/world.hpp"
#include "crowd_client/equations.hpp"
#include "crowd_client/session/frame_source.hpp"
#include "crowd_client/water/water_view.hpp"

namespace wade::crowd::testing {

// Particles as a frame holds them.
struct MadeUpWater {
    std::vector<float> mass, vx, vy, vz, px, py, pz;

    void add(double x, double z, double its_mass, double its_vx, double its_vz);
    [[nodiscard]] WaterView view() const;
    [[nodiscard]] shm::Frame frame(std::uint64_t number) const;
};

// A lattice of particles of spacing d that fills [x_lo, x_hi] x [z_lo, z_hi] to the given depth; mass 1000 d^3.
[[nodiscard]] MadeUpWater uniform_water(double x_lo, double x_hi, double z_lo, double z_hi, double depth, double d,
                                        double vx, double vz);

// Hands out `frames` frames (the last one marked as final), each made by a function of its number.
class MadeUpSource final : public FrameSource {
 public:
    MadeUpSource(std::uint64_t frames, std::function<MadeUpWater(std::uint64_t)> make)
        : frames_(frames), make_(std::move(make)) {
        stream.producer_name = "made_up";
    }

    [[nodiscard]] const shm::StreamInfo& info() const override { return stream; }
    [[nodiscard]] bool in_lockstep() const override { return stride == 1; }
    [[nodiscard]] std::optional<shm::Frame> acquire() override;
    void release() override {
        if (on_release) on_release();
        ++released;
    }
    [[nodiscard]] std::uint64_t dropped_frames() const override { return (stride - 1) * (released + 1); }
    void leave() noexcept override { left = true; }
    void abort(int reason_code, std::string_view text) noexcept override {
        abort_code = reason_code;
        abort_text = text;
    }

    shm::StreamInfo stream;  // 30 frames a second
    std::function<std::uint64_t(std::uint64_t)> tick_of = [](std::uint64_t frame) { return frame; };
    std::uint64_t stride = 1;  // above 1: not in lockstep, the frames between are dropped
    std::uint64_t number_of_next = 1;
    std::function<void()> on_release = {};
    std::uint64_t released = 0;
    bool left = false;
    int abort_code = 0;
    std::string abort_text;

 private:
    std::uint64_t frames_;
    std::function<MadeUpWater(std::uint64_t)> make_;
    MadeUpWater current_;
};

// A world of 100 x 50 m with one agent group of one agent at `start`.
[[nodiscard]] Scene one_agent_scene(double start_x, double start_z, double goal_x, double goal_z, double tau);

// A closed channel without water that fills the world, 10 steps a second.
inline Scene dry_scene(double length, double width, std::vector<Obstacle> obstacles = {}) {
    Scene scene;
    scene.world->length = length;
    scene.world->width = width;
    scene.channel->x = {0, length};
    scene.channel->z = {0, width};
    scene.channel->flow = Flow::closed;
    scene.frame_rate = scene.crowd->step_rate = 10;
    scene.obstacles = std::move(obstacles);
    scene.crowd->goal_radius = 0.5;
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
