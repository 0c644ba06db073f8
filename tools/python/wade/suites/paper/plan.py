"""What each part of the report needs: waters, and the crowds that walk through each of them.

One run of the fluid serves every crowd of its water: scenarios that differ in tau, groups, events, contact rule
or seed.
"""

from dataclasses import dataclass
from pathlib import Path

from wade.paths import CONFIGS

KINEMATIC = ("observed",)  # sets with prescribed water, not solved
SCENARIOS = tuple(f"S{i}" for i in range(1, 13))
V_F = {0: 0.5, 1: 1.5, 2: 2.5}  # m/s, S1, S2, S3, then again
OTHERS_V_F = {"two_groups": 1.5, "no_obstacle": 1.5, "tau_switch": 2.5}  # m/s
SETS = ("observed", "paper", "river", "manning")
QUICK = ("S1", "S4", "S5", "S8")
PUSHED = ("S4", "S5", "S6", "S7", "S8", "S10")  # scenarios that distinguish one interpretation from another
OTHERS = ("two_groups", "no_obstacle", "obstacle", "tau_switch")
PHASE_TAU = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
PHASE_V_F = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0)  # m/s
SPACINGS = (0.5, 0.25)  # m, beside 0.4642
MAX_PARTICLES = 300000  # enough for the smallest of them
EMITTER_PUSHES = (1.4, 1.6)  # speed of the emitter over v_F, beside 1; both were chosen afterwards
FRAME_RATES = (15, 60)  # 1/s, beside 30
OBSTACLE_AT = 60  # m, x_min that the scenes assume
SKILLS = ("braced", "good", "normal", "unaware", "poor")
EARTH = "g9.81", (("/world/gravity_m_s2", 9.81),)
PAPER_V_F = tuple(V_F.values())
MEASURED_V_F = {"river": (0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5), "observed": PAPER_V_F, "paper": PAPER_V_F}  # m/s
QUICK_V_F = (0.5, 1.5)  # m/s
OBSTACLE_V_F = 1.5  # m/s
MEASURED_OTHERS = tuple((name, v) for v in (1.5, 0.75) for name in ("two_groups", "obstacle", "no_obstacle"))
PUSHING = ("S5", "no_obstacle", "obstacle_of_people")  # scenarios of two-way coupling
PUSHED_AT = (("normal", 0.75), ("braced", 1.0))  # skill, m/s: where some arrive and some do not
WAYS = tuple((two_way, shelter) for two_way in (False, True) for shelter in (False, True))
ON_PARTICLES = (("S5", "normal", 0.75),)  # the same by dfsph, ten times as expensive; the crowd of Table 1 only
CELLS = (("/fluid/model", "shallow_water"), ("/fluid/shallow_water/cell_size_m", 0.5))
FINE = ("S5", "S8", "S11", "two_groups")  # what v_F 1.5 m/s has to compare


@dataclass(frozen=True)
class Water:
    """One run of the fluid: a scene with some values changed."""

    set: str
    name: str  # folder in that of the set
    scene: Path
    changes: tuple = ()  # of (JSON pointer, value)

    @property
    def key(self):
        return f"{self.set}/{self.name}"


@dataclass(frozen=True)
class Case:
    """One crowd in a water, to be run with several seeds."""

    water: Water
    name: str
    scene: Path  # source of its crowd, coupling and events
    changes: tuple = ()  # of (JSON pointer, value), of crowd, coupling and events

    @property
    def key(self):
        return f"{self.water.key}/{self.name}"


def scene_of(scene_set, scenario):
    name = f"s{int(scenario[1:]):02d}" if scenario in SCENARIOS else scenario
    return CONFIGS / scene_set / f"{name}.json"


def velocity_of(scenario):
    """v_F of a scenario of Table 1, m/s."""
    return V_F[(int(scenario[1:]) - 1) % 3]


def has_scene(scene_set, name):
    """Not every set has the scenes beside Table 1: kinematic water, for one, does not flow round obstacles."""
    return scene_of(scene_set, name).is_file()


def stream(scene_set, velocity, suffix="", changes=()):
    """The water of Table 1 with v_F; a suffix names what else is changed."""
    scenario = {0.5: "S1", 1.5: "S2", 2.5: "S3"}.get(velocity)
    name = f"v{velocity:g}" + (f"-{suffix}" if suffix else "")
    if scenario:
        return Water(scene_set, name, scene_of(scene_set, scenario), changes)
    return Water(scene_set, name, scene_of(scene_set, "S2"), (("/channel/velocity_m_s", velocity), *changes))


def scenario_case(scene_set, scenario, suffix="", water_changes=()):
    """A scenario of Table 1, as it is or in a changed water."""
    water = stream(scene_set, velocity_of(scenario), suffix, water_changes)
    return Case(water, scenario.lower(), scene_of(scene_set, scenario))


