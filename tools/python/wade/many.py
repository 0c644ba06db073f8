"""Runs a plan: each SCENE, with each seed and each combination of values, or the lines of PLAN, several at once.

Runs share one water if their scenes differ only in the crowd and neither seed nor people change the water. Writes
DIR/runs/NNNNN/, a run folder for each, and DIR/runs.csv, and prints a table. A run that fails does not stop the others;
what is complete is never done again. Ctrl-C ends all of them, and --resume goes on.
"""

import argparse
import contextlib
import os
import re
import shlex
import shutil
import time
from pathlib import Path

from wade import UsageError, plain_file
from wade.ensembles.engines import ENGINES, Signals, still_queued
from wade.ensembles.ensemble import Ensemble, locked
from wade.ensembles.folder import fingerprint, read_json, remove_left_overs
from wade.ensembles.gather import columns_of, gathered, said_of_sites
from wade.ensembles.plan import is_plan, seeds_of, varied
from wade.reports.files import complain
from wade.reports.options import whole
from wade.reports.tables import plain, write_csv
from wade.run.arguments import is_given, values_of
from wade.run.folders import new_folder
from wade.terminal import Parser

TABLE = ("scene", "seed", "status", "arrived", "dead", "active", "last_arrival_s", "frame_hash")
MOST_ROWS = 40  # of the table that is printed
MOST_FAILURES = 20

EPILOG = """Behind -- stand options for every run, for example -- --until-s 60 --set /crowd/mass_kg=80; see tools/wade run --help.
Not allowed there are --out, --session, --record, --commands and --view, which each run needs for itself, --crowds, and --seed
and --set /seed. Unless --threads is among them, the pairs share the processors evenly.

Exit code: 0 if all runs are complete, 1 if one is not, 2 bad usage, 130/143 interrupted."""


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


def type_of(read):
    """A type for the parser of what raises ValueError."""

    def reading(text):
        try:
            return read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return reading


def build_parser():
    parser = Parser("many", __doc__, EPILOG, usage="tools/wade many [options] SCENE ... | PLAN [-- options of every run]")
    add = parser.add_argument
    add("scenes", nargs="*", metavar="SCENE|PLAN", help="files or short names, as in tools/wade run; or a plan, a file whose "
        "name ends in .csv, with the columns index,scene,seed,settings. None: the plan of --out")
    add("--seeds", type=type_of(seeds_of), metavar="A-B", help="whole numbers, for example 1-8 or 1-8,11 [the scene's own]")
    add("--vary", type=type_of(varied), action="append", default=[], metavar="POINTER=a,b,c",
        help="each of these values of a scene's key, for example /crowd/tau=0.2,0.4; repeated: all combinations")
    add("--out", type=Path, metavar="DIR", help="[runs/many-<time>/ in the project]")
    add("--engine", choices=ENGINES, default="local", help="what hands out the runs: processes of this machine, GNU parallel, "
        "an array of Slurm, ranks of mpirun (docs/clusters.md) [local]")
    add("--engine-options", type=shlex.split, default=[], metavar="WORDS",
        help="for parallel, sbatch or mpirun, for example '--partition=short --time=60'")
    add("--jobs", type=whole(1), metavar="N", help="at once; of Slurm's array [half the processors, at least 1; Slurm: all]")
    add("--resume", action="store_true", help="go on in DIR: what is complete stays; the plan may have grown")
    add("--prepare", action="store_true", help="only write what workers need, and print the indices to hand out")
    add("--gather", action="store_true", help="only gather what is there")
    add("--own-water", action="store_true", help="each run computes its own water")
    add("--share", type=whole(1), default=200, metavar="N", help="at most N runs share a water, and are done together [200]")
    add("--tries", type=whole(1), default=3, metavar="N", help="of a run that was killed or whose peer was lost [3]")
    add("--pictures", action="store_true", help="keep paths and pictures of the water, too")
    add("--figures", action="store_true", help="draw figure.png of each run; implies --pictures")
    add("--reproducible", action="store_true", help="no times and no host names in outputs")
    return parser


