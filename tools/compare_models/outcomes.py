"""What a model makes of a case at a resolution, and how that stands to the limits."""

import math
from dataclasses import dataclass, field

import paths  # noqa: F401  it says where `runs` is

from runs import LEVELS

COMPLETED, REFUSED, FAILED, LEFT_OUT = "completed", "refused", "failed", "left out"


@dataclass
class Outcome:
    """One run, or why there is none."""

    case: str
    level: str
    model: str
    spacing: float  # m
    status: str
    remark: str = ""  # why it is not completed
    metrics: list = field(default_factory=list)  # of {"name", "value" (None: could not be measured), "unit"}
    particles: int = 0  # or cells of a grid
    cpu: float = 0.0  # of the solver, s
    simulated: float | None = None  # s
    source: str = ""  # the file that it was read from; "": run here
    commit: str = ""

    @property
    def cost(self):
        """CPU time of the solver a simulated second; None if it is not known."""
        return self.cpu / self.simulated if self.simulated else None

    def value(self, name):
        return next((metric["value"] for metric in self.metrics if metric["name"] == name), None)


@dataclass
class Judged:
    """A metric that has a limit."""

    name: str
    value: float | None
    limit: float

    @property
    def ratio(self):
        """Of value to limit; 1 is just kept. Infinite if not measured, or if more than a limit of 0."""
        if self.value is None:
            return math.inf
        if self.limit == 0:
            return 0.0 if self.value <= 0 else math.inf
        return self.value / self.limit


def judged_metrics(outcome, limits):
    """limits: {(case, metric, level): limit or None}, as results.Judge has them."""
    found = [(metric, limits.get((outcome.case, metric["name"], outcome.level))) for metric in outcome.metrics]
    return [Judged(metric["name"], metric["value"], limit) for metric, limit in found if limit is not None]


def worst(outcome, limits):
    """The metric that is nearest to its limit or furthest above it; None if none has a limit or the run is not
    complete."""
    if outcome.status != COMPLETED:
        return None
    return max(judged_metrics(outcome, limits), key=lambda judged: judged.ratio, default=None)


def missed(outcome, limits):
    return [judged for judged in judged_metrics(outcome, limits) if judged.ratio > 1]


def level_of(spacings, spacing):
    """The resolution that has this spacing; None if none has."""
    near = (level for level, d in zip(LEVELS, spacings) if math.isclose(d, spacing, rel_tol=1e-4))
    return next(near, None)
