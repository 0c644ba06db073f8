#pragma once
// People as a scene describes them, in groups, in tables, and in the houses of a site.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "configs/numbers/normal.hpp"

namespace wade {

// A point of a tau history.
struct TauPoint {
    double time = 0;
    double tau = 0;
};

enum class SexRule {
    any,  // each of its own, half and half
    female,
    male
};
enum class Skill { braced, good, normal, unaware, poor, by_size };  // in standing against water, see people_in_water.md

// The bodies of people, as water sees them; the mass is AgentGroup::mass.
struct BodySettings {
    std::optional<Spread> height;  // none: by age and sex
    SexRule sex = SexRule::any;
    Spread age = 30;  // years
    Skill skill = Skill::by_size;
    std::optional<Spread> ground_friction;  // of the feet; else that of the skill
    std::optional<double> bracing_arm;      // lambda; else that of the skill
    bool can_swim = false;
};

enum class HandInHand { none, along_x, along_z };  // neighbours on the start grid that hold one another
enum class Hold { hands, arms };                   // hands pull, arms across backs push, too

// A person of a table; what is not set is as its group says.
struct PersonRow {
    std::optional<double> height, mass, age, ground_friction, bracing_arm;
    std::optional<SexRule> sex;
    std::optional<Skill> skill;
    std::optional<bool> can_swim;
    std::vector<TauPoint> tau_history;
};

// A row of a site's table of residents.
struct Resident {
    std::string id;                   // as the table has it
    std::size_t line = 0;             // of the table
    double x = 0, z = 0;              // m; in a house: indoors
    std::string group;                // empty: the first that starts in houses
    std::optional<double> leaves_at;  // s; none: as its group says
    PersonRow person;
};

enum class StartRule { grid, houses };    // a start grid, or the houses of the site and its table of residents
enum class GoalRule { point, shelters };  // one point, or the first shelter of the site that is reached

// When people leave their houses.
enum class LeavingRule { at_once, normal, weibull, table, never };
struct LeavingPoint {
    double time = 0;   // s
    double share = 1;  // fraction of the people that has left by then
};
struct Leaving {
    LeavingRule rule = LeavingRule::at_once;
    double after = 0;             // s; earliest departure
    double mean = 0, sd = 0;      // of `normal`, after that, s
    double scale = 0, shape = 2;  // of `weibull`, after that; scale in s
    std::vector<LeavingPoint> table;
    double stay_share = 0;         // fraction of people that never leave
    double upper_floor_share = 0;  // fraction of the others that goes to the upper floor at its time, if there is one
};

struct AgentGroup {
    std::string name;
    StartRule starts = StartRule::grid;
    GoalRule goals = GoalRule::point;
    bool warned = true;         // knows where the water is, however far away
    Leaving leaving;            // with StartRule::houses
    int columns = 1, rows = 1;  // start grid, columns along x, rows along z
    int count = 1;              // agents placed, column by column is row-major: id = row * columns + column
    double start_x = 0, start_z = 0, pitch_x = 1, pitch_z = 1;
    double goal_x = 0, goal_z = 0;  // in a periodic world x counts on over the periods
    double desired_speed = 1.3;
    double start_jitter = 0;            // largest distance of a start from its grid point, along x and along z
    std::optional<Spread> mass;         // none: by age and sex
    std::optional<Spread> tau = 0;      // susceptibility, [0, 1] (paper: endurance), 0: not moved; none: by the bodies
    std::vector<TauPoint> tau_history;  // in time; empty: `tau` throughout
    BodySettings body;
    HandInHand hand_in_hand = HandInHand::none;
    Hold hold = Hold::hands;
    bool rescuer = false;           // goes to people swept away and throws a line
    std::vector<PersonRow> people;  // the agents are these in turn
};

}  // namespace wade
