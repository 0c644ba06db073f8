"""Runs the cases of the plan: one run of the fluid for all crowds of a water, more seeds only where needed."""

import json
import subprocess
import sys
import time

from wade import plain_file, progress
from wade.paths import module_command
from wade.reports.files import complain
from wade.statistics.shares import precise_enough
from wade.suites.paper.pictures import note_what_is_seen
from wade.suites.paper.results import Run, answers_by_body, record_of
from wade.suites.paper.store import what_counts

# Where the crowds of one water may differ; all else belongs to the water.
CROWDS_OWN = ("crowd", "coupling", "events", "name", "description")
# A hundred crowds take a while to set out their markers, and for a frame.
WAITING = ("--attach-timeout-s", "300", "--step-timeout-s", "300")
TOLD_EVERY_S = 60  # how far a water is, where its progress goes to a file


class PlanError(Exception):
    """A scene that the programs refuse; its text has been printed by them."""

    def __init__(self, code):
        super().__init__(f"exit code {code}")
        self.code = code


class Programs:
    """The two programs, and the scenes as they read them, all with some values changed: (JSON pointer, value)."""

    def __init__(self, folder, until_s=None, changes=()):
        self.folder, self.until_s, self.changes = folder, until_s, changes
        self.known = {}

    def resolved(self, scene, changes):
        """The scene with these (pointer, value) changes as the programs will run it."""
        key = (scene, repr(changes))
        if key not in self.known:
            command = [self.folder / "crowd_client", scene, *self.words(changes), "--print-config"]
            answer = subprocess.run(command, stdout=subprocess.PIPE, text=True)
            if answer.returncode != 0:
                raise PlanError(answer.returncode)
            self.known[key] = json.loads(answer.stdout)
        return self.known[key]

    def words(self, changes):
        """Options of a scene with these changes besides."""
        values = [word for pointer, value in (*self.changes, *changes)
                  for word in ("--set", f"{pointer}={json.dumps(value)}")]
        return values + ([] if self.until_s is None else ["--until-s", str(self.until_s)])

    def scene_of(self, case, seed):
        """The resolved scene of a case: its own crowd in the water that it shares."""
        own = self.resolved(case.scene, case.water.changes + case.changes)  # the crowd's steps follow the frame rate
        water = self.resolved(case.water.scene, case.water.changes)
        return {**water, **{key: own[key] for key in CROWDS_OWN if key in own}, "seed": seed}


def is_done(folder, scene):
    """Whether the folder holds a complete run of this very scene, by programs that wrote all that the report reads."""
    try:
        outcome = plain_file.read_json(folder / "outcome.json")
        manifest = plain_file.read_json(folder / "manifest.json")
        columns = next(plain_file.table_cells(folder / "agents.csv"))
    except plain_file.FileError:
        return False
    newest = "worst_state" if answers_by_body(scene) else "mean_dv_m2_s"
    complete = outcome.get("status") == "completed" and newest in columns
    return complete and what_counts(manifest.get("resolved_scene") or {}) == what_counts(scene)


def crowd_entry(name, scene, water, pictures):
    """One element of the file of --crowds: what this crowd has otherwise than the water's scene."""
    keys = [key for key in (*CROWDS_OWN, "seed") if scene.get(key) != water.get(key)]
    return {"name": name, "set": {f"/{key}": scene.get(key) for key in keys}, "pictures": pictures}


