"""What a model makes of a case at a resolution, and how that stands to the limits."""

import math
from dataclasses import dataclass, field

from wade.reports.tables import number, write_csv

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


COLUMNS = (
    "case,model,level,spacing_m,status,particles,metric,value,unit,limit,met,cpu_s,simulated_s,cpu_s_per_sim_s,commit,remark"
).split(",")


def exact(value, digits=8):
    return number(value, digits, none="")


def rows_of(outcome, limits):
    start = [outcome.case, outcome.model, outcome.level, f"{outcome.spacing:g}", outcome.status]
    if outcome.status != COMPLETED:
        yield start + [""] * 9 + [outcome.commit, outcome.remark]
    costs = [exact(value, 6) for value in (outcome.cpu, outcome.simulated, outcome.cost)]
    for metric in outcome.metrics:
        limit = limits.get((outcome.case, metric["name"], outcome.level))
        met = "" if limit is None else "yes" if Judged(metric["name"], metric["value"], limit).ratio <= 1 else "no"
        yield start + [outcome.particles, metric["name"], exact(metric["value"]), metric["unit"], exact(limit), met,
                       *costs,
                       outcome.commit, ""]


def write_table(file, outcomes, limits):
    write_csv(file, COLUMNS, [row for outcome in outcomes for row in rows_of(outcome, limits)])
