"""Runs `validate` for a point and keeps what it says; what is there already is not repeated."""

import hashlib
import json
import os
import statistics
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import settings  # noqa: F401  it says where run_folder is
from run_folder import program_bytes, say, spheric2_data, write_whole

WALKING = ("outcome_", "end_")  # metrics of people who walk begin so


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
    """Runs points with one program and keeps the results under a folder."""

    def __init__(self, program, folder, repeats, time_limit):
        self.program = Path(program)
        self.folder = Path(folder)
        self.repeats = repeats
        self.time_limit = time_limit
        self.hash = hashlib.sha256(program_bytes(self.program)).hexdigest()[:16]
        self.inputs = {}  # case -> hash of the files it reads

    def fingerprint(self, setting, root):
        """Of program, scenes and reference: a run of another one is out of date."""
        if setting.case not in self.inputs:
            h = hashlib.sha256()
            for pattern in ("configs/scene.schema.json", "configs/validation/*.json", "tests/validation/data/*"):
                for file in sorted(root.glob(pattern)):
                    h.update(file.read_bytes())
            if setting.case == "spheric2":
                h.update(spheric2_data())
            self.inputs[setting.case] = h.hexdigest()[:16]
        return f"{self.hash}-{self.inputs[setting.case]}"

    def run(self, setting, root):
        """Measures a point, with as many runs as are missing. A run that fails is tried once and noted."""
        documents = []
        for k in range(1, self.repeats + 1):
            document = self.one_run(setting, root, k)
            documents.append(document)
            if document["status"] != "completed":
                particles = document.get("particles", 0)
                return Measured(setting, particles, repeats=k, metrics={}, failure=document["error"])
        return summary(setting, documents)

    def resolution(self, setting):
        return ["--spacing", f"{setting.spacing:.10g}"]

    def one_run(self, setting, root, k):
        folder = self.folder / setting.key() / f"repeat-{k}"
        fingerprint = self.fingerprint(setting, root)
        file = folder / "result.json"
        try:
            document = json.loads(file.read_text())
            # A run that was given up is tried again with a larger limit.
            given_up = document.get("gave_up_after_s")
            if document.get("fingerprint") == fingerprint and (given_up is None or given_up >= self.time_limit):
                return document
        except (OSError, ValueError):
            pass
        folder.mkdir(parents=True, exist_ok=True)
        command = [self.program, "--case", setting.case, *self.resolution(setting)]
        for override in setting.overrides():
            command += ["--set", override]
        command += ["--threads", str(setting.threads), "--out", folder]
        say(f"  {setting.key()} ({k} of {self.repeats})", sys.stderr)
        environment = dict(os.environ, OMP_NUM_THREADS=str(setting.threads), GOMP_SPINCOUNT="2000")
        document = {"status": "failed", "error": ""}
        file.unlink(missing_ok=True)
        for old in (folder / "runs").glob("*.json"):
            old.unlink()
        try:
            answer = subprocess.run(
                command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
                timeout=self.time_limit, check=False,
            )
            written = sorted((folder / "runs").glob(f"{setting.case}-*.json"))
            if written:
                document = json.loads(written[0].read_text())
            elif answer.returncode == 2:
                document["error"] = answer.stderr.strip()[-300:]
                document["refused"] = True  # the program does not take this scene or this setting
            else:
                # A crash, or killed from outside, as for memory: noted, but not kept, so that the next sweep tries again.
                document["error"] = f"`validate` ended with exit code {answer.returncode}: {answer.stderr.strip()[-300:]}"
                say(f"  {setting.key()}: {document['error']}", sys.stderr)
                return document
        except subprocess.TimeoutExpired:
            document["gave_up_after_s"] = self.time_limit
            document["error"] = f"took longer than {self.time_limit:g} s of wall time (--time-limit)"
        document["fingerprint"] = fingerprint
        write_whole(file, json.dumps(document))
        return document


def summary(setting, documents):
    """Medians over the repeats. The errors are the same bits in each; if not, the runs are not those of one setting."""
    first = documents[0]
    metrics = {m["name"]: m["value"] for m in first["metrics"]}
    for other in documents[1:]:
        if {m["name"]: m["value"] for m in other["metrics"]} != metrics:
            raise RuntimeError(f"{setting.key()}: two runs of the same setting have different errors")

    def median(value):
        return statistics.median(value(d) for d in documents)

    return Measured(
        setting,
        particles=first["particles"],
        cpu=median(lambda d: d["solver_cpu_s"] / d["simulated_s"]),
        wall=median(lambda d: d["solver_wall_s"] / d["simulated_s"]),
        run_time=median(lambda d: d["solver_cpu_s"]),
        rate=median(lambda d: d["particle_steps"] / max(d["solver_wall_s"], 1e-9)),
        repeats=len(documents),
        metrics=metrics,
    )


def of_seeds(setting, runs):
    """One point of the runs of a model with several seeds.

    Its costs are medians. So are its errors, but for those of people who walk: the seed moves their markers too, and the
    truth is that of one crowd, the scene's, which the first run has.
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
    return replace(
        runs[0], setting=setting, cpu=median(lambda r: r.cpu), wall=median(lambda r: r.wall), rate=median(lambda r: r.rate),
        run_time=median(lambda r: r.run_time), metrics=metrics, ranges=ranges, repeats=sum(r.repeats for r in runs),
    )
