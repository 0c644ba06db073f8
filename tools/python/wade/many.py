"""Runs each SCENE, or each with each of the seeds A to B, several pairs of fluid_server and crowd_client at once.

Each pair has a session of its own. Prints a line for each run that ends and a table at the end; writes DIR/summary.csv and
a run folder for each run, with what its programs said in run.log. A run that fails does not stop the others; Ctrl-C ends
all of them.
"""

import argparse
import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

from wade import UsageError
from wade.paths import module_command
from wade.reports.files import complain
from wade.reports.options import whole
from wade.reports.tables import plain, write_csv
from wade.run.arguments import is_given, values_of
from wade.run.folders import new_folder
from wade.run.outcome import BeforeRun
from wade.run.processes import Pair, exit_code
from wade.scenes import find_scene
from wade.terminal import Parser

COLUMNS = ("scene", "seed", "status", "exit_code", "agents", "arrived", "dead", "active", "last_arrival_s", "frames",
           "frame_hash", "wall_time_s", "folder")
TABLE = ("scene", "seed", "status", "arrived", "dead", "active", "last_arrival_s", "frame_hash")


EPILOG = """Behind -- stand options for every run, for example -- --until-s 60 --set /crowd/tau=0.3; see tools/wade run --help.
Not allowed there are --out, --session, --record and --commands, which each run needs for itself, --crowds, and --seed and
--set /seed beside --seeds. Unless --threads is among them, the pairs share the processors evenly.

Exit code: 0 if all runs ended well, 1 if one did not, 2 bad usage, 130/143 interrupted."""


class Job:
    """One run: its scene, its seed (None = the scene's) and its folder."""

    def __init__(self, scene, seed, folder):
        self.scene, self.seed, self.folder = scene, seed, folder
        self.process = None
        self.before = None  # what was in the folder when the run began

    def command(self, options):
        seed = [] if self.seed is None else ["--seed", str(self.seed)]
        figure = [] if options.figures else ["--no-figure"]
        return [*module_command("wade.run.pair"), self.scene, "--out", self.folder, *seed, *figure, *options.common]

    def row(self):
        """What the run came to, as a line of summary.csv."""
        row = dict.fromkeys(COLUMNS, "")
        row.update(scene=label(self.scene), seed=self.seed, status="not_run", folder=self.folder)
        if self.process is None:
            return row
        row.update(status="failed", exit_code=exit_code(self.process))
        if not self.before.has_new_results():
            return row
        try:
            outcome = json.loads((self.folder / "outcome.json").read_text())
        except (OSError, ValueError):
            return row
        row.update({key: value for key, value in outcome.items() if key in COLUMNS and key != "scene"})
        return {key: "" if value is None else value for key, value in row.items()}

    def ended_well(self):
        return self.process is not None and self.process.returncode == 0


def label(scene):
    """Folder and name of a scene file, "paper-s05"."""
    path = Path(scene).resolve()
    return f"{path.parent.name}-{path.stem}"


def seed_range(text):
    """The seeds of "A-B" or "A"."""
    match = re.fullmatch(r"(\d+)(?:-(\d+))?", text)
    if not match or int(match[2] or match[1]) < int(match[1]):
        raise argparse.ArgumentTypeError(f'"{text}" is not allowed; allowed: A-B with whole numbers A <= B, or A')
    return range(int(match[1]), int(match[2] or match[1]) + 1)


