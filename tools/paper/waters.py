"""The waters and crowds of the report: a run of the fluid, and a crowd that walks through it."""

from dataclasses import dataclass
from pathlib import Path

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
KINEMATIC = ("observed",)  # sets whose water is not solved
SCENARIOS = tuple(f"S{i}" for i in range(1, 13))
V_F = {0: 0.5, 1: 1.5, 2: 2.5}  # m/s, S1, S2, S3, then again
OTHERS_V_F = {"two_groups": 1.5, "no_obstacle": 1.5, "tau_switch": 2.5}  # m/s


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
    scene: Path  # whose crowd, coupling and events it has
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
    """A scenario beside Table 1; those without solids and with the river in its place share its waters."""
    scene = scene_of(scene_set, scenario)
    if scenario in ("obstacle", "village", "agents_5000", "fine"):
        return Case(Water(scene_set, scenario + suffix, scene, water_changes), scenario, scene)
    velocity = OTHERS_V_F.get(scenario, 1.5)
    return Case(stream(scene_set, velocity, suffix.lstrip("-"), water_changes), scenario, scene)


def changed_crowd(scene_set, scenario, suffix, changes):
    """A scenario of the paper with a changed crowd, in the water that it has."""
    case = scenario_case(scene_set, scenario) if scenario in SCENARIOS else other_case(scene_set, scenario)
    return Case(case.water, f"{case.name}-{suffix}", case.scene, changes)
