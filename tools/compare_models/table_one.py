"""Table 1 of the paper by each model of the water: the scenes of a set as they are, with another /fluid/model."""

import json
import os
import threading
from dataclasses import dataclass
from pathlib import Path

from paths import ROOT  # it says where the modules of tools/paper are, too

import plan
from ensembles import Ensembles, PlanError, is_done
from known_scene import same_scene
from store import Store
from table1 import Result
from water_models import FOLLOWS_PEOPLE, model_changes
from words import SET_UPS

SETS = ("river", "paper")
DEFAULT_MODEL = "dfsph"  # of the scenes of these sets
SAMPLED_EVERY_S = 0.5
SERVER_CPU = "server_cpu_s"  # of the water of a run, kept with the run


@dataclass
class ModelRuns:
    """Table 1 by one model in one set of scenes."""

    set: str
    model: str
    results: dict  # scenario -> Result
    costs: dict  # key of the water -> Cost
    commits: tuple  # of the programs that made the runs
    source: str = ""  # where they were read from; "": made here

    @property
    def set_up(self):
        return SET_UPS[self.set]


@dataclass
class Cost:
    """Of the server of one water, s a simulated second."""

    cpu: float | None  # CPU time; None where nobody took it
    solver_wall: float | None  # wall time of the solver alone


def cases_of(scene_set, model, quick, further=()):
    """The scenarios of Table 1 in the water of a model; those of the default model are the very cases of tools/paper.

    further: (JSON pointer, value) that the model needs besides.
    """
    suffix, changes = (model, (*model_changes(model), *further)) if model != DEFAULT_MODEL else ("", tuple(further))
    names = plan.QUICK if quick else plan.SCENARIOS
    return {name: plan.scenario_case(scene_set, name, suffix, changes) for name in names}


def server_below(pid):
    """The process fluid_server that a process has started; None while there is none."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        programs = {child: Path(f"/proc/{child}/cmdline").read_text().split("\0")[0] for child in children}
        return next((child for child, program in programs.items() if Path(program).name == "fluid_server"), None)
    except OSError:
        return None


def cpu_time_of(pid):
    """CPU time of a process so far, s; None if it is gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return None
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class TimedEnsembles(Ensembles):
    """Notes the CPU time of the server of each water in its folder, cost.json, as of the last look before its end, and
    keeps it with each run."""

    def kept_besides(self, case, _seed):
        return {SERVER_CPU: server_cpu(self.out / case.water.key)}

    def wait_for(self, process, water):
        return self.wait_and_time(process, water, self.out / water.key)

    def wait_and_time(self, process, water, folder):
        times, over = {}, threading.Event()  # by process: the first one may only check the scene

        def look():
            while not over.wait(SAMPLED_EVERY_S):
                server = server_below(process.pid)
                times[server] = (cpu_time_of(server) if server else None) or times.get(server, 0)

        watcher = threading.Thread(target=look, daemon=True)
        watcher.start()
        try:
            code = super().wait_for(process, water)
        finally:
            over.set()
            watcher.join()
        (folder / "cost.json").write_text(json.dumps({"server_cpu_s": sum(times.values())}) + "\n")
        return code


class OwnWaters(TimedEnsembles):
    """Each crowd in a run of its own, of water that follows its people."""

    run_folder = None  # of the run that began last

    def kept_besides(self, case, seed):
        return {SERVER_CPU: server_cpu(self.folder(case, seed))}

    def log(self, water):
        return self.run_folder / "run.log"

    def run_crowds(self, water, missing):
        for case, seed in missing:
            folder = self.run_folder = self.folder(case, seed)
            folder.mkdir(parents=True, exist_ok=True)
            scene = folder / "scene.json"
            scene.write_text(json.dumps(self.programs.scene_of(case, seed), indent=1) + "\n", encoding="utf-8")
            launcher = ["/usr/bin/python3", ROOT / "tools" / "run_pair.py", "--programs", self.programs.folder]
            command = [*launcher, scene, "--out", folder, "--no-figure", "--no-trajectories", "--water-every-s", "0"]
            command += [*self.programs.until(), "--threads", str(self.threads)]
            with open(self.log(water), "w", encoding="utf-8") as log:
                process = self.pair.start(command, stdout=log, stderr=log)
                code = self.wait_and_time(process, water, folder)
            if code != 0 or self.pair.signal:
                return code
        return 0


def server_cpu(folder):
    """CPU time of the server that was noted in a folder, s; None if there is none."""
    try:
        return json.loads((folder / "cost.json").read_text())[SERVER_CPU] or None
    except (OSError, ValueError, KeyError):
        return None


def cost_of(runs):
    """What the server of a water took. The time it simulated is that of the crowd that walked for longest, which ends
    it."""
    longest = max(runs, key=lambda run: run.outcome["sim_time_s"]).outcome
    return cost_over(longest["sim_time_s"], longest.get(SERVER_CPU), longest["fluid"].get("solver_wall_s"))