def refuse_misfits(parser, options):
    for name in ("--out", "--session", "--record", "--commands", "--view", "--view-port"):
        if is_given(options.common, name):
            parser.error(f"{name} is not allowed behind --: the runs would share what each needs for itself")
    seeded = is_given(options.common, "--seed") or any(value.split("=")[0] == "/seed"
                                                       for value in values_of(options.common, "--set"))
    if seeded:
        parser.error("--seed and --set /seed are not allowed behind --: all runs would have the same seed; allowed: --seeds")
    if is_given(options.common, "--crowds"):
        parser.error("--crowds is not allowed behind --: runs share a water by themselves, where they can")
    plans = [name for name in options.scenes if is_plan(name)]
    if plans and (len(options.scenes) > 1 or options.seeds or options.vary):
        parser.error(f"{plans[0]} is a plan, in which scenes, seeds and settings stand; allowed beside it: no other")
    if not options.scenes and not (options.out and (options.resume or options.gather)):
        parser.error("SCENE or PLAN is needed; without one allowed: --out DIR with --resume or --gather")


def parse(arguments):
    common = []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, common = arguments[:at], arguments[at + 1 :]
    parser = build_parser()
    options, others = parser.parse_known_args(arguments)
    if others:
        parser.error(f"{others[0]}: options of the runs stand behind --, for example: SCENE... -- {' '.join(others)}")
    options.own_options = bool(common) or options.reproducible
    options.common = [*common, *(["--reproducible"] if options.reproducible and "--reproducible" not in common else [])]
    refuse_misfits(parser, options)
    options.pictures |= options.figures
    options.jobs_given = options.jobs is not None
    options.jobs = options.jobs or max(1, len(os.sched_getaffinity(0)) // 2)
    options.out = options.out or new_folder("many")
    return options


def hand_out(ensemble, signals):
    """Lets the engine do what is due, once more for what was lost."""
    options, told = ensemble.options, Progress(ensemble)
    for k in range(options.tries):
        indices = ensemble.prepare(ensemble.due(failed_too=k == 0))
        if not indices or signals.number:
            break
        if k > 0:
            complain(f"once more: {len(indices)} of what was handed out, which was lost")
        ENGINES[options.engine](ensemble.folder, indices, options, signals, told)


class Progress:
    """Tells of runs that have ended and of the time left; of engines that do not say which runs, the count."""

    CROWDS = re.compile(r"^t ([\d.]+) s  (\d+) of (\d+) crowds walk.* ([\d.]+) x real time$", re.MULTILINE)

    def __init__(self, ensemble):
        self.ensemble, self.told = ensemble, set()
        self.runs = {run.index: run for run in ensemble.plan}
        self.total = len(ensemble.plan)
        self.done = self.those_there()
        self.started, self.before = time.monotonic(), len(self.done)

    def those_there(self):
        return {run.index for run in self.ensemble.plan if self.ensemble.folder.run(run.index).is_dir()}

    def left(self):
        """", 5 min left" at the pace since the start; "" before the first run has ended, and after the last."""
        made = len(self.done) - self.before
        passed = time.monotonic() - self.started
        return f", {duration(passed * (self.total - len(self.done)) / made)} left" if 0 < made and len(self.done) < self.total else ""

    def __call__(self, index):
        if index is None:
            there = self.those_there()
            if there != self.done:
                self.done = there
                complain(f"[{len(there)}/{self.total}]{self.left()}")
            self.tell_of_waters()
            return
        unit = read_json(self.ensemble.folder.unit(index))
        rows = rows_of(self.ensemble, [self.runs[run["index"]] for run in unit["runs"]])
        for row in rows:
            self.done.add(row["index"])
            left = self.left() if row is rows[-1] else ""  # runs of one water end together
            complain(f"[{len(self.done)}/{self.total}] {told_of(row, self.ensemble.folder)}{left}")

    def tell_of_waters(self):
        """Tells how far runs are that share a water, from what their crowds print."""
        for log in sorted(self.ensemble.folder.work.glob("*/water/crowd_client.log")):
            lines = self.CROWDS.findall(plain_file.read_text(log, "replace"))
            if not lines or (log, lines[-1]) in self.told:
                continue
            self.told.add((log, lines[-1]))
            now, walking, crowds, pace = lines[-1]
            scene = read_json(log.parent / name_of_first(log.parent) / "manifest.json") or {}
            end = scene.get("resolved_scene", {}).get("duration_s")
            left = f", at most {duration((end - float(now)) / float(pace))} left" if end and float(pace) > 0 else ""
            complain(f"[{len(self.done)}/{self.total}] {int(crowds) - int(walking)} of {crowds} runs of one water have ended, "
                     f"t {float(now):g} s{f' of {end:g} s' if end else ''}{left}")


def name_of_first(folder):
    """The name of the first run in the folder of a water."""
    return min((made.name for made in folder.iterdir() if made.is_dir()), default="")


def duration(seconds):
    """A time in words: "40 s", "12 min", "3.5 h"."""
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


def short(scene):
    """A scene by its last folder and its name."""
    return "/".join(Path(scene).with_suffix("").parts[-2:])


def told_of(row, folder):
    words = f"{short(row['scene'])} seed {row['seed']}: {row['status']}"
    if row["status"] == "completed":
        sheltered = f", {row['sheltered']} sheltered" if "sheltered" in row else ""
        return f"{words}, {row['arrived']} of {row['agents']} arrived{sheltered}, {row['dead']} dead"
    return f"{words}, see {folder.run(row['index'])}"


def rows_of(ensemble, plan):
    known = {kind: (resolved and fingerprint(resolved), refusal) for kind, (resolved, refusal) in ensemble.scenes.items()}
    return gathered(ensemble.folder, plan, known)


def shown(value, is_setting=False):
    if isinstance(value, float):
        return f"{value:g}" if is_setting else f"{value:.1f}"
    return str(value if value is not None else "")


def say_all(rows, pointers):
    """Prints the table: a line per run, or for many runs a line per scene and settings; then the failed runs."""
    rows = [{**row, "scene": short(row["scene"])} for row in rows]
    of_site = said_of_sites(rows)
    if len(rows) <= MOST_ROWS:
        columns = [*TABLE[:2], *pointers, *TABLE[2:4], *of_site, *TABLE[4:]]
        print(plain(columns, [[shown(row.get(key), key in pointers) for key in columns] for row in rows]))
    else:
        kinds = {}
        for row in rows:
            kinds.setdefault((row["scene"], *(shown(row.get(key), True) for key in pointers)), []).append(row)
        lines, counts = [], ("agents", "arrived", *of_site, "dead", "active")
        for kind, own in kinds.items():
            complete = [row for row in own if row["status"] == "completed"]
            means = []
            for key in counts:
                told = [row[key] for row in complete if key in row]
                means.append(sum(told) / len(told) if told else None)
            lines.append([*kind, len(own), len(complete), *map(shown, means)])
        print(plain(["scene", *pointers, "runs", "completed", *counts], lines))
    failures = [row for row in rows if row["status"] != "completed"]
    for row in failures[:MOST_FAILURES]:
        complain(f"{row['index']}: {row['scene']} seed {row['seed']}: {row['status']}: {row['reason']}")
    if len(failures) > MOST_FAILURES:
        complain(f"... and {len(failures) - MOST_FAILURES} more, see runs.csv")


def sum_up(ensemble):
    """Writes and prints the table; whether all runs are complete."""
    rows = rows_of(ensemble, ensemble.plan)
    pointers = list(dict.fromkeys(pointer for run in ensemble.plan for pointer in run.settings))
    write_csv(ensemble.folder.table, columns_of(rows, pointers), rows)
    say_all(rows, pointers)
    commits = {row["commit"] for row in rows if row.get("commit")}
    if len(commits) > 1:
        complain(f"warning: the runs are of several versions: {', '.join(sorted(commits))}")
    print(f"table: {ensemble.folder.table}")
    complete = all(row["status"] == "completed" for row in rows)
    if complete:
        shutil.rmtree(ensemble.folder.work, ignore_errors=True)
    return complete


def carry_out(ensemble):
    """Prepares, hands out and gathers; the exit code."""
    options, folder = ensemble.options, ensemble.folder
    ensemble.check_growth()
    if options.gather:
        return 0 if sum_up(ensemble) else 1
    job = still_queued(folder)
    if job:
        raise UsageError(f"--resume: job {job} of this ensemble is not over; wait for it, or scancel {job}")
    ensemble.write()
    if options.prepare:
        print(*ensemble.prepare(ensemble.due(failed_too=True)), sep="\n")
        return 0
    signals = Signals()
    remove_left_overs(ensemble.identity, folder.work)
    hand_out(ensemble, signals)
    remove_left_overs(ensemble.identity, folder.work)
    complete = sum_up(ensemble)
    if signals.number:
        complain("interrupted; the same command with --resume goes on")
        return 128 + signals.number if signals.number == 2 else 143
    return 0 if complete else 1


def main(arguments):
    """tools/wade many."""
    options = parse(arguments)
    ensemble = Ensemble(options)
    try:
        with contextlib.nullcontext() if options.gather else locked(ensemble.folder.path):
            return carry_out(ensemble)
    except UsageError:  # of a file that is read
        raise
    except OSError as error:
        raise UsageError(f"--out: cannot write to {options.out}: {error.strerror}") from error