class Ensembles:
    """Results by case, and how they were obtained.

    store: where the results of single runs are kept; without it they are in the run folders alone.
    """

    def __init__(self, programs, out, pair, threads, keep_all=False, store=None):
        self.programs, self.out, self.pair, self.threads, self.keep_all = programs, out, pair, threads, keep_all
        self.store = store
        self.runs = {}  # of a case's key: its runs in the order of their seeds
        self.failures = []  # waters in words
        self.interrupted = 0  # exit code after a signal

    def folder(self, case, seed):
        return self.out / case.water.key / f"{case.name}-seed{seed}"

    def has(self, case, seed):
        return self.kept(case, seed) is not None or self.has_folder(case, seed)

    def has_folder(self, case, seed):
        return is_done(self.folder(case, seed), self.programs.scene_of(case, seed))

    def kept(self, case, seed):
        """The record of a run in the store; None if it has none of this scene."""
        return self.store.find(case.key, seed, self.programs.scene_of(case, seed)) if self.store else None

    def run(self, wanted):
        """Runs cases with their first seeds, and adds seeds while their intervals are still wide.

        wanted: {case: (seeds of a round, most seeds)}.
        """
        waters = {}
        for case in wanted:
            waters.setdefault(case.water, []).append(case)
        began = time.monotonic()
        for number, (water, cases) in enumerate(waters.items(), 1):
            progress.at("runs the waters of the paper", number - 1, len(waters))
            complain(f"{water.key}: {number} of {len(waters)} waters, after {(time.monotonic() - began) / 60:.0f} min")
            done = dict.fromkeys(cases, 0)
            while batch := self.next_round(cases, wanted, done):
                if not self.run_water(water, batch):
                    break
            if self.interrupted:
                return

    def collect(self, cases):
        """Takes what is complete, and runs nothing."""
        for case in cases:
            folder = self.out / case.water.key
            names = [path.name.rpartition("-seed")[2] for path in folder.glob(f"{case.name}-seed*")]
            seeds = {int(name) for name in names if name.isdigit()}
            seeds |= self.store.seeds(case.key) if self.store else set()
            for seed in sorted(seeds):
                self.take(case, seed, "done before")

    def next_round(self, cases, wanted, done):
        """The (case, seed) that come next; counts them in `done`."""
        batch = []
        for case in cases:
            seeds, most = wanted[case]
            if done[case] < most and (done[case] == 0 or not self.settled(case)):
                last = min(done[case] + seeds, most)
                batch += [(case, seed) for seed in range(done[case] + 1, last + 1)]
                done[case] = last
        return batch

    def settled(self, case):
        runs = self.runs.get(case.key, [])
        times = [run.outcome["last_arrival_s"] for run in runs if run.outcome["last_arrival_s"] is not None]
        return bool(runs) and precise_enough([run.outcome["arrived"] for run in runs], runs[0].outcome["agents"], times)

    def run_water(self, water, batch):
        """Runs the fluid once for the missing runs of these cases and seeds; returns false if that failed."""
        missing = [run for run in batch if not self.has(*run)]
        code = self.run_crowds(water, missing) if missing else 0
        if self.pair.signal:
            self.interrupted = code or 130
            return False
        lost = [name_of(*run) for run in missing if not self.has(*run)]
        if code != 0 or lost:
            self.failures.append(f"{water.key} ({', '.join(lost[:5]) or 'all crowds complete'}; exit code {code})")
            complain(f"{water.key}: failed with exit code {code}, see {self.log(water)}")
        for run in batch:
            self.take(*run, "run" if run in missing else "done before")
        return code == 0 and not lost

    def log(self, water):
        return self.out / water.key / "run.log"

    def run_crowds(self, water, missing):
        """Runs one pair for all one-way crowds, and one for each two-way crowd; returns the first exit code but 0."""
        pushing = [run for run in missing if self.programs.scene_of(*run)["coupling"].get("two_way")]
        shared = [run for run in missing if run not in pushing]
        return (self.run_shared(water, shared) if shared else 0) or self.run_alone(water, pushing)

    def run_shared(self, water, missing):
        """Runs one pair; on a terminal its progress is shown, else it goes to run.log. Returns its exit code."""
        folder = self.out / water.key
        folder.mkdir(parents=True, exist_ok=True)
        base = self.programs.resolved(water.scene, water.changes)
        entries = [crowd_entry(name_of(*run), self.programs.scene_of(*run), base, self.keeps_pictures(*run))
                   for run in missing]
        (folder / "crowds.json").write_text(json.dumps(entries, indent=1) + "\n", encoding="utf-8")
        command = [*module_command("wade.run.pair"), water.scene, "--crowds", folder / "crowds.json", "--out", folder]
        command += ["--no-figure", "--threads", str(self.threads), *self.programs.words(water.changes)]
        command += WAITING
        complain(f"{water.key}: {len(missing)} crowds")
        with plain_file.create(self.log(water)) as log:
            process = self.pair.start(command, stdout=log, stderr=None if sys.stderr.isatty() else log)
            return self.wait_for(process, water)

    def run_alone(self, water, missing):
        """Runs a pair for each crowd; returns the first exit code but 0."""
        for case, seed in missing:
            folder = self.folder(case, seed)
            folder.mkdir(parents=True, exist_ok=True)
            scene = folder / "scene.json"
            scene.write_text(json.dumps(self.programs.scene_of(case, seed), indent=1) + "\n", encoding="utf-8")
            command = [*module_command("wade.run.pair"), scene, "--out", folder, "--no-figure", "--water-every-s", "0"]
            command += ["--threads", str(self.threads), *WAITING]
            with plain_file.create(self.log(water)) as log:
                code = self.wait_for(self.pair.start(command, stdout=log, stderr=log), water)
            if code != 0 or self.pair.signal:
                return code
        return 0

    def wait_for(self, process, water):
        """Waits for a pair, and tells now and then how far it is; returns its exit code."""
        while True:
            try:
                return process.wait(timeout=TOLD_EVERY_S)
            except subprocess.TimeoutExpired:
                if not sys.stderr.isatty():
                    said = [line for line in plain_file.read_text(self.log(water), "replace").splitlines()
                            if line[:2] == "t "]
                    complain(f"{water.key}: {said[-1] if said else 'starts'}")

    def keeps_pictures(self, case, seed):
        """Returns true if a run keeps its paths and pictures of its water: the first seed of unchanged scenes and of
        the obstacle, as the lee is measured in the water."""
        plain = not case.changes and not case.water.changes
        return self.keep_all or (seed == 1 and (plain or case.name == "obstacle"))

    def take(self, case, seed, how):
        """Takes a complete run into the results."""
        if not self.has(case, seed) or any(run.seed == seed for run in self.runs.get(case.key, [])):
            return
        record = self.kept(case, seed)
        run = self.read(case, seed) if record is None else self.run_of(case, seed, record)
        self.runs.setdefault(case.key, []).append(run)
        complain(f"{case.key} seed {seed}: {run.in_words()} ({how})")

    def run_of(self, case, seed, record):
        """A run that is in the store; its folder need not be there any more."""
        folder = self.folder(case, seed) if self.has_folder(case, seed) else None
        return Run(case, scenario_name(case), seed, record, self.programs.scene_of(case, seed), folder)

    def read(self, case, seed):
        """Reads a run from its folder, and puts it into the store."""
        folder = self.folder(case, seed)
        record, scene = record_of(folder)
        run = Run(case, scenario_name(case), seed, record, scene, folder)
        if self.store:
            note_what_is_seen(run)
            self.store.add(case.key, seed, scene, record)
        return run


class OwnWaters(Ensembles):
    """Runs each crowd in a water of its own, for models with water that follows the people."""

    def run_crowds(self, water, missing):
        return self.run_alone(water, missing)


def name_of(case, seed):
    return f"{case.name}-seed{seed}"


def scenario_name(case):
    """S5 for the crowd of s05.json, else the case's name."""
    return case.name.upper() if case.name[0] == "s" and case.name[1:].isdigit() else case.name
