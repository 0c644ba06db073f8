#pragma once
// The scenes of configs/bench, in the sizes that are measured.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::bench {

// A scene of configs/bench with some values changed; pointer -> value.
Scene scene_of(const std::string& file, const std::map<std::string, std::string>& values = {});

// A river 1 m deep at 1.5 m/s that its particles fill in whole layers.
struct River {
    std::uint64_t size;             // particles
    double length, width, spacing;  // m
};
inline constexpr River river_2_layers{21'600, 100, 27, 0.5};
inline constexpr River river_4_layers{100'000, 62.5, 25, 0.25};
inline constexpr River river_10_layers{1'000'000, 50, 20, 0.1};
// The same water, and more and more of it: two layers, so that a particle has the same to do.
inline constexpr std::array<River, 3> wide_rivers{
    {{21'600, 100, 27, 0.5}, {216'000, 1000, 27, 0.5}, {2'160'000, 1000, 270, 0.5}}};

Scene river_scene(const River& river, std::map<std::string, std::string> more = {});

// Boxes of 1 x 1 m and 3 m height on a grid all over a river, as JSON: columns along the river, rows across it.
std::string boxes_on_grid(const River& river, int columns, int rows);

// A block of water of 20,000 particles that collapses in a corner of a channel that is otherwise dry: in the smallest one it
// has not yet reached the far walls after 1.5 s, so that the water is the same in all.
inline constexpr std::array<River, 3> dry_channels{
    {{20'000, 60, 60, 0.5}, {20'000, 2000, 500, 0.5}, {20'000, 20'000, 2000, 0.5}}};
std::map<std::string, std::string> block_in_the_corner();

// The river of the paper, 100 x 27 m, with about so many particles and columns x rows agents all over it. `who`: more
// keys of their group, as JSON.
Scene river_with_crowd(std::uint64_t particles, int columns, int rows, std::map<std::string, std::string> more = {},
                       const std::string& who = R"("tau": 0.2)");

}  // namespace wade::bench
