#pragma once
// Checks whether the particles of a producer can be the water of the scene. The usual first mistakes with a new solver
// are units, the order of the axes, masses, and no particles at all.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "configs/scene/interval.hpp"
#include "configs/scene/scene.hpp"
#include "crowd_client/water/water_view.hpp"

namespace wade::crowd {

struct Box {
    std::array<Interval, 3> sides;  // x, y, z, m
};

// Returns the box for the water of a scene: the channel from the bed to the highest surface that it starts with or
// feeds.
[[nodiscard]] Box water_box(const Scene& scene);

class Plausibility {
 public:
    explicit Plausibility(const Scene& scene);

    // Checks a frame in one pass over its particles. Returns sentences for the user, each kind once in a run:
    //   most particles lie outside the box of the water, by more than a tenth of its length and a metre
    //   the particles weigh ten times as much as water that fills their box would
    //   there was no particle in the first ten seconds, where the scene has water from the start
    // time: of the frame, s.
    // Throws RunError (protocol violation) for a mass that is not above 0 or not finite.
    [[nodiscard]] std::vector<std::string> look(const WaterView& water, std::uint64_t frame, double time);

 private:
    Box expected_;
    double rest_density_;
    bool should_have_water_;
    bool told_outside_ = false, told_heavy_ = false, told_empty_ = false;
};

}  // namespace wade::crowd
