"""What is varied: the settings of a point, and the list of points to measure."""

import functools
import itertools
import json
from dataclasses import dataclass, replace

from wade.paths import CONFIGS
from wade.suites.cases import model_overrides

# Factors in the order of the table. They reach from careless to careful on both sides of the default:
# tolerances 1, 0.1 and 0.01 %, at least one iteration of the density solve instead of two, CFL 0.25, 0.5 and 1, all
# kernels, the divergence solve at three tolerances and off.
FACTORS = {
    "tolerance": (1e-2, 1e-3, 1e-4),
    "min_iterations": (1,),
    "divergence_tolerance": (1e-2, 1e-4, "off"),
    "cfl": (0.25, 1.0),
    "kernel": ("quartic_spline", "wendland_c2"),
    "threads": (2,),
}
KERNEL_WORDS = {"quartic_spline": "quartic", "wendland_c2": "wendland"}  # in labels
QUICK_FACTORS = {"tolerance": (1e-2,), "cfl": (1.0,)}

GRAVITY = 9.81  # m/s2, of every case that is swept

# Combinations are made of these: the number of threads changes no error.
COMBINED = ("tolerance", "min_iterations", "divergence_tolerance", "cfl", "kernel")

# The other models of the water, by the cases that they can run.
OTHER_MODELS = {
    "impulse_river": ("kinematic", "shallow_water", "steering", "mixed"),
    "impulse_front": ("shallow_water", "steering", "mixed"),
    "impulse_lee": ("shallow_water", "steering", "mixed"),
    "dam_break": ("shallow_water", "steering"),
    "bump_transcritical": ("shallow_water", "steering"),
    "bump_subcritical": ("shallow_water", "steering"),
}
SEEDS = (1, 2, 3, 4, 5)  # of the models other than DFSPH: some draw the positions of their particles


@dataclass(frozen=True)
class Setting:
    """One point: a case, a spacing in m, a model, and the values of the factors."""

    case: str
    spacing: float
    model: str = "dfsph"
    tolerance: float = 0.0
    min_iterations: int = 0  # of the density solve
    divergence_tolerance: object = 0.0  # a number or "off"
    cfl: float = 0.0
    kernel: str = ""
    threads: int = 1
    gravity_change: float = 0.0  # relative; see probes()
    seed: int = 0  # of another model; 0: that of the scene

    def key(self):
        """Name of the folder of its runs: letters, digits, '.', '-' and '_'."""
        name = f"{self.case}_d{self.spacing:g}_{self.model}_t{self.threads}"
        if self.model == "dfsph":
            name += f"_tol{self.tolerance:g}_it{self.min_iterations}_div{self.divergence_tolerance}"
            name += f"_cfl{self.cfl:g}_{self.kernel}"
        if self.gravity_change:
            name += f"_g{1 + self.gravity_change:.6g}"
        if self.seed:
            name += f"_seed{self.seed}"
        return name

    def resolution(self):
        return ["--spacing", f"{self.spacing:.10g}"]

    def overrides(self):
        """The values as options of `validate`. Every factor is set, whatever the scene of the case says."""
        if self.model != "dfsph":
            seed = [f"/seed={self.seed}"] if self.seed else []
            return [*model_overrides(self.model), *seed]
        values = [f"/fluid/density_solve/tolerance={self.tolerance:g}",
                  f"/fluid/density_solve/min_iterations={self.min_iterations}", f"/fluid/cfl={self.cfl:g}"]
        if self.divergence_tolerance == "off":
            values.append("/fluid/divergence_solve/max_iterations=0")
        else:
            values.append(f"/fluid/divergence_solve/tolerance={self.divergence_tolerance:g}")
        if self.kernel != schema_defaults()["kernel"]:
            values.append(f"/fluid/kernel={self.kernel}")
        if self.gravity_change:
            values.append(f"/world/gravity_m_s2={GRAVITY * (1 + self.gravity_change):.10g}")
        return values

    def label(self, default):
        """What distinguishes it from the default of its spacing, in a few characters."""
        if self.model != "dfsph":
            return self.model
        short = {
            "tolerance": "tol", "min_iterations": "it", "divergence_tolerance": "div", "cfl": "cfl", "kernel": "",
            "threads": "threads",
        }
        parts = []
        for name, word in short.items():
            value = getattr(self, name)
            if value != getattr(default, name):
                text = f"{value:g}" if isinstance(value, float) else KERNEL_WORDS.get(value, str(value))
                parts.append(f"{word} {text}".strip())
        return ", ".join(parts) or "default"


@functools.cache
def schema_defaults():
    """The defaults of the factors, read where they are defined."""
    fluid = json.loads((CONFIGS / "scene.schema.json").read_text())["properties"]["fluid"]["properties"]

    def tolerance(solve):
        return fluid[solve]["properties"]["tolerance"]["default"]

    return {
        "tolerance": tolerance("density_solve"),
        "min_iterations": fluid["density_solve"]["properties"]["min_iterations"]["default"],
        "divergence_tolerance": tolerance("divergence_solve"),
        "cfl": fluid["cfl"]["default"],
        "kernel": fluid.get("kernel", {}).get("default", "cubic_spline"),
    }


def default_setting(case, spacing):
    return Setting(case=case, spacing=spacing, **schema_defaults())


def one_at_a_time(case, spacing, factors):
    """The default and, for each factor, its other values with all else at the default."""
    default = default_setting(case, spacing)
    points = [default]
    for name, values in factors.items():
        points += [replace(default, **{name: v}) for v in values if v != getattr(default, name)]
    return points


def probes(case, spacing):
    """The default with a change that means nothing: 0.01 % of gravity.

    Splashing water is chaotic, so that the error of one run is in part chance. How far these runs lie apart says how
    small a difference between two settings may be before it says nothing.
    """
    default = default_setting(case, spacing)
    return [replace(default, gravity_change=change) for change in (-1e-4, 1e-4)]


def near_front(points, slack=0.1):
    """Keys of the points that no other one beats by more than `slack` in both cost and error.

    points: list of (key, cost, error), costs and errors positive.
    """
    keep = []
    for key, cost, error in points:
        limit_cost, limit_error = cost * (1 - slack), error * (1 - slack)
        beaten = any(c <= limit_cost and e <= limit_error for k, c, e in points if k != key)
        if not beaten:
            keep.append(key)
    return keep


def combinations(default, near):
    """Pairs and the one of all cheap values: settings that join changes which, alone, lie near the front.

    near: the settings near the front that differ from the default in one factor each.
    """
    changes = []
    for setting in near:
        for name in COMBINED:
            if getattr(setting, name) != getattr(default, name):
                changes.append((name, getattr(setting, name)))
    joined = []
    for size in (2, 3):
        for some in itertools.combinations(changes, size):
            names = [name for name, _ in some]
            if len(set(names)) == size:
                joined.append(replace(default, **dict(some)))
    return joined
