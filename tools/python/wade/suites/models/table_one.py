"""Table 1 of the paper by each model of the water: the scenes of a set as they are, with another /fluid/model."""

import json
from dataclasses import dataclass

from wade.paths import module_command
from wade.suites.cases import FOLLOWS_PEOPLE, model_changes
from wade.suites.paper import plan
from wade.suites.paper.ensembles import Ensembles, PlanError
from wade.suites.paper.results import Result
from wade.suites.paper.store import Store

SETS = ("river", "paper")
DEFAULT_MODEL = "dfsph"  # of the scenes of these sets


@dataclass
class ModelRuns:
    """Table 1 by one model in one set of scenes."""

    set: str
    model: str
    results: dict  # scenario -> Result
    costs: list  # of its waters: wall time of the solver, s a simulated second
    commits: tuple  # of the programs that made the runs


def cases_of(scene_set, model, quick):
    """The scenarios of Table 1 in the water of a model; those of the default model are the very cases of the paper."""
    suffix, changes = (model, model_changes(model)) if model != DEFAULT_MODEL else ("", ())
    names = plan.QUICK if quick else plan.SCENARIOS
    return {name: plan.scenario_case(scene_set, name, suffix, changes) for name in names}


class OwnWaters(Ensembles):
    """Each crowd in a run of its own, of water that follows its people."""

    run_folder = None  # of the run that began last

    def log(self, water):
        return self.run_folder / "run.log"

    def run_crowds(self, water, missing):
        for case, seed in missing:
            folder = self.run_folder = self.folder(case, seed)
            folder.mkdir(parents=True, exist_ok=True)
            scene = folder / "scene.json"
            scene.write_text(json.dumps(self.programs.scene_of(case, seed), indent=1) + "\n", encoding="utf-8")
            command = [*module_command("wade.run.pair"), scene, "--out", folder, "--no-figure", "--no-trajectories"]
            command += ["--water-every-s", "0", *self.programs.until(), "--threads", str(self.threads)]
            with open(self.log(water), "w", encoding="utf-8") as log:
                code = self.wait_for(self.pair.start(command, stdout=log, stderr=log), water)
            if code != 0 or self.pair.signal:
                return code
        return 0


def cost_of(runs):
    """Wall time of the solver a simulated second, s: of a water that its runs share the longest tells; None if not kept."""
    longest = max(runs, key=lambda run: run.outcome["sim_time_s"]).outcome
    wall = longest["fluid"].get("solver_wall_s")
    return wall / longest["sim_time_s"] if wall else None


def as_model_runs(scene_set, model, cases, ensembles):
    """None if there is no complete run."""
    of_case = {name: ensembles.runs[case.key] for name, case in cases.items() if ensembles.runs.get(case.key)}
    if not of_case:
        return None
    by_water = {}
    for name, runs in of_case.items():
        by_water.setdefault(cases[name].water, []).extend(runs)
    commits = sorted({run.outcome["commit"] for runs in of_case.values() for run in runs})
    return ModelRuns(scene_set, model, {n: Result(runs) for n, runs in of_case.items()},
                     list(map(cost_of, by_water.values())), tuple(commits))


def is_scene(programs, case, failures):
    """Whether the programs take the scene of a case; they say why not, and the failures name its water."""
    try:
        programs.resolved(case.water.scene, case.water.changes)
        programs.resolved(case.scene, case.water.changes + case.changes)
    except PlanError:
        if (failure := f"{case.water.key} (the scene is refused)") not in failures:
            failures.append(failure)
        return False
    return True


def run_table(programs, out, pair, chosen):
    """[ModelRuns] of each set and model, and what failed in words. What is complete is not run again."""
    out.mkdir(parents=True, exist_ok=True)
    store = Store(out / "runs.jsonl")
    shared, own = Ensembles(programs, out, pair, 1, store=store), OwnWaters(programs, out, pair, 1, store=store)
    wanted = {}
    for scene_set in chosen.sets:
        for model in chosen.models:
            cases = cases_of(scene_set, model, chosen.quick)
            wanted[scene_set, model] = {n: case for n, case in cases.items() if is_scene(programs, case, shared.failures)}
    found = {}
    for ensembles in (shared, own):
        of_these = {key: cases for key, cases in wanted.items() if (key[1] in FOLLOWS_PEOPLE) == (ensembles is own)}
        if not shared.interrupted:
            ensembles.run({case: (chosen.seeds, chosen.seeds) for cases in of_these.values() for case in cases.values()})
        found |= {key: as_model_runs(*key, cases, ensembles) for key, cases in of_these.items()}
    failures = [*shared.failures, *own.failures]
    return [found[key] for key in wanted if found.get(key)], failures, shared.interrupted or own.interrupted
