"""Runs the validation cases with each model; what is there already is not repeated."""

import hashlib
import json
from dataclasses import dataclass

from outcomes import COMPLETED, FAILED, LEFT_OUT, REFUSED, Outcome

from measure import Runner
from runs import LEVELS
from paths import ROOT
from water_models import model_overrides

NO_WATER = "crowd_"  # cases that begin so have no water


@dataclass(frozen=True)
class Point:
    """A case, one of its resolutions, and a model; as Runner takes it."""

    case: str
    level: str
    spacing: float  # m
    model: str
    further: tuple = ()  # (JSON pointer, value) that this model needs
    threads: int = 1

    def key(self):
        more = f"-{hashlib.sha256(repr(self.further).encode()).hexdigest()[:8]}" if self.further else ""
        return f"{self.case}-{self.level}-{self.model}{more}"

    def overrides(self):
        return [*model_overrides(self.model), *(f"{pointer}={json.dumps(value)}" for pointer, value in self.further)]


class LevelRunner(Runner):
    """Names the level, so that the spacing has all its digits and the limits are those of the level."""

    report_only = False  # takes what is there, by whatever programs, and runs nothing

    def resolution(self, setting):
        return ["--level", setting.level]

    further = {}  # model -> ((JSON pointer, value), ...)

    def document_of(self, point):
        """None if it must not be run and is not there."""
        if not self.report_only:
            return self.one_run(point, ROOT, 1)
        file = self.folder / point.key() / "repeat-1" / "result.json"
        return json.loads(file.read_text()) if file.is_file() else None

    def outcome(self, point):
        """None if there is none and nothing is to be run."""
        document = self.document_of(point)
        if document is None:
            return None
        base = {"case": point.case, "level": point.level, "model": point.model, "spacing": point.spacing}
        if document.get("refused"):
            return Outcome(**base, status=REFUSED, remark=reason(document["error"]))
        if "gave_up_after_s" in document:
            return Outcome(**base, status=LEFT_OUT, remark=document["error"])
        if document["status"] != "completed":
            return Outcome(**base, status=FAILED, remark=document["error"], commit=document.get("git", ""))
        if document["model"] != point.model:
            remark = f"the case runs {document['model']} whatever model is asked for"
            return Outcome(**base, status=REFUSED, remark=remark)
        return Outcome(
            **base, status=COMPLETED, metrics=document["metrics"], particles=document["particles"],
            cpu=document["solver_cpu_s"], simulated=document["simulated_s"], commit=document["git"],
        )


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


def run_cases(plan, models, recorded, runner, time_limit):
    """[Outcome] of a plan of (case, level), for each model.

    recorded: {(case, level): Outcome} of DFSPH, which take the place of runs. A finer run that is expected to take more
    CPU time than time_limit is left out, and so is one whose model the case has refused.
    """
    found = {}
    for case, level in plan:
        for model in models:
            found[case.name, level, model] = one(case, level, model, recorded, runner, time_limit, found)
    return list(found.values())


def one(case, level, model, recorded, runner, time_limit, found):
    if model == "dfsph" and (case.name, level) in recorded and not runner.further.get(model):
        return recorded[case.name, level]
    spacing = case.spacings[LEVELS.index(level)]
    before = [found.get((case.name, coarser, model)) for coarser in LEVELS[: LEVELS.index(level)]]
    coarser = next((outcome for outcome in reversed(before) if outcome is not None), None)
    blank = Outcome(case.name, level, model, spacing, LEFT_OUT)
    if coarser is not None and coarser.status == REFUSED:
        blank.status, blank.remark = REFUSED, coarser.remark
        return blank
    if coarser is not None and coarser.status in (FAILED, LEFT_OUT):
        blank.remark = f"{coarser.level} has no result"
        return blank
    expected = seconds_expected(coarser, spacing)
    if expected > time_limit:
        blank.remark = f"expected to take {expected:.0f} s of CPU time (--time-limit {time_limit:g})"
        return blank
    blank.remark = "not run"
    return runner.outcome(Point(case.name, level, spacing, model, runner.further.get(model, ()))) or blank
