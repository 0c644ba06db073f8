"""The plan of an ensemble: a line a run, with its scene, its seed and what it sets in the scene."""

import csv
import io
import itertools
import json
import re
from dataclasses import dataclass, field
from pathlib import Path

from wade import UsageError, plain_file
from wade.paths import CONFIGS
from wade.scenes import find_scene

COLUMNS = ("index", "scene", "seed", "settings")
MOST_RUNS = 99999  # folders have names of five digits


@dataclass
class PlannedRun:
    """A line of the plan. seed: None = the scene's; settings: {JSON pointer: value}."""

    index: int
    scene: str
    seed: int | None
    settings: dict = field(default_factory=dict)

    @property
    def name(self):
        """Of its folder."""
        return f"{self.index:05d}"

    @property
    def settings_text(self):
        return json.dumps(self.settings)

    def words(self, settings=None):
        """Options that set what it sets, or a part of that."""
        changes = self.settings if settings is None else settings
        return [word for pointer, value in changes.items() for word in ("--set", f"{pointer}={json.dumps(value)}")]

    def __str__(self):
        seed = "" if self.seed is None else f" seed {self.seed}"
        changes = "".join(f" {pointer}={json.dumps(value)}" for pointer, value in self.settings.items())
        return f"{self.scene}{seed}{changes}"


def scene_name(file):
    """What the plan calls a scene: the short name of one of the project's, else its path."""
    file = Path(file).resolve()
    return file.relative_to(CONFIGS).with_suffix("").as_posix() if CONFIGS in file.parents else str(file)


def value_of(text):
    """A value as --set reads it: JSON, or else a word."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def split_values(text):
    """The parts of "a,b,c"; commas within brackets, braces and quotes part nothing."""
    parts, depth, quoted = [""], 0, False
    for c in text:
        quoted ^= c == '"'
        depth += (c in "[{") - (c in "]}") if not quoted else 0
        if c == "," and depth == 0 and not quoted:
            parts.append("")
        else:
            parts[-1] += c
    return parts


def varied(text):
    """(pointer, values) of "POINTER=a,b,c". ValueError says what is allowed."""
    pointer, equals, values = text.partition("=")
    parts = split_values(values)
    if not equals or not pointer.startswith("/") or not all(parts):
        raise ValueError(f'"{text}" is not allowed; allowed: POINTER=a,b,c with a JSON pointer, for example /crowd/tau=0.2,0.4')
    if pointer == "/seed":
        raise ValueError("/seed is not varied so; allowed: --seeds A-B")
    return pointer, [value_of(part) for part in parts]


def seeds_of(text):
    """The seeds of "A-B", "A" or several of them with commas between. ValueError says what is allowed."""
    seeds = []
    for part in text.split(","):
        match = re.fullmatch(r"(\d+)(?:-(\d+))?", part)
        if not match or int(match[2] or match[1]) < int(match[1]):
            raise ValueError(f'"{text}" is not allowed; allowed: A-B with whole numbers A <= B, or A, or several: 1-8,11')
        seeds += range(int(match[1]), int(match[2] or match[1]) + 1)
    return seeds


def product(scenes, seeds, variations):
    """All scenes with all seeds and all combinations of values; the seeds vary last, so that more of them can follow.

    variations: [(pointer, values)].
    """
    pointers = [pointer for pointer, _ in variations]
    if len(set(pointers)) < len(pointers):
        raise UsageError("--vary: a pointer is given twice; allowed: once, with all of its values")
    combinations = [dict(zip(pointers, values)) for values in itertools.product(*(values for _, values in variations))]
    lines = [(scene, seed, settings) for seed in seeds for scene in scenes for settings in combinations]
    return [PlannedRun(k, *line) for k, line in enumerate(lines, 1)]


def is_plan(name):
    return name.endswith(".csv")


def read_plan(file):
    """The runs of a plan; where it has no index, its lines are counted. UsageError names line, column, what is allowed."""
    try:
        text = plain_file.read_text(file)
    except plain_file.FileError as error:
        raise UsageError(f"the plan {file} cannot be read: {error.strerror}") from error
    rows = csv.DictReader(line for line in io.StringIO(text) if not line.startswith("#"))
    if not {"scene"} <= set(rows.fieldnames or ()) <= set(COLUMNS):
        raise UsageError(f"{file}: the first line is {','.join(rows.fieldnames or ())}; allowed: {','.join(COLUMNS)}")
    plan = [line_of(row, k, file) for k, row in enumerate(rows, 1)]
    if not plan:
        raise UsageError(f"{file}: no run; allowed: a line a run")
    if len({run.index for run in plan}) < len(plan):
        raise UsageError(f"{file}: an index stands in several lines; allowed: each once")
    return plan


def line_of(row, k, file):
    """A line of a plan, the k-th, as a run."""

    def refuse(column, allowed):
        raise UsageError(f'{file}, run {k}: {column}: "{row.get(column)}" is not allowed; allowed: {allowed}')

    index, seed, settings = row.get("index") or str(k), row.get("seed") or "", row.get("settings") or "{}"
    if not re.fullmatch(r"\d{1,5}", index) or int(index) < 1:
        refuse("index", f"1 to {MOST_RUNS}")
    if not re.fullmatch(r"\d*", seed):
        refuse("seed", "a whole number, or nothing for the scene's")
    try:
        changes = json.loads(settings)
    except ValueError:
        changes = None
    if not isinstance(changes, dict) or not all(key.startswith("/") and key != "/seed" for key in changes):
        refuse("settings", 'a JSON object of pointers but /seed, for example {"/crowd/tau": 0.2}')
    if not row.get("scene"):
        refuse("scene", "a file or a short name")
    return PlannedRun(int(index), row["scene"], int(seed) if seed else None, changes)


def find_scenes(plan, beside):
    """{scene as the plan has it: its file}; a relative path may start at the plan's folder."""
    files = {}
    for name in dict.fromkeys(run.scene for run in plan):
        near = beside / name if beside else None
        files[name] = near if near and near.is_file() else find_scene(name)
    return files


def plan_text(plan):
    """plan.csv."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for run in plan:
        writer.writerow([run.index, run.scene, "" if run.seed is None else run.seed, run.settings_text])
    return text.getvalue()