def cost_of_own(runs):
    """The same of runs that have a water each."""

    def total(values):
        return None if None in values else sum(values)

    cpu = total([run.outcome.get(SERVER_CPU) for run in runs])
    wall = total([run.outcome["fluid"].get("solver_wall_s") for run in runs])
    return cost_over(sum(run.outcome["sim_time_s"] for run in runs), cpu, wall)


def cost_over(time, cpu, wall):
    return Cost(cpu / time if cpu else None, wall / time if wall else None)


def as_model_runs(scene_set, model, cases, ensembles, source=""):
    """None if there is no complete run."""
    of_case = {name: ensembles.runs[case.key] for name, case in cases.items() if ensembles.runs.get(case.key)}
    if not of_case:
        return None
    by_water = {}
    for name, runs in of_case.items():
        by_water.setdefault(cases[name].water, []).extend(runs)
    cost = cost_of_own if model in FOLLOWS_PEOPLE else cost_of
    costs = {water.key: cost(runs) for water, runs in by_water.items()}
    commits = sorted({run.outcome["commit"] for runs in of_case.values() for run in runs})
    return ModelRuns(scene_set, model, {n: Result(runs) for n, runs in of_case.items()}, costs, tuple(commits), source)


class RunsToRead(Store):
    """runs.jsonl of another campaign."""

    def add(self, *_):
        """Changes nothing there."""


class Campaign(Ensembles):
    """Reads the runs of another folder of this command or of tools/reproduce_paper.sh, from its runs.jsonl and its run
    folders, and changes nothing there.

    A run by programs that did not know some key yet counts if the key has its default now: a feature that is off
    changes nothing.
    """

    def __init__(self, programs, folder):
        super().__init__(programs, folder, None, 1, keep_all=True, store=RunsToRead(folder / "runs.jsonl"))

    def kept_besides(self, case, seed):
        own = server_cpu(self.folder(case, seed))
        return {SERVER_CPU: server_cpu(self.out / case.water.key) if own is None else own}

    def has_folder(self, case, seed):
        folder, scene = self.folder(case, seed), self.programs.scene_of(case, seed)
        if is_done(folder, scene):
            return True
        try:
            kept = json.loads((folder / "manifest.json").read_text())["resolved_scene"]
        except (OSError, ValueError, KeyError):
            return False
        return same_scene(kept, scene) and is_done(folder, kept)


def read_campaign(programs, folder, scene_set, model, quick, seeds):
    """The runs of a model with the seeds 1 to `seeds`, from a campaign; None if it has none."""
    cases, campaign = cases_of(scene_set, model, quick), Campaign(programs, folder)
    for case in cases.values():
        for seed in range(1, seeds + 1):
            campaign.take(case, seed, f"read from {folder}")
    return as_model_runs(scene_set, model, cases, campaign, "read from a campaign")


def is_scene(programs, case, ensembles):
    """Whether the programs take the scene of a case; they say why not, and the failures name its water."""
    try:
        programs.resolved(case.water.scene, case.water.changes)
        programs.resolved(case.scene, case.water.changes + case.changes)
    except PlanError:
        if (failure := f"{case.water.key} (the scene is refused)") not in ensembles.failures:
            ensembles.failures.append(failure)
        return False
    return True


def run_table(programs, out, pair, scene_sets, models, options):
    """[ModelRuns] of each set and model, and what failed in words. What is complete is not run again."""
    out.mkdir(parents=True, exist_ok=True)
    store = Store(out / "runs.jsonl")
    if options.report_only:
        shared, own = Campaign(programs, out), Campaign(programs, out)
    else:
        shared = TimedEnsembles(programs, out, pair, 1, store=store)
        own = OwnWaters(programs, out, pair, 1, store=store)
    found, wanted = {}, {}
    for scene_set in scene_sets:
        for model in models:
            key = scene_set, model
            if model == DEFAULT_MODEL and options.dfsph_campaign and not options.further.get(model):
                found[key] = read_campaign(programs, options.dfsph_campaign, *key, options.quick, options.seeds)
            if found.get(key) is None:
                cases = cases_of(*key, options.quick, options.further.get(model, ()))
                wanted[key] = {name: case for name, case in cases.items() if is_scene(programs, case, shared)}
    for ensembles in (shared, own):
        of_these = {key: cases for key, cases in wanted.items() if (key[1] in FOLLOWS_PEOPLE) == (ensembles is own)}
        every = [case for cases in of_these.values() for case in cases.values()]
        if options.report_only:
            ensembles.collect(every)
        elif not shared.interrupted:
            ensembles.run({case: (options.seeds, options.seeds) for case in every})
        for key, cases in of_these.items():
            found[key] = as_model_runs(*key, cases, ensembles)
    if not options.report_only:
        store.tidy()
    order = [(scene_set, model) for scene_set in scene_sets for model in models]
    failures = [*shared.failures, *own.failures]
    return [found[key] for key in order if found.get(key)], failures, shared.interrupted or own.interrupted