def other_case(scene_set, scenario, suffix="", water_changes=()):
    """Returns a scenario beside Table 1; those without solids and with the same river share the waters of Table 1."""
    scene = scene_of(scene_set, scenario)
    if scenario in ("obstacle", "village", "agents_5000", "fine"):
        return Case(Water(scene_set, scenario + suffix, scene, water_changes), scenario, scene)
    velocity = OTHERS_V_F.get(scenario, 1.5)
    return Case(stream(scene_set, velocity, suffix.lstrip("-"), water_changes), scenario, scene)


def changed_crowd(scene_set, scenario, suffix, changes):
    """A scenario of the paper with a changed crowd, in the water that it has."""
    case = scenario_case(scene_set, scenario) if scenario in SCENARIOS else other_case(scene_set, scenario)
    return Case(case.water, f"{case.name}-{suffix}", case.scene, changes)


def table1_cases(scene_set, quick=False):
    return [scenario_case(scene_set, name) for name in SCENARIOS if not quick or name in QUICK]


def others_cases(scene_set):
    return [other_case(scene_set, name) for name in OTHERS if has_scene(scene_set, name)]


def faster(scenario, push):
    """The changes of an emitter's water that is `push` times as fast as v_F."""
    velocity = velocity_of(scenario) if scenario in SCENARIOS else OTHERS_V_F.get(scenario, 1.5)
    return () if push == 1 else (("/channel/velocity_m_s", round(push * velocity, 6)),)


def contact_cases(scene_set):
    """The contact rule of the paper's text."""
    sums = (("/coupling/contact_rule", "sum"),)
    return [changed_crowd(scene_set, name, "sum", sums) for name in (*PUSHED, "two_groups")]


def continuous_cases(scene_set):
    """The coupling that does not depend on the frame rate."""
    rule = (("/coupling/rule", "continuous"),)
    return [changed_crowd(scene_set, name, "continuous", rule) for name in (*PUSHED, "two_groups")]


def water_readings(scene_set):
    """Returns {what: (suffix, changes of the water)} of the interpretations that need waters of their own."""
    readings = {}
    for spacing in SPACINGS:
        changes = ("/fluid/particle_spacing_m", spacing), ("/fluid/max_particles", MAX_PARTICLES)
        readings[f"spacing {spacing:g} m"] = f"d{spacing:g}", changes
    for rate in FRAME_RATES:
        readings[f"{rate} frames/s"] = f"{rate}hz", (("/frame_rate_hz", rate),)
    if scene_set == "observed":
        readings["particles at random in their cells"] = "random", (("/fluid/kinematic/arrangement", "random"),)
        readings["particles in a lattice without jitter"] = "lattice", (("/fluid/kinematic/jitter", 0),)
        readings["transported at v_F"] = "carried1", (("/fluid/kinematic/transport_factor", 1),)
        filled = (("/channel/initial_river", "filled"), ("/fluid/kinematic/transport_factor", 1))
        readings["filled at the start, transported at v_F"] = "filled", filled
    if scene_set == "paper":
        readings["gravity 9.81 m/s2"] = EARTH
        readings["filled at the start"] = "filled", (("/channel/initial_river", "filled"),)
    return readings


def reading_of(scene_set, suffix, changes):
    """The scenarios that the water pushes, and two groups, in a changed water."""
    cases = [scenario_case(scene_set, name, suffix, changes) for name in PUSHED]
    return [*cases, other_case(scene_set, "two_groups", f"-{suffix}" if suffix else "", changes)]


def emitter_case(scenario, push):
    """Returns a scenario of Table 1 with a dry start and faster water."""
    return scenario_case("paper", scenario, f"push{push:g}", faster(scenario, push))


def emitter_cases(scene_set, push):
    """Returns the scenarios that the water pushes, and two groups, with a dry start and faster water."""
    if scene_set != "paper":
        return []
    groups = other_case(scene_set, "two_groups", f"-push{push:g}", faster("two_groups", push))
    return [*(emitter_case(name, push) for name in PUSHED), groups]


def reading_cases(scene_set):
    cases = [case for push in EMITTER_PUSHES for case in emitter_cases(scene_set, push)]
    for suffix, changes in water_readings(scene_set).values():
        solved = suffix in ("g9.81", "filled",
                            "d0.5") and scene_set != "manning"  # its depth sets its spacing
        if scene_set in KINEMATIC or solved:
            cases += reading_of(scene_set, suffix, changes)
    return cases


def phase_case(tau, velocity):
    return Case(stream("observed", velocity), f"tau{tau:g}", scene_of("observed", "S5"), (("/crowd/tau", tau),))