def parse(arguments):
    common = []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, common = arguments[:at], arguments[at + 1 :]
    parser = Parser("many", __doc__, EPILOG, usage="tools/wade many [options] SCENE... [-- options of every run]")
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="a file or a short name, as in tools/wade run")
    parser.add_argument("--jobs", type=whole(1), default=max(1, len(os.sched_getaffinity(0)) // 2), metavar="N",
                        help="pairs at once [half the processors, at least 1]")
    parser.add_argument("--out", type=Path, metavar="DIR", help="[runs/many-<time>/ in the project]")
    parser.add_argument("--seeds", type=seed_range, default=[None], metavar="A-B",
                        help="whole numbers, for example 1-8, or a single one [the scene's own seed]")
    parser.add_argument("--figures", action="store_true", help="draw figure.png of each run")
    options, others = parser.parse_known_args(arguments)
    if others:
        parser.error(f"{others[0]}: options of the runs stand behind --, for example: SCENE... -- {' '.join(others)}")
    if not is_given(common, "--threads"):
        common += ["--threads", str(max(1, len(os.sched_getaffinity(0)) // options.jobs))]
    for name in ("--out", "--session", "--record", "--commands"):
        if is_given(common, name):
            parser.error(f"{name} is not allowed behind --: the runs would share what each needs for itself")
    if options.seeds != [None] and is_given(common, "--seed"):
        parser.error("--seeds and, behind --, --seed exclude one another: all runs would have the same seed")
    if options.seeds != [None] and any(value.split("=")[0] == "/seed" for value in values_of(common, "--set")):
        parser.error("--seeds and, behind --, --set /seed exclude one another: the latter would have no effect")
    if is_given(common, "--crowds"):
        parser.error("--crowds is not allowed behind --: a run of many crowds has an outcome for each, and no line in "
                     "this table; tools/run.sh runs it, and a crowd can have a seed of its own")
    options.common = common
    options.out = options.out or new_folder("many")
    return options


def jobs_of(options):
    jobs, taken = [], set()
    for name in options.scenes:
        for seed in options.seeds:
            scene = find_scene(name)
            stem = label(scene) + ("" if seed is None else f"-seed{seed}")
            folder, n = stem, 1
            while folder in taken:
                n += 1
                folder = f"{stem}-{n}"
            taken.add(folder)
            jobs.append(Job(scene, seed, options.out / folder))
    return jobs


def start(job, pair, options):
    job.folder.mkdir(parents=True, exist_ok=True)
    job.before = BeforeRun(job.folder, many=False)
    with open(job.folder / "run.log", "w", encoding="utf-8") as log:
        job.process = pair.start(job.command(options), stdout=log, stderr=subprocess.STDOUT)


def told(job, done, total):
    row = job.row()
    seed = "" if row["seed"] in ("", None) else f" seed {row['seed']}"
    words = f"[{done}/{total}] {row['scene']}{seed}: {row['status']}"
    if row["agents"] != "":
        words += f", {row['arrived']} of {row['agents']} arrived"
    if not job.ended_well():
        words += f" (exit code {row['exit_code']}, see {job.folder / 'run.log'})"
    return words


def run_all(jobs, pair, options):
    """Keeps as many runs going as are allowed, until all have ended or a signal came."""
    waiting, running, done = list(jobs), [], 0
    while running or (waiting and not pair.signal):
        while waiting and len(running) < options.jobs and not pair.signal:
            running.append(waiting.pop(0))
            start(running[-1], pair, options)
        for job in [job for job in running if job.process.poll() is not None]:
            running.remove(job)
            done += 1
            complain(told(job, done, len(jobs)))
        time.sleep(0.02)


def table(rows):
    return plain(TABLE, [[shown(row[key]) for key in TABLE] for row in rows])


def shown(value):
    return f"{value:.1f}" if isinstance(value, float) else str(value if value is not None else "")


def main(arguments):
    """tools/wade many."""
    options = parse(arguments)
    jobs = jobs_of(options)
    summary = options.out / "summary.csv"
    try:
        write_csv(summary, COLUMNS, [])
    except OSError as error:
        raise UsageError(f"--out: cannot write to {options.out}: {error.strerror}") from error
    pair = Pair()
    run_all(jobs, pair, options)
    rows = [job.row() for job in jobs]
    write_csv(summary, COLUMNS, rows)
    print(table(rows))
    print(f"summary: {summary}")
    if pair.signal:
        return 130 if pair.signal == signal.SIGINT else 143
    return 0 if all(job.ended_well() for job in jobs) else 1

