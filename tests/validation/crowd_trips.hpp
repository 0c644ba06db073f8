#pragma once
// Crowds that walk to a goal: when each person passes a line, and whether bodies overlap or reach into walls meanwhile.

#include <functional>
#include <vector>

#include "crowd_route.hpp"
#include "crowd_run.hpp"

namespace wade::validation {

// A scene of configs/validation/ with a seed, and with settings that go before those of the request.
Scene people_scene(const Request& request, const std::string& name, std::uint64_t seed,
                   const std::vector<std::string>& settings = {});

// What is looked at after each step, over one run or several.
struct Tally {
    double steps = 0;        // of people
    double overlaps = 0;     // pairs of bodies that overlap
    double in_walls = 0;     // bodies that reach into an obstacle, centres beyond the edge of the world
    double deepest = 0;      // m, of both
    double left_behind = 0;  // people that have not passed their line at the end: largest of all runs
};

// Looks at the active agents as they stand.
void note_bodies(const crowd::CrowdWorld& crowd, Tally& tally);

// Adds overlaps, in_walls and left_behind to the metrics.
void report_tally(const Tally& tally, Result& result);

// When people passed the lines of their groups, s; NaN: not within the scene's duration.
struct Trip {
    std::vector<double> passed_at;  // by agent
    double end = 0;                 // of the run, s
};

// Walks until all people have passed the lines of their groups; the last line serves all further groups. `before_step`
// may set goals. The passing time is interpolated linearly within a step.
Trip walk_past(crowd::CrowdWorld& crowd, const std::vector<Gate>& lines, Result& result, Tally& tally,
               const crowd::WaterView& water = {}, const std::function<void()>& before_step = {});

// Returns the passing times of a group, s, ascending, without people that have not passed.
std::vector<double> times_of(const crowd::CrowdWorld& crowd, const Trip& trip, std::uint32_t group = 0);

// Returns the flow of the middle 80 % of passages, people a second; NaN for fewer than 20 passages.
double middle_flow(const std::vector<double>& times);

// People outside over time, a column a run, every `step` s until the last one is out.
Curve curve_of_leaving(const std::string& name, const std::vector<std::string>& columns,
                       const std::vector<std::vector<double>>& times, double step);

double mean(const std::vector<double>& values);

// Returns the greater value; NaN if one of them is NaN.
double worse(double a, double b);

}  // namespace wade::validation