def phase_cases():
    return [phase_case(tau, velocity) for velocity in PHASE_V_F for tau in PHASE_TAU]


def coarse_cases(scene_set):
    """The same crowds as fine_cases() through the usual particles."""
    return [scenario_case(scene_set, name) if name in SCENARIOS else other_case(scene_set, name) for name in FINE]


def fine_cases(scene_set):
    """Crowds through ten times the particles."""
    water = other_case(scene_set, "fine").water
    return [Case(water, name.lower(), scene_of(scene_set, name)) for name in FINE]


def particles_cases(scene_set):
    return coarse_cases(scene_set) + fine_cases(scene_set)


def measured_water(scene_set, velocity):
    """The water of Table 1 with the gravity of the earth, which the weight on people's feet needs."""
    return stream(scene_set, velocity, *(() if scene_set == "river" else EARTH))


def measured_case(scene_set, velocity, skill):
    """The crowd of Table 1, of people of a skill."""
    return Case(measured_water(scene_set, velocity), f"measured-{skill}", scene_of(scene_set, "S5"), by_body(skill))


def measured_other(scenario, velocity, skill):
    """A scenario of the river beside Table 1, of people of a skill."""
    water = other_case("river", scenario).water
    if scenario != "obstacle":
        water = stream("river", velocity)
    elif velocity != OBSTACLE_V_F:
        water = Water("river", f"obstacle-v{velocity:g}", water.scene, (("/channel/velocity_m_s", velocity),))
    return Case(water, f"{scenario}-measured-{skill}", scene_of("river", scenario), by_body(skill))


def measured_pushing(scenario, velocity, skill, two_way, shelter, cells=True):
    """Returns a crowd with or without two-way coupling and shelter, in a river of cells or of particles."""
    if not (cells or two_way or shelter):
        return measured_case("river", velocity, skill)  # of ON_PARTICLES, which are crowds of Table 1
    suffix = f"measured-{skill}" + ("-pushes" if two_way else "") + ("-wake" if shelter else "")
    changes = ("/coupling/two_way", two_way), ("/coupling/shelter", "wake" if shelter else "off")
    water = stream("river", velocity, "cells", CELLS) if cells else stream("river", velocity)
    return Case(water, f"{scenario.lower()}-{suffix}", scene_of("river", scenario), by_body(skill) + changes)


def measured_seeds(case, seeds):
    """Returns the number of seeds: fewer with two-way coupling, as each crowd needs a run of the water."""
    if ("/coupling/two_way", True) not in case.changes:
        return seeds
    return min(seeds, 3 if case.water.changes[-len(CELLS):] == CELLS else 1)


def by_body(skill):
    return ("/crowd/response", "measured"), ("/crowd/skill", skill)


def measured_cases(scene_set, quick=False):
    """Returns one-way cases in the waters of the paper and between them, and few two-way cases, as each needs its own
    water."""
    if quick:
        return [measured_case(scene_set, velocity, skill) for velocity in QUICK_V_F for skill in SKILLS[::2]
                if scene_set == "observed"]
    cases = [measured_case(scene_set, v, skill) for v in MEASURED_V_F.get(scene_set, ()) for skill in SKILLS]
    if scene_set == "river":
        cases += [measured_other(name, velocity, skill) for name, velocity in MEASURED_OTHERS for skill in SKILLS]
        cases += [measured_pushing(name, velocity, skill, *ways) for name in PUSHING for skill, velocity in PUSHED_AT
                  for ways in WAYS]
        cases += [measured_pushing(name, v, skill, *ways, cells=False) for name, skill, v in ON_PARTICLES for ways in WAYS]
    return cases


PARTS = {
    "table1": "S1 to S12 beside the paper's Table 1, with the bands",
    "others": "two groups, obstacle, switch of tau",
    "rules": "contact rule of the text, continuous coupling",
    "readings": "spacings, frame rates, starts, gravity, speed of the emitter",
    "particles": "ten times the particles",
    "phase": "who arrives over the plane of tau and v_F (set observed)",
    "plane": "who arrives over the plane of depth and v_F (set observed)",
    "measured": "people who answer the water by their bodies: who arrives at which skill, what two ways change",
    "figures": "pictures in the paper's style",
}


def cases_of(part, sets, quick=False):
    """The cases of a part in these sets of scenes."""
    of_set = {
        "table1": lambda s: table1_cases(s, quick), "others": others_cases,
        "rules": lambda s: contact_cases(s) + continuous_cases(s), "readings": reading_cases,
        "particles": lambda s: particles_cases(s) if has_scene(s, "fine") else [],
        "measured": lambda s: measured_cases(s, quick),
    }
    if part in of_set:
        return [case for scene_set in sets for case in of_set[part](scene_set)]
    return phase_cases() if part == "phase" and "observed" in sets else []
