"""Runs the validation cases with each model: what it makes of a case at a resolution, and how that stands to the limits. What is
there already is not repeated.
"""

import math
from dataclasses import dataclass, field

from wade import progress
from wade.reports.tables import number, write_csv
from wade.suites.cases import LEVELS, model_overrides

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
                       *costs, outcome.commit, ""]


def write_table(file, outcomes, limits):
    write_csv(file, COLUMNS, [row for outcome in outcomes for row in rows_of(outcome, limits)])


NO_WATER = "crowd_"  # cases that begin so have no water


@dataclass(frozen=True)
class Point:
    """A case, one of its resolutions, and a model; as Runner takes it."""

    case: str
    level: str
    spacing: float  # m
    model: str
    threads: int = 1

    def key(self):
        return f"{self.case}-{self.level}-{self.model}"

    def resolution(self):
        """The level, so that the spacing has all its digits and the limits are those of the level."""
        return ["--level", self.level]

    def overrides(self):
        return model_overrides(self.model)


def outcome_of(point, document):
    base = {"case": point.case, "level": point.level, "model": point.model, "spacing": point.spacing}
    if document.get("refused"):
        return Outcome(**base, status=REFUSED, remark=reason(document["error"]))
    if "gave_up_after_s" in document:
        return Outcome(**base, status=LEFT_OUT, remark=document["error"])
    if document["status"] != "completed":
        return Outcome(**base, status=FAILED, remark=document["error"], commit=document.get("git", ""))
    if document["model"] != point.model:
        return Outcome(**base, status=REFUSED, remark=f"the case runs {document['model']} whatever model is asked for")
    return Outcome(**base, status=COMPLETED, metrics=document["metrics"], particles=document["particles"],
                   cpu=document["solver_cpu_s"], simulated=document["simulated_s"], commit=document["git"])


def reason(error):
    """What a program says of a model that it refuses, without its name and that of the file."""
    words = error.splitlines()[-1] if error else "refused without a word"
    at = words.find("/fluid/model: ")
    return words[at + len("/fluid/model: ") :] if at >= 0 else words.removeprefix("validate: ")


def water_cases(cases):
    return [case for case in cases if not case.name.startswith(NO_WATER)]


def seconds_expected(coarser, spacing):
    """CPU time at a finer spacing, s: the particles of a volume grow with d^-3 and the steps with 1/d. 0 if nothing is
    known."""
    if coarser is None or coarser.status != COMPLETED:
        return 0
    return coarser.cpu * (coarser.spacing / spacing) ** 4


def run_cases(plan, models, runner):
    """[Outcome] of a plan of (case, level), for each model.

    A finer run is left out if it is expected to take more CPU time than the runner's limit, or if the case refused its
    model before.
    """
    found = {}
    for case, level, model in progress.over([(*place, model) for place in plan for model in models], "runs cases by models"):
        found[case.name, level, model] = one(case, level, model, runner, found)
    return list(found.values())


def one(case, level, model, runner, found):
    spacing = case.spacings[LEVELS.index(level)]
    before = [found.get((case.name, coarser, model)) for coarser in LEVELS[: LEVELS.index(level)]]
    coarser = next((outcome for outcome in reversed(before) if outcome is not None), None)
    expected = seconds_expected(coarser, spacing)
    status, remark = LEFT_OUT, ""
    if coarser is not None and coarser.status == REFUSED:
        status, remark = REFUSED, coarser.remark
    elif coarser is not None and coarser.status in (FAILED, LEFT_OUT):
        remark = f"{coarser.level} has no result"
    elif expected > runner.time_limit:
        remark = f"expected to take {expected:.0f} s of CPU time (--time-limit {runner.time_limit:g})"
    if remark:
        return Outcome(case.name, level, model, spacing, status, remark)
    point = Point(case.name, level, spacing, model)
    return outcome_of(point, runner.one_run(point))
