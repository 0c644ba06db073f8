"""Reads the runs of an ensemble: a folder that `tools/wade many` wrote, or any folder with run folders in it.

Only runs that are complete count; each scene with its settings is a case of its own.
"""

import json
import os
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from wade import UsageError, plain_file, progress
from wade.ensembles.folder import EnsembleFolder, read_json, why_incomplete
from wade.ensembles.plan import read_plan
from wade.states import ENDS, IN_HOUSES, check_states, end_of, kind_of

SWEPT_AWAY = "swept away"  # kind: over the outfall, or out of the map with the water
# Columns of each table, by the end: all that follows is a part of lost or of no end yet, and a column only if it occurs.
LOST, NO_END = "lost", "no end yet"
ALWAYS = ("arrived", "sheltered", LOST, NO_END)
AGE_CLASSES = ((15, "under 15"), (65, "15 to 64"), (200, "65 and over"))  # those of the United Nations' tables
MOST_NAMES = 20  # of runs that are left out
SQUARE_M = 20  # side of a square where people start
FLOODED, DEEP_M = "in flooded houses", 0.5  # the kind of people indoors with more water than that at their door
IN_A_HOUSE = ("indoors", FLOODED, "upstairs")  # kinds that no longer run decides, as houses are not modelled
NUMBERS = ("time_s", "x_m", "z_m", "tau", "mass_kg", "max_depth_m", "height_m", "age", "start_x_m", "start_z_m", "off_feet_s",
           "door_depth_m", "adrift_s", "exposure_s", "can_swim")  # of agents.csv
TEXTS = ("group", "outcome", "state", "skill", "worst_state", "drift_end")
# agents.csv has had these for a shorter time.
OLDER = ("age", "skill", "worst_state", "start_x_m", "start_z_m", "off_feet_s", "door_depth_m", "adrift_s", "exposure_s",
         "drift_end", "can_swim")


@dataclass
class Run:
    """A complete run: its folder, seed, outcome.json, and the columns of agents.csv."""

    folder: Path
    seed: int
    outcome: dict
    columns: tuple


@dataclass
class Case:
    """All complete runs of a scene with its settings; people: arrays by column, `run` counts from 0."""

    scene: str
    settings: dict
    runs: list = field(default_factory=list)
    people: dict = field(default_factory=dict)

    @property
    def name(self):
        values = ", ".join(f"{key.rpartition('/')[2]} {value if isinstance(value, str) else json.dumps(value)}"
                           for key, value in self.settings.items())
        return f"{self.scene}, {values}" if values else self.scene

    @property
    def seeds(self):
        return [run.seed for run in self.runs]

    def manifest(self):
        return plain_file.read_json(self.runs[0].folder / "manifest.json")

    def counts(self, chosen):
        """How many people of each run are chosen, an array of truth values over people."""
        return np.bincount(self.people["run"][chosen], minlength=len(self.runs))


@dataclass
class Ensemble:
    """What a folder holds; left_out: {why: names of the runs}."""

    folder: Path
    cases: list
    left_out: dict

    def left_out_words(self):
        """The runs that do not count, each with its reason; "" if all do. Of more than MOST_NAMES with one reason the first."""
        return "; ".join(f"{', '.join(names[:MOST_NAMES])}{f' and {more} more' if (more := len(names) - MOST_NAMES) > 0 else ''} ({why})"
                         for why, names in sorted(self.left_out.items()))


def planned(folder):
    """[(run folder, scene, settings, seed, why it does not count)] of an ensemble's plan; None without one."""
    ensemble = EnsembleFolder(folder)
    if not os.path.lexists(ensemble.plan):
        return None
    rows = plain_file.read_table(ensemble.table) if os.path.lexists(ensemble.table) else ()
    stale = {row["index"] for row in rows if row["status"] == "stale"}
    return [(ensemble.run(run.index), run.scene, run.settings, run.seed, "stale" if str(run.index) in stale else "")
            for run in read_plan(ensemble.plan)]


def found(folder):
    """The same of run folders anywhere in a folder without a plan; runs of the same scene are one case."""
    seen, folders = set(), []
    for path, inner, files in os.walk(folder, followlinks=True):
        inner.sort()
        real = os.path.realpath(path)
        if real in seen:  # a link that leads round
            inner.clear()
        elif {"outcome.json", "agents.csv"} & {*files, *inner}:
            folders.append(Path(path))
        seen.add(real)
    return [(run, None, {}, None, "") for run in sorted(folders)]


def read_outcome(folder, seed=None):
    """(outcome or None, why it does not count) of a run; seed: that of the plan."""
    if why_not := why_incomplete(folder):
        return None, why_not
    outcome = read_json(folder / "outcome.json")
    return (outcome, "") if seed in (None, outcome["seed"]) else (None, "of another seed")


