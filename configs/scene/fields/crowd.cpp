// Keys of the crowd.

#include "configs/scene/crowd.hpp"

#include <algorithm>

#include "configs/scene/coupling.hpp"
#include "configs/scene/fields/lists.hpp"
#include "configs/scene/person_size.hpp"

namespace wade {

namespace {

// Where keys of a site act, and those of a channel.
const Acting beside_site{"beside /site", [](const Scene& scene) { return scene.site.has_value(); }, true};

// Whether people of a group answer the water by their bodies; of the crowd, whether some do.
bool answers_by_body(const Scene& scene, const AgentGroup* group) {
    const std::vector<AgentGroup>& groups = scene.crowd->groups;
    const auto has_no_tau = [](const AgentGroup& one) { return !one.tau; };
    return scene.crowd->response == ResponseKind::measured &&
           (group ? has_no_tau(*group) : groups.empty() || std::any_of(groups.begin(), groups.end(), has_no_tau));
}

// Whether some of a group, or of the crowd, have a size that follows age and sex.
bool has_children(const Scene& scene, const AgentGroup* group) {
    const auto are = [](const std::vector<PersonRow>& people) {
        return std::any_of(people.begin(), people.end(),
                           [](const PersonRow& row) { return row.age && *row.age < adult_age; });
    };
    const auto has = [&](const AgentGroup& one) { return one.body.age.lo < adult_age || are(one.people); };
    const std::vector<AgentGroup>& groups = scene.crowd->groups;
    return are(scene.crowd->people) || (group ? has(*group) : std::any_of(groups.begin(), groups.end(), has));
}

// Where keys of people act: of a group, or of the crowd without one.
Acting by_body(const AgentGroup* group) {
    return {"with /crowd/response \"measured\" and no tau of the group",
            [group](const Scene& scene) { return answers_by_body(scene, group); }};
}
Acting with_bodies(const AgentGroup* group) {
    return {
        "with /crowd/response \"measured\" and no tau of the group, beside /site, with /crowd/poses or for people "
        "below 20 years",
        [group](const Scene& scene) {
            return answers_by_body(scene, group) || scene.site || scene.crowd->pose_rate > 0 ||
                   has_children(scene, group);
        }};
}
// The height, in addition, of people that the water knows of.
Acting with_heights(const AgentGroup* group) {
    return {
        "with /crowd/response \"measured\" and no tau of the group, beside /site, with /crowd/poses, "
        "/coupling/agents_stream or for people below 20 years",
        [group](const Scene& scene) {
            return with_bodies(group).here(scene) || scene.coupling->agents_stream != AgentsStream::off;
        }};
}

}  // namespace

void fields(EvasionSettings& evasion, Fields& f) {
    f.choice("rule", evasion.rule,
             "off: as in the source, agents do not look at the water. flee: one with water within the radius, all on "
             "one side of it, goes the opposite way instead of towards its goal. evasion: away from where that water "
             "will be. Agents surrounded by water go on towards the goal.");
    f.acts_only(
        {"with /crowd/evasion/rule \"flee\" or \"evasion\"",
         [&](const Scene&) { return evasion.rule != EvasionRule::off; }},
        [&] { f.number("radius_m", evasion.radius, "m", above(0).to(2), "Distance within which water is seen."); });
    f.acts_only(
        {"with /crowd/evasion/rule \"evasion\"", [&](const Scene&) { return evasion.rule == EvasionRule::evasion; }},
        [&] {
            f.number("prediction_s", evasion.prediction, "s", from(0).to(10),
                     "Longest time that agents look ahead; they take the distance over their desired speed if "
                     "that is less.");
        });
}

void fields(NavigationSettings& navigation, Fields& f) {
    f.choice(
        "rule", navigation.rule,
        "straight: as in the source, towards the goal; agents slide along an obstacle, or may stand before one that "
        "they meet face to face. travel_time: the quickest way round the obstacles, at least "
        "body_radius_m (0.72 of it with bodies) away from them where the ground allows it, by a field of the "
        "travel time to each goal "
        "(fast marching); towards the goal once it is in sight. An agent that starts without a way to its goal "
        "is refused. auto: travel_time for a goal as soon as an obstacle stands between it and an agent "
        "with that goal, looked for once a second, with cells small enough for each gap that a person fits through; "
        "straight, without any cost, where none does. With crowding always travel_time.");
    f.number("cell_m", navigation.cell, "m", from(0.1).to(10),
             "Largest cell of the field; where a site has no cell_m, as large as a million cells of it are. Gaps "
             "between obstacles must be a cell plus 2 body_radius_m (1.44 with bodies) "
             "wide to be found "
             "for certain; auto takes smaller cells for narrower gaps, down to 0.1 m.");
    f.number("crowding", navigation.crowding, "", from(0).to(10),
             "How much people in the way count: agents expect to walk at the speed of Weidmann's curve for so many "
             "times the density of people there, and choose ways round crowds, also where the goal is in sight. 0: "
             "not at all. 1: as measured crowds are slowed.");
    f.acts_only({"beside /site or with /crowd/navigation/crowding above 0",
                 [&](const Scene& scene) { return scene.site || navigation.crowding > 0; }},
                [&] {
                    f.number("every_s", navigation.every, "s", from(0).to(1e6),
                             "Time after which the fields are solved again for where people are, and in a site for "
                             "the water; 0: once, for the start.");
                });
    f.acts_only(beside_site, [&] {
        f.choice("slope", navigation.slope,
                 "level: slopes change no speed. tobler: people walk at exp(-3.5 |S + 0.05|) / exp(-0.175) times "
                 "their speed, S the rise of the ground along their way (Tobler 1993).");
        f.acts_only({"with a group that is not warned",
                     [](const Scene& scene) {
                         const std::vector<AgentGroup>& groups = scene.crowd->groups;
                         return std::any_of(groups.begin(), groups.end(),
                                            [](const AgentGroup& group) { return !group.warned; });
                     }},
                    [&] {
                        f.number("sight_m", navigation.sight, "m", from(0).to(1000),
                                 "How far ahead on its route an unwarned person sees water, as long as no house "
                                 "hides it.");
                    });
        f.number("enters_up_to_m", navigation.enters_up_to, "m", from(0).to(10),
                 "The deepest water that people walk into, 0.61 in LifeSim.", otherwise("by their stability alone"));
        f.number("safe_above_m", navigation.safe_above, "m", from(-1000).to(10000),
                 "Height above which ground is as good as a shelter.", otherwise("no ground is"));
    });
}

void fields(RagdollRule& ragdoll, Fields& f) {
    f.choice("condition", ragdoll.condition,
             "paper: tau >= tau_min and v_F > speed_m_s, v_F that of the channel at this time. local_speed: the same "
             "with the speed of the water at the agent, which differs from v_F where a front arrives or an obstacle "
             "stands. depth_speed: depth times speed of the water at the agent >= depth_speed_m2_s, whatever tau. At "
             "the agent: in its cell of 2 x 2 m.");
    const auto is = [&](RagdollCondition condition) { return ragdoll.condition == condition; };
    f.acts_only({"with /crowd/ragdoll/condition \"paper\" or \"local_speed\"",
                 [=](const Scene&) { return is(RagdollCondition::paper) || is(RagdollCondition::local_speed); }},
                [&] {
                    f.number("tau_min", ragdoll.tau_min, "", from(0).to(1), "Smallest tau.");
                    f.number("speed_m_s", ragdoll.speed, "m/s", from(0).to(1000), "Speed that must be exceeded.");
                });
    f.acts_only({"with /crowd/ragdoll/condition \"depth_speed\"",
                 [=](const Scene&) { return is(RagdollCondition::depth_speed); }},
                [&] {
                    f.number("depth_speed_m2_s", ragdoll.depth_speed, "m2/s", from(0).to(1000),
                             "Smallest depth times speed, begin of the level High of Table 2.");
                });
    f.acts_only({"with a /crowd/ragdoll/condition", [=](const Scene&) { return !is(RagdollCondition::off); }}, [&] {
        f.flag("random_sign", ragdoll.random_sign,
               "The random part of the rotation rates, uniform in 0.1 to 0.5 rad/s. false: added, as in the paper's "
               "text. true: added or subtracted with equal chance, as in the authors' code.");
    });
}

void fields(PathSettings& paths, Fields& f) {
    f.number(
        "rate_hz", paths.rate, "1/s", from(0.01).to(10000),
        "Frames of the paths in a second of simulated time, at most: a frame is each n-th step of the crowd, n the "
        "least whole number for which step_rate_hz / n is not more. From step_rate_hz on each step is one.");
}

namespace {

KeyValue value_of(const Spread& spread) {
    return spread;
}
KeyValue value_of(bool flag) {
    return flag;
}
template <typename Choice>
KeyValue value_of(Choice choice) {
    return name_of(choice);
}

// Ranges of the keys of a person, in groups and in tables.
constexpr Range height_range = from(0.5).to(2.5), mass_range = above(0).to(1000), age_range = from(3).to(110),
                friction_range = from(0.01).to(2), arm_range = from(0.005).to(0.5);

// The size of a group that sets none: that of the crowd, or that of adults. None where it follows the ages, as
// of children in a crowd that is not one of children.
Presence size_by_age(const BodySettings& body, const AgentGroup& of_crowd, const std::optional<Spread>& size,
                     double adult) {
    return otherwise("that of crowd, or by age and sex", [&body, &of_crowd, &size, adult] {
        const bool children = are_children(body.age), of_children = are_children(of_crowd.body.age);
        if (size && children == of_children) return KeyValue(*size);
        return children ? KeyValue() : KeyValue(Spread(adult));
    });
}

// Declares the keys of bodies: of `group` with the defaults of `its_crowd`, or of the crowd if both are null.
void fields(BodySettings& body, Fields& f, const AgentGroup* group, const AgentGroup* its_crowd) {
    const BodySettings* const of_crowd = its_crowd == nullptr ? nullptr : &its_crowd->body;
    const auto unless_set = [&](auto member) {
        if (of_crowd == nullptr) return preset;
        return otherwise("that of crowd", [=] { return value_of(of_crowd->*member); });
    };
    f.acts_only(with_bodies(group), [&] {
        f.spread(
            "age", body.age, "years", age_range,
            "Age. Below 20 years height and mass follow age and sex where they are not given (growth charts of the "
            "CDC, 2000), and those of a group with adults hold for its adults alone. For walking_in_water bernardini, "
            "too.",
            unless_set(&BodySettings::age));
    });
    f.acts_only(with_heights(group), [&] {
        f.spread("height_m", body.height, "m", height_range, "Height of a person.",
                 its_crowd == nullptr ? otherwise("1.7, or by age and sex")
                                      : size_by_age(body, *its_crowd, of_crowd->height, PersonSize().height));
    });
    f.acts_only(with_bodies(group), [&] {
        f.choice("sex", body.sex, "any: half of the people are female. Men walk faster in water.",
                 unless_set(&BodySettings::sex));
        f.choice("skill", body.skill,
                 "How well people stand against water: friction of the feet mu and arm lambda of the weight over the "
                 "height. by_size: normal; unaware of small children, with height times mass up to 25 m kg; and "
                 "from there to 50 m kg between both. braced: 0.80, 0.20, leaning against the stream. good: 0.64, "
                 "0.10. normal: 0.45, 0.09. unaware: 0.34, 0.04, as a dummy. poor: 0.07, 0.011.",
                 unless_set(&BodySettings::skill));
        f.spread("ground_friction", body.ground_friction, "", friction_range,
                 "mu of the ground in place of that of the skill: ice 0.1, mud 0.3, rough stone 0.8.",
                 otherwise("that of crowd, or of the skill", [=] {
                     return of_crowd == nullptr || !of_crowd->ground_friction ? KeyValue()
                                                                              : KeyValue(*of_crowd->ground_friction);
                 }));
        f.number("bracing_arm", body.bracing_arm, "", arm_range,
                 "lambda, arm of the weight over the height, in place of that of the skill.",
                 otherwise("that of crowd, or of the skill", [=] {
                     return of_crowd == nullptr || !of_crowd->bracing_arm ? KeyValue()
                                                                          : KeyValue(*of_crowd->bracing_arm);
                 }));
    });
    f.acts_only(by_body(group), [&] {
        f.flag("can_swim", body.can_swim,
               "Whether floating people swim towards their goal, at 0.45 m/s through the water. Their hazard of "
               "drowning is then a quarter.",
               unless_set(&BodySettings::can_swim));
    });
}

// The two coordinates of a point that some groups have; a sentence if one is missing.
std::optional<std::string> take_point(const std::optional<double>& x, const std::optional<double>& z, bool needs_none,
                                      double& to_x, double& to_z) {
    to_x = x.value_or(0);
    to_z = z.value_or(0);
    if (needs_none || (x && z)) return std::nullopt;
    return std::string("the required key \"") + (x ? "z_m" : "x_m") + "\" is missing";
}

// A table of people, as lists of a scene or from a file.
void table_of_people(std::vector<PersonRow>& people, Fields& f, const AgentGroup* group) {
    const Presence as_group = otherwise("that of the group");
    f.of_file(
        "people_csv", TextRule{1},
        "File of people, relative to this one: names of keys of people in the first line, then a line a person. It "
        "takes the place of people.");
    f.list("people", people, "People one by one: the agents take them in turn, from the first again after the last.",
           [&](PersonRow& row, Fields&) {
               f.acts_only(with_heights(group),
                           [&] { f.number("height_m", row.height, "m", height_range, "Its height.", as_group); });
               f.number("mass_kg", row.mass, "kg", mass_range, "Its mass.", as_group);
               f.acts_only(with_bodies(group), [&] {
                   f.choice("sex", row.sex, "Its sex.", as_group);
                   f.number("age", row.age, "years", age_range, "Its age.", as_group);
                   f.choice("skill", row.skill, "Its skill.", as_group);
                   f.number("ground_friction", row.ground_friction, "", friction_range, "mu of the ground.", as_group);
                   f.number("bracing_arm", row.bracing_arm, "", arm_range, "Its lambda.", as_group);
               });
               f.acts_only(by_body(group), [&] { f.flag("can_swim", row.can_swim, "Whether it swims.", as_group); });
               f.list("tau_history", row.tau_history,
                      "Its tau in time, where the group has a tau. In a file: time_s:tau, a space, and so on.");
           });
}

}  // namespace

void fields(LeavingPoint& point, Fields& f) {
    f.number("time_s", point.time, "s", from(0).to(1e6), "Time of the point.", required);
    f.number("share", point.share, "", from(0).to(1), "Share of them that has left by then.", required);
}

void fields(Leaving& leaving, Fields& f) {
    f.choice("rule", leaving.rule,
             "at_once: at after_s. normal: mean_s and sd_s later, at after_s at the earliest. weibull: 1 - exp(-(t / "
             "scale_s)^shape) of them within t after after_s. table: by shares in time. never: all stay.");
    const auto is = [&](LeavingRule rule) { return leaving.rule == rule; };
    f.acts_only({"with leaves/rule \"at_once\", \"normal\" or \"weibull\"",
                 [=](const Scene&) { return !is(LeavingRule::table) && !is(LeavingRule::never); }},
                [&] { f.number("after_s", leaving.after, "s", from(0).to(1e6), "Earliest time of leaving."); });
    f.acts_only({"with leaves/rule \"normal\"", [=](const Scene&) { return is(LeavingRule::normal); }}, [&] {
        f.number("mean_s", leaving.mean, "s", from(0).to(1e6), "Mean time.");
        f.number("sd_s", leaving.sd, "s", from(0).to(1e6), "Standard deviation.");
    });
    f.acts_only({"with leaves/rule \"weibull\"", [=](const Scene&) { return is(LeavingRule::weibull); }}, [&] {
        f.number("scale_s", leaving.scale, "s", from(0).to(1e6), "Scale, by which 63 % have left.");
        f.number("shape", leaving.shape, "", from(0.1).to(20), "Shape; 2 is Rayleigh's curve.");
    });
    f.acts_only({"with leaves/rule \"table\"", [=](const Scene&) { return is(LeavingRule::table); }}, [&] {
        f.list("table", leaving.table,
               "Points in order of time: straight between them, and those beyond the last share stay.");
    });
    f.acts_only({"with another leaves/rule than \"never\"", [=](const Scene&) { return !is(LeavingRule::never); }},
                [&] {
                    f.number("stay_share", leaving.stay_share, "", from(0).to(1),
                             "Fraction of the people without a time of their own that stay for good.");
                });
    f.number("upper_floor_share", leaving.upper_floor_share, "", from(0).to(1),
             "Of all, how many go to the upper floor at their time, if their house has one, and stay there.");
}

void fields(AgentGroup& group, Fields& f, const AgentGroup& of_crowd) {
    f.text("name", group.name, short_name,
           "Name in events and logs, one of its own for each group: letters, digits, '_', '-' and '.'.", required);
    const Acting on_grid{"with start/from \"grid\"", [&](const Scene&) { return group.starts == StartRule::grid; }};
    f.acts_only(on_grid, [&] {
        f.whole("columns", group.columns, "", from(1).to(1e5), "Agents of the start grid along x.");
        f.whole("rows", group.rows, "", from(1).to(1e5), "Agents of the start grid along z.");
        f.whole("count", group.count, "", from(1).to(1e6),
                "Agents placed on the grid; the last row may stay incomplete.", otherwise("columns * rows", [&] {
                    // A printed scene states the residents of a group that starts in houses.
                    const bool of_houses = group.starts == StartRule::houses;
                    return KeyValue(of_houses ? std::int64_t{group.count} : std::int64_t{group.columns} * group.rows);
                }));
    });
    f.object(
        "start",
        [&] {
            f.choice("from", group.starts,
                     "grid: on the start grid. houses: the residents of the houses of the site, and the people of its "
                     "residents_csv that name this group; the first such group has people that name none. They start "
                     "indoors, or where the table says.");
            std::optional<double> x = group.start_x, z = group.start_z;
            f.acts_only(on_grid, [&] {
                f.number("x_m", x, "m", from(0).to(1e5), "x of the first column.", otherwise("none from houses"));
                f.number("z_m", z, "m", from(0).to(1e5), "z of the first row.", otherwise("none from houses"));
                f.number("pitch_x_m", group.pitch_x, "m", from(0).to(10000), "Distance of the columns.");
                f.number("pitch_z_m", group.pitch_z, "m", from(0).to(10000), "Distance of the rows.");
            });
            f.once_read(
                [&] { return take_point(x, z, group.starts == StartRule::houses, group.start_x, group.start_z); });
            f.number("jitter_m", group.start_jitter, "m", from(0).to(1000),
                     "Each agent starts at random, uniformly, up to this far from its place on the grid along x and "
                     "along z; at the edges of the world the deviation is mirrored inwards. A start in an obstacle or "
                     "within 1 mm of another one is drawn again; the pitch may then be 0.");
        },
        "Where they start.", required);
    f.acts_only({"with start/from \"houses\"", [&](const Scene&) { return group.starts == StartRule::houses; }, true},
                [&] {
                    f.object("leaves", group.leaving,
                             "When people indoors come out of their door. A table's leaves_at stands over it.");
                });
    f.acts_only(beside_site, [&] {
        f.flag("warned", group.warned,
               "Whether they know where the water is however far away it is, or only once they see it before them.");
    });
    f.object(
        "goal",
        [&] {
            f.choice("to", group.goals,
                     "point: to one place. shelters: to whichever shelter of the site with room, or high ground "
                     "(/crowd/navigation/safe_above_m), takes the least time.");
            std::optional<double> x = group.goal_x, z = group.goal_z;
            f.acts_only({"with goal/to \"point\"", [&](const Scene&) { return group.goals == GoalRule::point; }}, [&] {
                f.number("x_m", x, "m", from(-100000).to(1e5),
                         "x of the goal, in the world. Where world.ends is periodic it may lie beyond either end: the "
                         "agent walks that far, lap by lap, so that a goal far away is a direction.",
                         otherwise("none to shelters"));
                f.number("z_m", z, "m", from(0).to(1e5), "z of the goal.", otherwise("none to shelters"));
            });
            f.once_read(
                [&] { return take_point(x, z, group.goals == GoalRule::shelters, group.goal_x, group.goal_z); });
        },
        "Where the group wants to go.", required);
    f.number("desired_speed_m_s", group.desired_speed, "m/s", from(0).to(10),
             "Speed at which an agent walks when nothing holds it up.",
             otherwise("that of crowd", [&] { return KeyValue(of_crowd.desired_speed); }));
    f.spread("tau", group.tau, "", from(0).to(1),
             "How much the water moves an agent: 0 not at all, 1 like a body without resistance. With min and max each "
             "agent has a tau of its own, drawn uniformly.",
             otherwise("that of crowd", [&] { return of_crowd.tau ? KeyValue(*of_crowd.tau) : KeyValue(); }));
    f.list(
        "tau_history", group.tau_history,
        "tau in time, in place of one for all times: points in order of time, straight between them, constant before "
        "the first and after the last, until an event sets another.");
    f.once_read([&]() -> std::optional<std::string> {
        if (!group.tau_history.empty() && !group.tau) group.tau = group.tau_history.front().tau;  // not by its body
        return std::nullopt;
    });
    fields(group.body, f, &group, &of_crowd);
    f.spread("mass_kg", group.mass, "kg", mass_range,
             "m_a, mass of an agent. With min and max each agent has a mass of its own, drawn uniformly.",
             size_by_age(group.body, of_crowd, of_crowd.mass, PersonSize().mass));
    f.choice(
        "hand_in_hand", group.hand_in_hand,
        "Whether the group walks hand in hand: neighbours of the start grid along x or along z hold one another until "
        "more than a hand can hold is asked for 0.3 s. With the response measured, and a pitch of 0.8 m at most.");
    f.acts_only({"with hand_in_hand", [&](const Scene&) { return group.hand_in_hand != HandInHand::none; }}, [&] {
        f.choice("hold", group.hold,
                 "How: hands pull, 220 N at most, 140 N of women. arms, across backs, also push as much, as a file in "
                 "a stream needs.");
    });
    f.flag("rescuer", group.rescuer,
           "Whether they go to people carried within 20 m, as far as they stand safely, throw a line of 15 m and "
           "bring in the person on it. Their goal is where they wait; they arrive there last. With the response "
           "measured.");
    table_of_people(group.people, f, &group);
}

void fields(Rope& rope, Fields& f) {
    f.object(
        "from",
        [&] {
            f.number("x_m", rope.from_x, "m", from(0).to(1e5), "x of the end.", required);
            f.number("z_m", rope.from_z, "m", from(0).to(1e5), "z of the end.", required);
        },
        "Where it is fixed.", required);
    f.object(
        "to",
        [&] {
            f.number("x_m", rope.to_x, "m", from(0).to(1e5), "x of the end.", otherwise("the rope has a free end"));
            f.number("z_m", rope.to_z, "m", from(0).to(1e5), "z of the end.", otherwise("the rope has a free end"));
        },
        "Where its other end is fixed; it is taut.");
    f.number("free_length_m", rope.free_length, "m", from(0).to(100),
             "Length of a rope that is fixed at one end; the other lies down the stream. 0: a post.",
             otherwise("it is fixed at both ends"));
}

void fields(Crowd& crowd, Fields& f, double frame_rate) {
    f.choice(
        "response", crowd.response,
        "How agents answer the water. paper: the momentum of the particles that touch them moves them, Eq. 6-9, by tau "
        "and "
        "/coupling/rule. measured: by their bodies, with drag, buoyancy and what their feet hold, as people in flumes; "
        "they slide, topple, drift, get up and drown. Groups with a tau of their own, and agents that get one by an "
        "event, "
        "answer as paper.");
    f.acts_only(by_body(nullptr), [&] {
        f.choice("walking_in_water", crowd.walking_in_water,
                 "How fast people walk in water. relative: a share of their speed on dry ground. "
                 "bernardini: speeds measured by age, never above that on dry ground.");
        f.flag("fatigue", crowd.fatigue,
               "Legs that hold against the water tire, down to what a dummy holds, and so do hands that "
               "hold "
               "others, by a model of muscles; they rest where there is little to hold.");
        f.number("water_temperature_c", crowd.water_temperature, "C", from(0).to(40),
                 "Cold water weakens legs and hands in time, shortens the breath under water, and ends "
                 "how long one swims.",
                 otherwise("it is not cold"));
        f.estimate(
            "drift_hazard_per_s", crowd.drift_hazard, "1/s", from(0).to(1), "under",
            "Hazard of drowning of people adrift, afloat or carried where the depth is a quarter "
            "of their height or more, after the first 20 s of a drift. Best acts; low and high are for reports. "
            "Multipliers: docs/people_in_water.md. under: a drifting mouth counts as under water, that of a swimmer "
            "never.");
        f.number("air_budget_s", crowd.air_budget, "s", from(20).to(90),
                 "How long air lasts while the mouth is held under water; in water of a given "
                 "temperature at most 15.01 + 0.92 s a degree.");
        f.flag("helping", crowd.helping,
               "A standing person with a free hand takes hold of people carried past within 0.8 m.");
    });
    f.list(
        "ropes", crowd.ropes,
        "Response measured: ropes in the water. People with both hands free who are carried past one or walk along it, "
        "within 0.8 m, hold on to it, with 440 N at most, 280 N of women.");
    f.choice("speed_rule", crowd.speed_rule,
             "Reading of Eq. 4, m the sum of the weighted ways to the markers. pi: speed min(pi |m| / 1 s, desired "
             "speed), so that a free agent walks at 0.99 of it. per_frame: way min(|m|, desired speed * dt) in a step. "
             "per_second: speed min(|m| / 1 s, desired speed).");
    f.number(
        "step_rate_hz", crowd.step_rate, "1/s", from(0.01).to(10000),
        "Steps of the crowd in a second of simulated time. Above frame_rate_hz the crowd walks several steps through "
        "one frame of the water, below it some frames pass between two steps; each step uses the newest frame.",
        otherwise("frame_rate_hz", [=] { return KeyValue(frame_rate); }));
    f.whole("markers_per_cell", crowd.markers_per_cell, "", from(1).to(1000), "Markers in each cell of 2 x 2 m.");
    f.number("marker_min_distance_m", crowd.marker_min_distance, "m", from(0).to(2),
             "Smallest distance of two markers.");
    f.choice("markers", crowd.markers,
             "fixed: drawn once, at random with the minimum distance, as in the source. redrawn: drawn anew every "
             "marker_epoch_s, one in each of sqrt(markers_per_cell) x sqrt(markers_per_cell) sub-cells, so that "
             "crossing crowds do not lock; no memory, and the crowd steps faster.");
    f.acts_only({"with /crowd/markers \"redrawn\"", [&](const Scene&) { return crowd.markers == MarkerRule::redrawn; }},
                [&] {
                    f.number("marker_epoch_s", crowd.marker_epoch, "s", from(0).to(1e6),
                             "Time after which markers are redrawn; 0: in each step.");
                });
    f.choice("bodies", crowd.bodies,
             "none: BioCrowds as in the source, agents are points. fast, human: agents are discs that never overlap "
             "one another or an obstacle, whatever pushes them, and that get past one another: an agent that is "
             "pressed or met turns the shoulders, to 0.72 of body_radius_m at least, passes on the right, or steps "
             "back. They decide "
             "every 0.1 s at any rate of steps but 8.5 to 10 a second, where they decide once a step. Agents that "
             "start too close are moved apart. fast: as fast as the way is free. human: slower the less ground is free "
             "among "
             "people in the same direction, as Weidmann's curve of measured crowds. Meant for redrawn markers: with "
             "fixed ones crossing crowds lock.");
    f.number("body_radius_m", crowd.body_radius, "m", above(0).to(0.5),
             "Radius of the discs as long as nothing presses them. Navigation keeps this distance from obstacles, or "
             "0.72 of it with bodies; so gaps of 0.36 m are ways for bodies of 0.25 m.");
    f.object("evasion", crowd.evasion,
             "Whether agents step back from water that comes towards them (steering behaviours of Reynolds 1999).");
    f.object("navigation", crowd.navigation, "How agents find the way to their goal.");
    f.number("perception_radius_m", crowd.perception_radius, "m", above(0).to(2),
             "R: an agent perceives markers within it; at most the size of a cell.");
    f.acts_only({"with a group with goal/to \"point\"",
                 [&](const Scene&) {
                     return crowd.groups.empty() ||
                            std::any_of(crowd.groups.begin(), crowd.groups.end(),
                                        [](const AgentGroup& group) { return group.goals == GoalRule::point; });
                 }},
                [&] {
                    f.number("goal_radius_m", crowd.goal_radius, "m", above(0).to(1000),
                             "An agent this close to its goal has arrived and is removed.");
                });
    f.object("ragdoll", crowd.ragdoll,
             "Data for animators (ragdoll.csv): where the water tumbles a character. It changes no path. A row for "
             "each agent and frame of the paths while the condition holds and particles touch the agent, most of the "
             "time.");
    f.object("paths", crowd.paths, "How often positions are written (trajectories.sqlite, ragdoll.csv).");
    f.object(
        "poses",
        [&] {
            f.number("rate_hz", crowd.pose_rate, "1/s", from(0).to(10000),
                     "Frames in a second of simulated time, at most: a frame is each n-th step of the crowd, n the "
                     "least whole number for which step_rate_hz / n is not more. 0: no file, at no cost.");
        },
        "How each person holds itself, for animators (poses.csv): heading, lean, gait, hip, turning, hands. It changes "
        "no path.");
    AgentGroup of_crowd;  // what groups take that set none
    f.shorthands([&] {
        f.acts_only({"with another /crowd/response than \"measured\"",
                     [&](const Scene&) { return crowd.response != ResponseKind::measured; }},
                    [&] {
                        f.spread("tau", of_crowd.tau, "", from(0).to(1),
                                 "tau of the groups that set none. With the response measured people of these answer "
                                 "by their bodies.");
                    });
        f.spread("mass_kg", of_crowd.mass, "kg", mass_range, "Mass of the agents of groups that set none.",
                 otherwise("65, or by age and sex"));
        f.number("desired_speed_m_s", of_crowd.desired_speed, "m/s", from(0).to(10),
                 "Desired speed of the agents of groups that set none.");
        fields(of_crowd.body, f, nullptr, nullptr);
    });
    if (crowd.response == ResponseKind::measured) of_crowd.tau.reset();  // their bodies tell
    table_of_people(crowd.people, f, nullptr);
    f.list("groups", crowd.groups,
           "Groups of agents. Agents are numbered from 0 through all groups in order, in a group row by row.",
           [&](AgentGroup& group, Fields&) { fields(group, f, of_crowd); });
}

}  // namespace wade
