#pragma once
// A hard case of the stability suite: a scene, or several, that has broken other engines, and what must hold in it.

#include <cstdint>
#include <string>
#include <vector>

#include "configs/scene/scene.hpp"

namespace wade::stability {

// The rules that every case is judged by.
struct Rules {
    // Mean over the particles of max(0, rho / rho_0 - 1), at every step. 1 %: water in a column of 1 m may not lose
    // more than a tenth of a layer at ten layers.
    static constexpr double mean_compression = 0.01;
    // Kinetic and potential energy over what was there at the start and was put in since. 5 % above 1 leaves room for
    // the order of the time integration, not for an instability, which grows without bound.
    static constexpr double energy_ratio = 1.05;
    // The kinetic energy alone over what could become kinetic, with the same 5 %: in a closed channel that leaves out the
    // potential energy of a level pool, beside which the energy of a wave is small.
    static constexpr double kinetic_ratio = 1.05;
    // Displacement of a particle in one step over the spacing: beyond a half it could pass a neighbour or a wall
    // unseen.
    static constexpr double displacement = 0.5;
};

// A number and what must hold of it.
struct Check {
    enum class Rule { at_most, less_than, at_least, report };  // report: not judged
    std::string name;                                          // lower case with underscores
    double value = 0;
    Rule rule = Rule::report;
    double limit = 0;

    [[nodiscard]] bool holds(double bound) const;  // a NaN never holds
    [[nodiscard]] bool passes() const { return holds(limit); }
    [[nodiscard]] std::string rule_text() const;  // "<= 0.01"; empty if it is not judged
};

struct Result {
    std::string model = "dfsph";
    std::size_t particles = 0;         // the most at any time
    std::size_t steps = 0;             // of the solver
    double simulated_time = 0;         // s
    double cpu_time = 0;               // s, of the process
    double mean_density_error = 0;     // fraction, largest of all steps
    double max_density_error = 0;      // fraction, of any particle in any step
    double energy_ratio = 0;           // see Rules
    double kinetic_ratio = 0;          // see Rules
    double max_displacement = 0;       // spacings
    std::uint64_t lost_particles = 0;  // outside the solids, moved back by the last guard, or missing from the count
    std::uint64_t nonfinite = 0;       // particles with a position or velocity that is not finite, or agents
    std::uint64_t state_hash = 0;      // over the bits of all particles after each frame
    std::string failure;               // message of a run that was given up; empty = it went through
    std::vector<Check> checks;         // particular to the case
    std::vector<std::string> remarks;
};

// The rules that hold for every case, then the checks of this one.
[[nodiscard]] std::vector<Check> all_checks(const Result& result);

// Whether all of them pass.
[[nodiscard]] bool passes(const Result& result);

struct Request {
    std::vector<std::string> overrides;  // "/pointer=value", applied to each scene that the case loads
    bool quick = false;                  // a smaller or shorter form
    bool long_form = false;              // the long form of cases that have one
};

struct Case {
    std::string name;
    std::string trouble;  // what goes wrong elsewhere
    Result (*run)(const Request& request) = nullptr;
    bool varied = true;  // run with every solver setting; false: the solver plays no part
};

// One function a family of cases.
std::vector<Case> water_cases();     // still water, jets, sheets
std::vector<Case> sloshing_cases();  // waves in a tank
std::vector<Case> inflow_cases();    // emitter, outlet, recirculation
std::vector<Case> particle_cases();  // none, one, two at one position, long runs
std::vector<Case> likeness_cases();  // the same flow in another scale, or cut into other frames
std::vector<Case> crowd_cases();     // people in and out of the water

// All cases, in the order of the report.
const std::vector<Case>& all_cases();

// configs/stability/NAME.json, or NAME of tests/stability/scenes.json, with the overrides of the case's quick form, if that is asked for, then the request's.
Scene scene_for(const Request& request, const std::string& name, const std::vector<std::string>& quick_overrides = {});

// Adds a check with the rule "value <= limit".
void check_at_most(Result& result, const std::string& name, double value, double limit);
// "value >= limit".
void check_at_least(Result& result, const std::string& name, double value, double limit);
// Reported only.
void note(Result& result, const std::string& name, double value);

}  // namespace wade::stability
