"""The validation cases as the program `validate` lists them, and which of their runs there are to do."""

import fnmatch
import json
import subprocess

from wade.paths import CONFIGS
from wade.reports.files import complain
from wade.reports.options import choose, patterns_of

LEVELS = ("coarse", "medium", "fine")
# What a run reads beside the program.
INPUTS = ("configs/**/*.json", "tests/validation/data/**/*")
FOLLOWS_PEOPLE = ("mixed",)  # its particles follow the people of one crowd, by the agents stream of every frame


class Case:
    """A line of `validate --list`: NAME SPACING... [quick=LEVEL] [long=LEVEL] [starts=N]."""

    def __init__(self, line):
        self.name, *words = line.split()
        marks = dict(word.split("=") for word in words if "=" in word)
        self.spacings = [float(word) for word in words if "=" not in word]
        self.levels = LEVELS[: len(self.spacings)]
        self.quick = marks.get("quick")
        self.long_from = LEVELS.index(marks["long"]) if "long" in marks else len(LEVELS)
        self.starts = int(marks.get("starts", 1))

    def starts_at(self, level):
        """Returns how many runs the medians are taken over."""
        return self.starts if LEVELS.index(level) < self.long_from else 1

    def describe(self):
        quick = f"; quick: {self.quick}" if self.quick else ""
        long = f"; long from {LEVELS[self.long_from]} on" if self.long_from < len(self.levels) else ""
        starts = f"; medians of {self.starts} starts" if self.starts > 1 else ""
        return f"{self.name}: {', '.join(f'{spacing:g}' for spacing in self.spacings)}{quick}{long}{starts}"


def list_cases(program):
    text = subprocess.run([program, "--list"], check=True, capture_output=True, text=True).stdout
    return [Case(line) for line in text.splitlines() if line.strip()]


def plan(cases, patterns, levels, quick, long):
    """List of (case, level): all coarse runs first, so that results come early."""
    chosen = choose(cases, patterns)
    allowed = patterns_of(levels) or LEVELS
    for level in allowed:
        if level not in LEVELS:
            raise ValueError(f"--levels {level}: allowed: {', '.join(LEVELS)}")
    runs = [(case, level) for index, level in enumerate(LEVELS) for case in chosen if (not quick or case.quick == level)
            and level in allowed and level in case.levels and (long or index < case.long_from)]
    if not runs:
        raise ValueError("nothing to run: the cases chosen have none of these resolutions, take hours or are not quick")
    if left := left_out(patterns, runs):
        complain(f"left out, as they have none of these resolutions, take hours or are not quick: {', '.join(left)}")
    return runs


def left_out(patterns, runs):
    """Returns the patterns that match none of these runs."""
    names = {case.name for case, _ in runs}
    return [pattern for pattern in patterns_of(patterns) if not fnmatch.filter(names, pattern)]


def known_models():
    """The models of the water, as /fluid/model names them."""
    schema = json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8"))
    return schema["properties"]["fluid"]["properties"]["model"]["enum"]


def model_changes(model):
    """(JSON pointer, value) that make a scene's water that of a model."""
    follows = (("/coupling/agents_stream", "serial"),) if model in FOLLOWS_PEOPLE else ()
    return (("/fluid/model", model), *follows)


def model_overrides(model):
    """The same as values of --set."""
    return [f"{pointer}={value}" for pointer, value in model_changes(model)]
