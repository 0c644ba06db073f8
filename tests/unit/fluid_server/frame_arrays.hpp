#pragma once
// A slot of one's own, to look at what a model writes.

#include <algorithm>
#include <array>
#include <vector>

#include "fluid_server/fluid_model.hpp"

namespace wade::fluid::test {

// The arrays of one frame: mass, vx, vy, vz, px, py, pz.
class FrameArrays {
 public:
    explicit FrameArrays(const FluidModel& model) {
        for (auto& array : arrays_) array.resize(model.capacity());
    }
    void take(const FluidModel& model) { count = model.write_frame(slot()); }

    // Its particles, an array a field, cut at their number.
    [[nodiscard]] std::array<std::vector<float>, 7> particles() const {
        auto cut = arrays_;
        for (auto& array : cut) array.resize(count);
        return cut;
    }
    [[nodiscard]] std::vector<float> x() const { return particles()[4]; }
    [[nodiscard]] double mass() const {
        double sum = 0;
        for (std::uint32_t i = 0; i < count; ++i) sum += static_cast<double>(arrays_[0][i]);
        return sum;
    }

    std::uint32_t count = 0;

 private:
    shm::FrameFields slot() {
        auto& a = arrays_;
        return {1, a[0], a[1], a[2], a[3], a[4], a[5], a[6], {}, {}, {}, {}, {}, {}, {}};
    }
    std::array<std::vector<float>, 7> arrays_;
};

}  // namespace wade::fluid::test
