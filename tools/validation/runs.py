"""Which runs there are to do, and doing them, several at a time."""

import fnmatch
import hashlib
import json
import os
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor

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


def plan(cases, patterns, levels, quick, long):
    """List of (case, level): all coarse runs first, so that results come early."""
    chosen = cases
    if patterns:
        wanted = [pattern.strip() for pattern in patterns.split(",")]
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
        raise ValueError("nothing to run: the cases chosen are long or not quick; see --list, --long")
    return runs


def fingerprint(program, root):
    """Of the program and all that it reads: a run with the same one would give the same numbers."""
    digest = hashlib.sha256(program.read_bytes())
    data = sorted((root / "tests" / "validation" / "data").glob("**/*"))
    for file in sorted((root / "configs").glob("**/*.json")) + [file for file in data if file.is_file()]:
        digest.update(str(file.relative_to(root)).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:16]


def up_to_date(file, print_of_now):
    try:
        return json.loads(file.read_text())["fingerprint"] == print_of_now
    except (OSError, ValueError, KeyError):
        return False


class Runner:
    """Starts the runs and ends them together when one is interrupted."""

    def __init__(self, program, folder, print_of_now):
        self.program, self.folder, self.fingerprint = program, folder, print_of_now
        self.lock = threading.Lock()
        self.running = set()
        self.stopped = False

    def run(self, case, level):
        """One run; returns a line about it."""
        log = self.folder / "runs" / f"{case.name}-{level}.log"
        command = [self.program, "--case", case.name, "--level", level, "--threads", "1"]
        command += ["--out", self.folder, "--fingerprint", self.fingerprint]
        started = time.monotonic()
        with open(log, "w", encoding="utf-8") as output:
            with self.lock:
                if self.stopped:
                    return f"{case.name} {level}: not started"
                process = subprocess.Popen(
                    command, stdout=output, stderr=subprocess.STDOUT, env={**os.environ, "OMP_NUM_THREADS": "1"}
                )
                self.running.add(process)
            code = process.wait()
            with self.lock:
                self.running.discard(process)
        if code == 0:
            return f"{case.name} {level}: done in {time.monotonic() - started:.1f} s"
        lines = log.read_text(encoding="utf-8").splitlines()
        messages = [line for line in lines if line.startswith("validate: ")]
        return f"{case.name} {level}: exit code {code}; {(messages or lines or ['no message'])[-1]}"

    def stop(self):
        with self.lock:
            self.stopped = True
            for process in self.running:
                process.terminate()


def run_all(plan_of_runs, program, folder, print_of_now, jobs, again):
    """Does what is not up to date; true if it was interrupted."""
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    files = {run: folder / "runs" / f"{run[0].name}-{run[1]}.json" for run in plan_of_runs}
    due = [run for run in plan_of_runs if again or not up_to_date(files[run], print_of_now)]
    print(f"{len(plan_of_runs)} runs, {len(plan_of_runs) - len(due)} of them complete, {jobs} at a time", flush=True)
    for run in due:
        files[run].unlink(missing_ok=True)  # a run that dies leaves none, instead of an old one
    runner = Runner(program, folder, print_of_now)
    with ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(runner.run, *run) for run in due]
        try:
            for future in futures:
                print(future.result(), flush=True)
        except KeyboardInterrupt:
            runner.stop()
            print("interrupted; the same command goes on from here", flush=True)
            return True
    return False
