"""Runs the validation cases with each model; what is there already is not repeated."""

from dataclasses import dataclass

from wade.suites.cases import LEVELS, model_overrides
from wade.suites.models.outcomes import COMPLETED, FAILED, LEFT_OUT, REFUSED, Outcome

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

    A finer run that is expected to take more CPU time than the runner's limit is left out, and so is one whose model the
    case has refused.
    """
    found = {}
    for case, level in plan:
        for model in models:
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
