"""Which runs there are to do, and doing them, several at a time."""

import fnmatch
import hashlib
import json
import subprocess

import settings
from run_folder import program_bytes, run_side_by_side, say


class Case:
    """A line of `stability --list`: name, whether the solver settings matter, the trouble that it stands for."""

    def __init__(self, line):
        self.name, varied, self.trouble = line.split("\t")
        self.varied = varied == "varied"


def list_cases(program):
    text = subprocess.run([program, "--list"], check=True, capture_output=True, text=True).stdout
    return [Case(line) for line in text.splitlines() if line]


def choose(cases, patterns):
    if not patterns:
        return cases
    wanted = [pattern.strip() for pattern in patterns.split(",")]
    for pattern in wanted:
        if not any(fnmatch.fnmatchcase(case.name, pattern) for case in cases):
            raise ValueError(f"--cases {pattern}: no such case; allowed: {', '.join(case.name for case in cases)}")
    return [case for case in cases if any(fnmatch.fnmatchcase(case.name, pattern) for pattern in wanted)]


def plan(cases, names, quick):
    """List of (case, setting): all of one setting, then of the next, so that the defaults come first."""
    chosen = [name.strip() for name in names.split(",")] if names else list(settings.SETTINGS)
    for name in chosen:
        settings.overrides_of(name)
    if quick and not names:
        chosen = [name for name in chosen if settings.SETTINGS[name][1]]
    runs = [(case, name) for name in chosen for case in cases if case.varied or name == "default"]
    if quick or names:
        return runs
    for sweep, (_, values) in settings.SWEEPS.items():
        for value in values:
            name = settings.sweep_name(sweep, value)
            runs += [(case, name) for case in cases if case.name in settings.SWEPT_CASES]
    return runs


def fingerprint(program, root, form):
    """Of the program and all that it reads: a run with the same one would give the same numbers."""
    digest = hashlib.sha256(program_bytes(program) + form.encode())
    files = sorted((root / "configs" / "stability").glob("*.json"))
    for file in [*files, root / "configs" / "scene.schema.json"]:
        digest.update(str(file.relative_to(root)).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:16]


def read_run(file):
    """A complete run, or None."""
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


class Runner:
    """Starts the runs of one form, several at a time. Each form has a folder of its own, so that none replaces another."""

    def __init__(self, program, folder, print_of_now, form, children):
        self.program, self.folder, self.fingerprint, self.form = program, folder / form, print_of_now, form
        self.children = children

    def result_file(self, case, name):
        return self.folder / f"{case.name}-{name}.json"

    def command(self, case, name):
        command = [self.program, "--case", case.name, "--setting", name, "--threads", "1"]
        command += ["--out", self.folder, "--fingerprint", self.fingerprint]
        command += {"quick": ["--quick"], "long": ["--long"], "full": []}[self.form]
        if name == "default" and not (self.form == "long" and case.name == "leak"):
            command += ["--compare-threads", "2"]
        for override in settings.overrides_of(name):
            command += ["--set", override]
        return command

    def run(self, case, name):
        """One run; returns a line about it."""
        log = self.folder / f"{case.name}-{name}.log"
        environment = {"OMP_NUM_THREADS": "1", "GOMP_SPINCOUNT": "2000"}
        code = self.children.run(self.command(case, name), log, environment, self.result_file(case, name))
        if code is None:
            return f"{case.name} ({name}): not started"
        lines = log.read_text(encoding="utf-8").splitlines()
        if code in (0, 1) and lines:
            return lines[0]
        return f"{case.name} ({name}): exit code {code}; {(lines or ['no message'])[-1]}"


def run_all(plan_of_runs, runner, jobs, again):
    """Does what is not up to date; 0, or the exit code of the signal that interrupted it."""
    runner.folder.mkdir(parents=True, exist_ok=True)
    due = []
    for case, name in plan_of_runs:
        run = None if again else read_run(runner.result_file(case, name))
        if run is None or run["fingerprint"] != runner.fingerprint:
            due.append((case, name))
    say(f"{len(plan_of_runs)} runs, {len(plan_of_runs) - len(due)} of them complete, {jobs} at a time")
    return run_side_by_side(runner.run, due, runner.children, jobs)
