#pragma once
// Runs a crowd without water in this process, and what several cases measure of it.

#include <cstddef>
#include <string>
#include <vector>

#include "crowd_client/crowd_world.hpp"
#include "validation_case.hpp"

namespace wade::validation {

// The levels of the crowd's cases: mean distance of the markers, 1 / sqrt(markers per m2), for the paper's 16 markers
// per m2, for 32 and for 64.
extern const std::vector<double> marker_spacings;

// A scene of configs/ with the markers of the request: 4 / spacing^2 in a cell of 2 x 2 m, at least 0.4 spacings apart
// (the paper's 0.1 m for its 0.25 m).
Scene crowd_scene(const Request& request, const std::string& name);

// Takes a step, on dry ground unless there is water, and counts it in the result.
void walk(crowd::CrowdWorld& crowd, Result& result, const crowd::WaterView& water = {});

// Starts a result: the model's name and the number of agents.
Result crowd_result();

// Coordinate along a periodic world that counts on over the ends, m.
double unrolled_x(const crowd::CrowdWorld& crowd, std::size_t id);

// Moves each agent at random, by up to `amplitude_x` and `amplitude_z` m; the scene's seed determines the moves.
void jitter(crowd::CrowdWorld& crowd, double amplitude_x, double amplitude_z);

// Half of the width that an agent takes up as it stands now, m; without bodies that of `body_radius`.
double half_width(const crowd::CrowdWorld& crowd, std::uint32_t id);

// Discs of their half widths round the agents that overlap, over several samples.
struct Overlaps {
    double samples = 0;      // agents summed over samples
    double overlapping = 0;  // of them, agents that overlap another
    double pairs = 0;
    double depth_sum = 0;  // m
    double deepest = 0;    // m
};

// Looks at the active agents as they stand.
void note_overlaps(const crowd::CrowdWorld& crowd, Overlaps& overlaps);

// Adds overlap_share, overlap_depth_mean and overlap_depth_max to the metrics, with a suffix.
void report_overlaps(const Overlaps& overlaps, const std::string& suffix, Result& result);

}  // namespace wade::validation
