#pragma once
// The smallest model of the water: a sheet of particles that drifts with the stream.

#include <cmath>

#include "configs/scene/channel.hpp"
#include "configs/scene/scene.hpp"
#include "fluid_server/estimate.hpp"
#include "fluid_server/fluid_model.hpp"

namespace wade::fluid {

// A particle every metre along the channel, all of them where the first is plus whole metres.
class Toy : public FluidModel {
 public:
    explicit Toy(const Scene& scene) : channel_(scene.channel) {}

    [[nodiscard]] static Estimate estimate(const Scene& scene) {
        const auto count = static_cast<std::uint64_t>(scene.channel->x.length());
        return {count, empty_server + memory_of_frames(scene, count), 1e-9 * static_cast<double>(count)};
    }

    [[nodiscard]] std::string_view name() const override { return "?"; }  // its word in scenes
    [[nodiscard]] std::uint32_t capacity() const override { return static_cast<std::uint32_t>(channel_.x.length()); }
    shm::Diagnostics advance_frame(const FrameInterval& interval) override {
        drift_ = std::fmod(channel_.velocity * interval.end(), 1.0);
        shm::Diagnostics d;
        d.sub_steps = 1;
        d.last_dt_s = interval.duration();
        return d;
    }
    std::uint32_t write_frame(const shm::FrameFields& slot) const override {
        for (std::uint32_t i = 0; i < capacity(); ++i) {
            slot.mass[i] = 1000;
            slot.vx[i] = static_cast<float>(-channel_.velocity), slot.vy[i] = slot.vz[i] = 0;
            slot.px[i] = static_cast<float>(channel_.x.lo + i + 1 - drift_);
            slot.py[i] = static_cast<float>(0.5 * channel_.depth);
            slot.pz[i] = static_cast<float>(0.5 * (channel_.z.lo + channel_.z.hi));
        }
        return capacity();
    }

 private:
    Channel channel_;
    double drift_ = 0;  // m
};

}  // namespace wade::fluid
