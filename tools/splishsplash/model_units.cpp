#include "tools/splishsplash/model_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace wade::splishsplash {

namespace {

void check_range(const char* key, double value, double lo, double hi) {
    if (value >= lo && value <= hi) return;
    std::ostringstream message;
    message << key << " is " << value << ", allowed is " << lo << " to " << hi;
    throw std::invalid_argument(message.str());
}

}  // namespace

void check(const ModelUnits& units) {
    check_range("metres_per_unit", units.metres_per_unit, 1e-6, 1e6);
    check_range("time_scale", units.time_scale, 1e-6, 1e6);
    check_range("dataExportFPS", units.frame_rate, 1e-3, 1e6);
    for (const double metres : units.origin) check_range("origin_m", metres, -1e9, 1e9);
    std::array<std::int32_t, 3> found{};
    std::transform(units.axes.begin(), units.axes.end(), found.begin(),
                   [](std::int32_t axis) { return std::abs(axis); });
    std::sort(found.begin(), found.end());
    if (found != std::array<std::int32_t, 3>{1, 2, 3}) {
        std::ostringstream message;
        message << "axes is [" << units.axes[0] << ", " << units.axes[1] << ", " << units.axes[2]
                << "], allowed is 1, 2 and 3 in any order, negative if mirrored";
        throw std::invalid_argument(message.str());
    }
}

shm::StreamInfo stream_info(const ModelUnits& units, std::uint32_t capacity, double particle_radius,
                            double rest_density) {
    shm::StreamInfo info;
    info.producer_name = "SPlisHSPlasH";
    info.capacity = capacity;
    info.ticks_per_frame = ticks_per_frame;
    const double world_rate = units.frame_rate / units.time_scale;
    info.ticks_per_second =
        static_cast<std::uint64_t>(std::max(1LL, std::llround(world_rate * static_cast<double>(ticks_per_frame))));
    info.metres_per_unit = units.metres_per_unit;
    info.origin = units.origin;
    info.axes = units.axes;
    info.particle_radius = particle_radius * units.metres_per_unit;
    info.rest_density = rest_density;
    return info;
}

double ModelClock::advance(double clock, double step) {
    const double passed = started_ ? clock - clock_ : step;
    const double steps = std::round(passed / step);
    // A difference of two single-precision clocks is good to a few of their last places.
    const double rounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * std::abs(clock);
    time_ += std::abs(passed - steps * step) <= rounding * std::max(1.0, steps) ? steps * step : passed;
    clock_ = clock;
    started_ = true;
    return time_;
}

std::uint64_t tick_of_time(const ModelUnits& units, double time, std::uint64_t frame) {
    const double frames = time * units.frame_rate;
    if (!(std::abs(frames - static_cast<double>(frame)) <= 1.5)) {
        std::ostringstream message;
        message << "frame " << frame << " is due at " << static_cast<double>(frame) / units.frame_rate
                << " s, the simulation is at " << time
                << " s: its time step must not exceed 1/dataExportFPS = " << 1 / units.frame_rate << " s";
        throw std::invalid_argument(message.str());
    }
    const double whole = std::round(frames);
    const double shown = std::abs(frames - whole) <= 1e-6 * whole ? whole : frames;
    return static_cast<std::uint64_t>(std::max(0LL, std::llround(shown * static_cast<double>(ticks_per_frame))));
}

void store(const ModelUnits& units, const ModelParticle& particle, const shm::FrameFields& slot, std::size_t i) {
    const double volume_scale = units.metres_per_unit * units.metres_per_unit * units.metres_per_unit;
    const auto per_world_second = [&](float v) {
        return static_cast<float>(static_cast<double>(v) / units.time_scale);
    };
    slot.mass[i] = static_cast<float>(particle.mass * volume_scale);
    slot.vx[i] = per_world_second(particle.velocity[0]);
    slot.vy[i] = per_world_second(particle.velocity[1]);
    slot.vz[i] = per_world_second(particle.velocity[2]);
    slot.px[i] = particle.position[0];
    slot.py[i] = particle.position[1];
    slot.pz[i] = particle.position[2];
}

}  // namespace wade::splishsplash
