"""What runs must show whatever the paper says; it decides the exit code."""

import hashlib
import struct
from dataclasses import dataclass

from wade import plain_file
from wade.reports.tables import section

DRY = ("S1", "S2", "S3")
DRY_TIME_S = (38, 50)  # last arrival of S1 to S3, where water cannot push the agents (tau = 0); 46 s in the paper
# Arrivals in the set "river": which numbers hold, and in words.
RIVER_ARRIVALS = (
    (("S4", "S5"), "all agents arrive", lambda arrived, agents: arrived == agents),
    (("S8",), "at most two agents arrive", lambda arrived, agents: arrived <= 2),
    (("S9", "S11", "S12"), "nobody arrives", lambda arrived, agents: arrived == 0),
)


@dataclass
class Check:
    """A condition as a sentence, and the runs that break it, each with what was found instead."""

    sentence: str
    exceptions: list

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
    with plain_file.database(folder / "trajectories.sqlite") as database:
        sql = "SELECT frame, id, pos_x, pos_y, ori_x, ori_y FROM trajectory_data ORDER BY frame, id"
        for row in database.execute(sql):
            digest.update(struct.pack("<qqdddd", *row))
    return digest.hexdigest()[:16]


def same_paths(scene_set, runs):
    """Runs of the same seed have bit-identical paths; nothing to tell where no seed was run twice."""
    by_seed = {}
    for run in runs:
        if run.outcome.get("path_hash"):  # further seeds keep no paths
            by_seed.setdefault(run.seed, []).append(run)
    compared = [group for group in by_seed.values() if len(group) > 1]
    exceptions = [f"{name_of(run)} differs from {first.scenario}" for first, *others in compared for run in others
                  if run.outcome["path_hash"] != first.outcome["path_hash"]]
    names = names_of(run for group in compared for run in group)
    return [Check(f"{scene_set} {names}: bit-identical paths", exceptions)] if compared else []


def dry_times(scene_set, runs):
    low, high = DRY_TIME_S
    exceptions = []
    for run in runs:
        last = run.outcome["last_arrival_s"]
        if last is None or not low <= last <= high:
            exceptions.append(f"{name_of(run)}: " + ("nobody arrived" if last is None else f"{last:.1f} s"))
    sentence = f"{scene_set} {names_of(runs)}: the last agent arrives after {low} to {high} s"
    return [Check(sentence, exceptions)] if runs else []


def river_arrivals(runs):
    for scenarios, sentence, holds in RIVER_ARRIVALS:
        chosen = [run for run in runs if run.scenario in scenarios]
        if chosen:
            yield Check(f"river {names_of(chosen)}: {sentence}", [
                f"{name_of(run)}: {run.outcome['arrived']} of {run.outcome['agents']}" for run in chosen
                if not holds(run.outcome["arrived"], run.outcome["agents"])])


def no_clamps(runs):
    exceptions = [f"{run.set} {name_of(run)}: {clamps}" for run in runs
                  if (clamps := run.outcome["fluid"]["position_clamps"]) != 0]
    return [Check("every run: no position clamped", exceptions)] if runs else []


def checks_of(runs):
    """What can be told from these runs, all of them complete and of their scene's full duration."""
    checks = []
    for scene_set in dict.fromkeys(run.set for run in runs):
        of_set = [run for run in runs if run.set == scene_set]
        dry = [run for run in of_set if run.scenario in DRY]
        checks += same_paths(scene_set, dry) + dry_times(scene_set, dry)
        checks += river_arrivals(of_set) if scene_set == "river" else []
    return checks + no_clamps(runs)


def verdict_text(checks, cut_short=False):
    """The section of report.md; `cut_short` runs are not judged."""
    missed = sum(not check.holds for check in checks)
    found = "All of it holds." if missed == 0 else f"{missed} of {len(checks)} do not hold."
    if cut_short or not checks:
        found = f"None: {'--until-s ends the runs before their time' if cut_short else 'no run is complete'}."
    return section("Verdict", "What runs must show whatever the paper says; the bands do not count here.",
                   "\n".join(f"* {check.in_words()}" for check in checks), found)
