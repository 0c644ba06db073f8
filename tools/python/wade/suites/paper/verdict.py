"""Whether the runs of reproduce_paper.py show what the paper says of its scenarios, as far as it can be told apart."""

import hashlib
import sqlite3
import struct

DRY = ("S1", "S2", "S3")
DRY_TIME_S = (38, 50)  # last arrival of S1 to S3, whose agents the water cannot push (tau = 0); 46 s in the paper
# Arrivals in the set "river": which numbers hold, and in words.
RIVER_ARRIVALS = (
    (("S4", "S5"), "all agents arrive", lambda arrived, agents: arrived == agents),
    (("S8",), "at most two agents arrive", lambda arrived, agents: arrived <= 2),
    (("S9", "S11", "S12"), "nobody arrives", lambda arrived, agents: arrived == 0),
)
MIN_SPEED, MAX_MEMORY_MB = 1, 150  # aims that are shown, never judged: they depend on the machine


class Check:
    """One sentence, and the runs for which it does not hold, each with what was found instead."""

    def __init__(self, sentence, exceptions):
        self.sentence, self.exceptions = sentence, exceptions

    @property
    def holds(self):
        return not self.exceptions

    def in_words(self):
        return f"{self.sentence}: " + ("yes" if self.holds else "NO (" + "; ".join(self.exceptions) + ")")


def name_of(run):
    return f"{run.scenario} seed {run.seed}"


def names_of(runs):
    return ", ".join(dict.fromkeys(run.scenario for run in runs))


def path_hash(folder):
    """Hash of every bit of the agents' rows in trajectories.sqlite."""
    digest = hashlib.sha256()
    database = sqlite3.connect(f"file:{folder / 'trajectories.sqlite'}?mode=ro", uri=True)
    try:
        sql = "SELECT frame, id, pos_x, pos_y, ori_x, ori_y FROM trajectory_data ORDER BY frame, id"
        for row in database.execute(sql):
            digest.update(struct.pack("<qqdddd", *row))
    finally:
        database.close()
    return digest.hexdigest()[:16]


def same_paths(scene_set, runs):
    """Runs of the same seed have bit-identical paths; nothing to tell where no seed was run twice."""
    by_seed = {}
    for run in runs:
        if not run.outcome.get("path_hash"):
            continue  # further seeds keep no paths
        by_seed.setdefault(run.seed, []).append(run)
    compared = [group for group in by_seed.values() if len(group) > 1]
    if not compared:
        return []
    exceptions = []
    for first, *others in compared:
        differ = [run for run in others if run.outcome["path_hash"] != first.outcome["path_hash"]]
        exceptions += [f"{name_of(run)} differs from {first.scenario}" for run in differ]
    together = [run for group in compared for run in group]
    return [Check(f"{scene_set} {names_of(together)}: bit-identical paths", exceptions)]


def dry_times(scene_set, runs):
    if not runs:
        return []
    low, high = DRY_TIME_S
    exceptions = []
    for run in runs:
        last = run.outcome["last_arrival_s"]
        if last is None:
            exceptions.append(f"{name_of(run)}: nobody arrived")
        elif not low <= last <= high:
            exceptions.append(f"{name_of(run)}: {last:.1f} s")
    return [Check(f"{scene_set} {names_of(runs)}: the last agent arrives after {low} to {high} s", exceptions)]


def river_arrivals(runs):
    checks = []
    for scenarios, sentence, holds in RIVER_ARRIVALS:
        chosen = [run for run in runs if run.scenario in scenarios]
        if chosen:
            exceptions = [
                f"{name_of(run)}: {run.outcome['arrived']} of {run.outcome['agents']}"
                for run in chosen
                if not holds(run.outcome["arrived"], run.outcome["agents"])
            ]
            checks.append(Check(f"river {names_of(chosen)}: {sentence}", exceptions))
    return checks


def no_clamps(runs):
    if not runs:
        return []
    exceptions = [
        f"{run.set} {name_of(run)}: {run.outcome['fluid']['position_clamps']}"
        for run in runs
        if run.outcome["fluid"]["position_clamps"] != 0
    ]
    return [Check("every run: no position clamped", exceptions)]


def checks_of(runs):
    """What can be told from these runs, all of them complete and of their scene's full duration."""
    checks = []
    for scene_set in dict.fromkeys(run.set for run in runs):
        of_set = [run for run in runs if run.set == scene_set]
        dry = [run for run in of_set if run.scenario in DRY]
        checks += same_paths(scene_set, dry) + dry_times(scene_set, dry)
        if scene_set == "river":
            checks += river_arrivals(of_set)
    return checks + no_clamps(runs)


def figures(runs):
    """The slowest run and the largest server, beside what is aimed at."""
    parts = []
    speeds = [run.speed() for run in runs if run.speed()]
    if speeds:
        parts.append(f"slowest run {min(speeds):.2g} simulated s per s of wall time (aim: at least {MIN_SPEED})")
    memory = [run.outcome["fluid"]["resident_bytes"] for run in runs if run.outcome["fluid"]["resident_bytes"]]
    if memory:
        parts.append(f"server memory at most {max(memory) / 1e6:.0f} MB (aim: under {MAX_MEMORY_MB})")
    return "; ".join(parts)


def verdict_text(checks, runs, cut_short=False):
    """The section of report.md; `cut_short` runs are not judged."""
    text = "## Verdict\n\nWhat runs must show whatever the paper says; the bands do not count here.\n\n"
    if cut_short:
        text += "None: --until-s ends the runs before their time.\n"
    elif not checks:
        text += "None: no run is complete.\n"
    else:
        text += "".join(f"* {check.in_words()}\n" for check in checks)
        missed = sum(not check.holds for check in checks)
        text += "\nAll of it holds.\n" if missed == 0 else f"\n{missed} of {len(checks)} do not hold.\n"
    shown = figures(runs)
    return text + (f"\nFigures, not judged: {shown}.\n" if shown else "")
