"""Which runs there are to do, and doing them, several at a time."""

import fnmatch
import hashlib
import json
import subprocess
import time

from run_folder import program_bytes, run_side_by_side, say, spheric2_data

LEVELS = ("coarse", "medium", "fine")


class Case:
    """A line of `validate --list`: NAME SPACING... [quick=LEVEL] [long=LEVEL]."""

    def __init__(self, line):
        words = line.split()
        self.name = words[0]
        marks = dict(word.split("=") for word in words[1:] if "=" in word)
        self.spacings = [float(word) for word in words[1:] if "=" not in word]
        self.levels = LEVELS[: len(self.spacings)]
        self.quick = marks.get("quick")
        self.long_from = LEVELS.index(marks["long"]) if "long" in marks else len(LEVELS)

    def describe(self):
        spacings = ", ".join(f"{spacing:g}" for spacing in self.spacings)
        quick = f"; quick: {self.quick}" if self.quick else ""
        long = f"; long from {LEVELS[self.long_from]} on" if self.long_from < len(self.levels) else ""
        return f"{self.name}: {spacings}{quick}{long}"


def list_cases(program):
    text = subprocess.run([program, "--list"], check=True, capture_output=True, text=True).stdout
    return [Case(line) for line in text.splitlines() if line.strip()]


def patterns_of(text):
    return [pattern.strip() for pattern in text.split(",")] if text else []


def plan(cases, patterns, levels, quick, long):
    """List of (case, level): all coarse runs first, so that results come early."""
    chosen = cases
    if wanted := patterns_of(patterns):
        for pattern in wanted:
            if not any(fnmatch.fnmatchcase(case.name, pattern) for case in cases):
                names = ", ".join(case.name for case in cases)
                raise ValueError(f"--cases {pattern}: no such case; allowed: {names}")
        chosen = [case for case in cases if any(fnmatch.fnmatchcase(case.name, pattern) for pattern in wanted)]
    allowed = [level.strip() for level in levels.split(",")] if levels else LEVELS
    for level in allowed:
        if level not in LEVELS:
            raise ValueError(f"--levels {level}: allowed: {', '.join(LEVELS)}")
    runs = []
    for index, level in enumerate(LEVELS):
        for case in chosen:
            if quick and case.quick != level:
                continue
            if level in allowed and level in case.levels and (long or index < case.long_from):
                runs.append((case, level))
    if not runs:
        raise ValueError("nothing to run: the cases chosen have none of these resolutions, take hours or are not quick")
    return runs


def left_out(patterns, runs):
    """The patterns that none of these runs goes by."""
    names = {case.name for case, _ in runs}
    return [pattern for pattern in patterns_of(patterns) if not fnmatch.filter(names, pattern)]


def tell_left_out(patterns, runs):
    if left := left_out(patterns, runs):
        say(f"left out, as they have none of these resolutions, take hours or are not quick: {', '.join(left)}")


class Fingerprints:
    """Of the program and all that a case reads: a run with the same one would give the same numbers."""

    def __init__(self, program, root, settings=()):
        self.digest = hashlib.sha256(program_bytes(program))
        for setting in settings:
            self.digest.update(setting.encode() + b"\0")
        data = sorted((root / "tests" / "validation" / "data").glob("**/*"))
        for file in sorted((root / "configs").glob("**/*.json")) + [file for file in data if file.is_file()]:
            self.digest.update(str(file.relative_to(root)).encode() + b"\0" + file.read_bytes())

    def __call__(self, case_name):
        digest = self.digest.copy()
        if case_name == "spheric2":
            digest.update(spheric2_data())
        return digest.hexdigest()[:16]


def up_to_date(file, print_of_now):
    try:
        return json.loads(file.read_text())["fingerprint"] == print_of_now
    except (OSError, ValueError, KeyError):
        return False


class Runner:
    """Starts the runs, several at a time, each with so many threads and with the same settings."""

    settings = ()  # values of --set

    def __init__(self, program, folder, fingerprint_of, children, threads):
        self.program, self.folder, self.fingerprint_of, self.children = program, folder, fingerprint_of, children
        self.threads = str(threads)

    def result_file(self, case, level):
        return self.folder / "runs" / f"{case.name}-{level}.json"

    def run(self, case, level):
        """One run; returns a line about it."""
        log = self.folder / "runs" / f"{case.name}-{level}.log"
        command = [self.program, "--case", case.name, "--level", level, "--threads", self.threads]
        command += ["--out", self.folder, "--fingerprint", self.fingerprint_of(case.name)]
        command += [word for setting in self.settings for word in ("--set", setting)]
        started = time.monotonic()
        code = self.children.run(command, log, {"OMP_NUM_THREADS": self.threads}, self.result_file(case, level))
        if code is None:
            return f"{case.name} {level}: not started"
        if code == 0:
            return f"{case.name} {level}: done in {time.monotonic() - started:.1f} s"
        lines = log.read_text(encoding="utf-8").splitlines()
        messages = [line for line in lines if line.startswith("validate: ")]
        return f"{case.name} {level}: exit code {code}; {(messages or lines or ['no message'])[-1]}"


def run_all(plan_of_runs, runner, jobs, again):
    """Does what is not up to date; 0, or the exit code of the signal that interrupted it."""
    (runner.folder / "runs").mkdir(parents=True, exist_ok=True)
    due = [
        run for run in plan_of_runs
        if again or not up_to_date(runner.result_file(*run), runner.fingerprint_of(run[0].name))
    ]
    say(f"{len(plan_of_runs)} runs, {len(plan_of_runs) - len(due)} of them complete, {jobs} at a time")
    return run_side_by_side(runner.run, due, runner.children, jobs)
