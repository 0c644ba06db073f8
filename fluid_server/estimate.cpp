#include "fluid_server/estimate.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "configs/scene/fluid.hpp"
#include "configs/scene/particle_volume.hpp"

namespace wade::fluid {

namespace {

constexpr double fields_of_frame = 7;  // numbers of 4 bytes a particle

std::string number(double value, const char* unit) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), value < 9.95 ? "%.1f %s" : "%.0f %s", value, unit);
    return text.data();
}

std::string memory_text(double bytes) {
    return bytes < 1e9 ? number(std::ceil(1e-6 * bytes), "MB") : number(1e-9 * bytes, "GB");
}

std::string time_text(double seconds) {
    if (seconds < 1) return "less than 1 s";
    if (seconds < 100) return "about " + number(std::ceil(seconds), "s");
    if (seconds < 6000) return "about " + number(seconds / 60, "min");
    return seconds < 4e5 ? "about " + number(seconds / 3600, "h") : "about " + number(seconds / 86400, "days");
}

}  // namespace

double memory_of_frames(const Scene& scene, std::uint64_t capacity) {
    return fields_of_frame * sizeof(float) * static_cast<double>(capacity) * scene.lockstep_depth;
}

double neighbours_within(double radius, const Fluid& fluid) {
    return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3) / particle_volume(fluid);
}

std::string text_of(const Estimate& estimate) {
    return "at most " + std::to_string(estimate.particles) + " particles, " + memory_text(estimate.memory) +
           " of memory, " + time_text(estimate.cpu_time) + " of CPU time";
}

}  // namespace wade::fluid