def read_people(file, words):
    """(columns of an agents.csv as arrays, with `fate`, `dead`, `safe`, `indoors`; their names). words: each text, once."""
    columns = plain_file.read_columns(file)
    missing = [name for name in (*NUMBERS, *TEXTS) if name not in (*columns, *OLDER)]
    if missing:
        raise UsageError(f"{file}: no column {missing[0]}")
    check_states(file, columns["outcome"], columns["state"])
    count = len(columns["state"])
    nothing = ("",) * count
    try:
        people = {name: np.array([float(one) if one else np.nan for one in columns.get(name, nothing)]) for name in NUMBERS}
    except ValueError as error:
        raise plain_file.FileError(file, str(error)) from error
    for name in TEXTS:
        people[name] = np.array([words.setdefault(one, one) for one in columns.get(name, nothing)], dtype=object)
    people["fate"] = np.array([kind_of(state) for state in people["state"]], dtype=object)
    people["fate"][(people["fate"] == "indoors") & (people["door_depth_m"] > DEEP_M)] = FLOODED
    ends = np.array([end_of(outcome) for outcome in people["outcome"]])
    people["dead"], people["safe"] = ends == "lost", ends == "safe"
    people["indoors"] = np.isin(people["outcome"].astype(str), IN_HOUSES)
    people["skill"][people["worst_state"] == ""] = ""  # of no effect with a given tau
    return people, tuple(columns)


def read_ensemble(folder):
    """The complete runs of a folder; UsageError if there is none."""
    folder = Path(folder)
    if not folder.is_dir():
        raise UsageError(f"{folder}: there is no such folder")
    listed = planned(folder)
    cases, people, left_out, seen, words = {}, {}, {}, set(), {}
    for run_folder, scene, settings, seed, why_not in progress.over(found(folder) if listed is None else listed, "reads the runs"):
        outcome, why_not = (None, why_not) if why_not else read_outcome(run_folder, seed)
        if why_not:
            left_out.setdefault(why_not, []).append(os.path.relpath(run_folder, folder))
            continue
        name = outcome["scene"] if scene is None else "/".join(Path(scene.removesuffix(".json")).parts[-2:])
        key = (name, json.dumps(settings, sort_keys=True))
        seed = outcome["seed"]
        if (key, seed) in seen:
            left_out.setdefault("twice the same seed", []).append(os.path.relpath(run_folder, folder))
            continue
        seen.add((key, seed))
        case = cases.setdefault(key, Case(name, settings))
        of_run, columns = read_people(run_folder / "agents.csv", words)
        people.setdefault(key, []).append({**of_run, "run": np.full(len(of_run["dead"]), len(case.runs))})
        case.runs.append(Run(run_folder, seed, outcome, columns))
    if not cases:
        why = Ensemble(folder, [], left_out).left_out_words()
        raise UsageError(f"{folder}: no complete run in it{f' ({why})' if why else ''}")
    for key, case in cases.items():
        parts = people.pop(key)
        case.people = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    progress.at(f"computes and draws what {sum(len(case.runs) for case in cases.values())} runs say")
    return Ensemble(folder, list(cases.values()), left_out)


def age_class(age):
    return next(words for end, words in AGE_CLASSES if age < end) if age == age else ""


def start_place(x, z):
    """Returns the square of 20 m of a start position, "x 60, z 0" by its lower corner; "" if it is not known."""
    return f"x {x // SQUARE_M * SQUARE_M:.0f}, z {z // SQUARE_M * SQUARE_M:.0f}" if x == x else ""


BY = {
    "all": lambda people: np.full(len(people["run"]), "all", dtype=object),
    "group": lambda people: people["group"],
    "age": lambda people: np.array([age_class(age) for age in people["age"]], dtype=object),
    "skill": lambda people: people["skill"],
    "start": lambda people: np.array([start_place(*at) for at in zip(people["start_x_m"], people["start_z_m"])], dtype=object),
}


def classes(case, by):
    """[(class, its people as truth values)]; none without a value of any person."""
    values = BY[by](case.people)
    order = {words: place for place, (_, words) in enumerate(AGE_CLASSES)} if by == "age" else {}
    names = dict.fromkeys(values.tolist())
    names = sorted(names, key=lambda name: (order.get(name, 0), _number_first(name))) if by in ("age", "start") else names
    return [(name, values == name) for name in names if name]


def _number_first(name):
    return [float(word) for word in name.replace(",", "").split() if word.lstrip("-").isdigit()]


def has_feet(case):
    """Returns true if at least one person lost the feet; only people with the response `measured` can."""
    return bool((~np.isnan(case.people["off_feet_s"])).any())


def fates_of(*cases):
    """The fates in the order of the columns: those of all tables, then the kinds that occur, the lost first."""
    there = {fate for case in cases for fate in case.people["fate"].tolist()}
    order = [*ENDS]
    order.insert(order.index("indoors"), FLOODED)
    known = [kind for kind in order if kind in there] + sorted(there - set(order))
    return [*ALWAYS, *(kind for end in ("lost", "none") for kind in known if ENDS.get(kind, "none") == end)]


def open_kinds(*cases):
    """Returns {kind: share of all people} of the people without an end yet, over all cases together."""
    people = sum(len(case.people["run"]) for case in cases)
    counts = Counter(fate for case in cases for fate in case.people["fate"][having(case.people, NO_END)].tolist())
    return {kind: counts[kind] / people for kind in fates_of(*cases) if counts[kind]}


def having(people, fate):
    """Which people have a fate of fates_of(), as truth values."""
    sums = {LOST: people["dead"], NO_END: ~people["safe"] & ~people["dead"]}
    return sums[fate] if fate in sums else people["fate"] == fate
