"""Runs `validate` for a point and keeps what it says; what is there already is not repeated. And the reference of an impulse
case: a run at a fine spacing, which stores what each agent met.
"""

import json
import os
import statistics
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

from wade import plain_file
from wade.paths import ROOT
from wade.reports.files import complain, say, write_whole
from wade.reports.jobs import read_result

WALKING = ("outcome_", "end_")  # metrics of walking people begin so


@dataclass
class Measured:
    """A point with its result."""

    setting: object
    particles: int = 0
    cpu: float = 0.0  # CPU seconds of the solver per simulated second, median of the repeats
    wall: float = 0.0  # the same of wall time
    rate: float = 0.0  # particle steps per wall second, median
    repeats: int = 0
    metrics: dict = None  # name -> value, None where it could not be measured
    failure: str = ""  # why there is no result
    run_time: float = 0.0  # CPU seconds of the solver, median
    ranges: dict = None  # name -> smallest and largest value over the seeds of a model that was run with several


class Runner:
    """Runs points with one program, one after another, and keeps the results under a folder."""

    def __init__(self, program, folder, fingerprint_of, repeats, time_limit):
        self.program, self.folder, self.fingerprint_of = program, folder, fingerprint_of
        self.repeats, self.time_limit = repeats, time_limit

    def run(self, setting):
        """Measures a point, with as many runs as are missing. A run that fails is tried once and noted."""
        documents = []
        for k in range(1, self.repeats + 1):
            documents.append(self.one_run(setting, k))
            if documents[-1]["status"] != "completed":
                particles = documents[-1].get("particles", 0)
                return Measured(setting, particles, repeats=k, metrics={}, failure=documents[-1]["error"])
        return summary(setting, documents)

    def result_file(self, setting, k):
        return self.folder / setting.key() / f"repeat-{k}" / "result.json"

    def one_run(self, setting, k=1):
        """What a run said: that of before if it is up to date. One that was given up is tried again with a larger limit."""
        file, fingerprint = self.result_file(setting, k), self.fingerprint_of(setting.case)
        document = read_result(file)
        if document and document.get("fingerprint") == fingerprint:
            given_up = document.get("gave_up_after_s")
            if given_up is None or given_up >= self.time_limit:
                return document
        complain(f"  {setting.key()} ({k} of {self.repeats})")
        file.unlink(missing_ok=True)
        for old in (file.parent / "runs").glob("*.json"):
            old.unlink()
        document, keep = self.carry_out(setting, file.parent)
        if keep:
            write_whole(file, json.dumps({**document, "fingerprint": fingerprint}))
        else:
            complain(f"  {setting.key()}: {document['error']}")
        return document

    def carry_out(self, setting, folder):
        """(document, whether it is kept): a crash, or killed from outside, as for memory, is tried again next time."""
        folder.mkdir(parents=True, exist_ok=True)
        command = [self.program, "--case", setting.case, *setting.resolution(), "--threads", str(setting.threads)]
        command += ["--out", folder, *(word for override in setting.overrides() for word in ("--set", override))]
        environment = dict(os.environ, OMP_NUM_THREADS=str(setting.threads), GOMP_SPINCOUNT="2000")
        try:
            answer = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
                                    timeout=self.time_limit, check=False)
        except subprocess.TimeoutExpired:
            error = f"took longer than {self.time_limit:g} s of wall time (--time-limit)"
            return {"status": "failed", "error": error, "gave_up_after_s": self.time_limit}, True
        for written in sorted((folder / "runs").glob(f"{setting.case}-*.json")):
            return plain_file.read_json(written), True
        if answer.returncode == 2:  # the program does not take this scene or this setting
            return {"status": "failed", "error": answer.stderr.strip()[-300:], "refused": True}, True
        error = f"`validate` ended with exit code {answer.returncode}: {answer.stderr.strip()[-300:]}"
        return {"status": "failed", "error": error}, False


def summary(setting, documents):
    """Medians over the repeats. The errors are the same bits in each; if not, the runs are not those of one setting."""
    first = documents[0]
    metrics = {m["name"]: m["value"] for m in first["metrics"]}
    for other in documents[1:]:
        if {m["name"]: m["value"] for m in other["metrics"]} != metrics:
            raise RuntimeError(f"{setting.key()}: two runs of the same setting have different errors")

    def median(value):
        return statistics.median(value(d) for d in documents)

    return Measured(setting, particles=first["particles"], cpu=median(lambda d: d["solver_cpu_s"] / d["simulated_s"]),
                    wall=median(lambda d: d["solver_wall_s"] / d["simulated_s"]),
                    run_time=median(lambda d: d["solver_cpu_s"]),
                    rate=median(lambda d: d["particle_steps"] / max(d["solver_wall_s"], 1e-9)), repeats=len(documents),
                    metrics=metrics)


def of_seeds(setting, runs):
    """One point of the runs of a model with several seeds.

    Its costs and errors are medians. Errors of walking people are those of the first run: the seed moves their markers,
    too, and the truth belongs to the scene's crowd, which only the first run has.
    """
    failed = next((run for run in runs if run.failure), None)
    if failed:
        return replace(failed, setting=setting)

    def median(value):
        return statistics.median(value(run) for run in runs)

    metrics, ranges = dict(runs[0].metrics), {}
    for name in (name for name in metrics if not name.startswith(WALKING)):
        values = [run.metrics[name] for run in runs]
        if None not in values:
            metrics[name] = statistics.median(values)
            ranges[name] = (min(values), max(values))
    return replace(runs[0], setting=setting, cpu=median(lambda r: r.cpu), wall=median(lambda r: r.wall),
                   rate=median(lambda r: r.rate), run_time=median(lambda r: r.run_time), metrics=metrics, ranges=ranges,
                   repeats=sum(r.repeats for r in runs))


DATA = ROOT / "tests" / "validation" / "data"
# Columns of the curves that `validate` writes, and the curve of each table.
TABLES = {"standing": ("impulse", 4), "walking": ("outcome", 5)}


def heading(run):
    return [f"# Reference of the case {run['case']}: a run of our own at a spacing of {run['spacing_m']:g} m, "
            f"{run['particles']} particles, {run['steps']} steps, {run['cpu_s']:.0f} s of CPU; not a measurement.",
            f"# Commit {run['git']}, {run['compiler']}. Made by tools/wade speed-vs-error --reference {run['case']} "
            f"--spacing {run['spacing_m']:.10g}"]


def make_reference(program, case, spacing, threads):
    with tempfile.TemporaryDirectory() as scratch:
        command = [program, "--case", case, "--spacing", spacing, "--no-reference", "--threads", str(threads)]
        if subprocess.run([*command, "--out", scratch]).returncode != 0:
            raise ValueError(f"--reference {case} --spacing {spacing}: the run failed")
        run = json.loads(next((Path(scratch) / "runs").glob(f"{case}-spacing-*.json")).read_text())
        for name, (curve, columns) in TABLES.items():
            file = next(c["file"] for c in run["curves"] if c["name"] == curve)
            rows = (Path(scratch) / "runs" / file).read_text().splitlines()
            lines = heading(run) + [",".join(row.split(",")[:columns]) for row in rows]
            write_whole(DATA / f"{case}_{name}.csv", "\n".join(lines) + "\n")
            say(DATA / f"{case}_{name}.csv")
    return 0
