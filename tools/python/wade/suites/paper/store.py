"""runs.jsonl: what is kept of single runs, a line each.

Each line is a JSON object of its own:

    {"format": 1}
    {"scene": ID, "is": {...}}               a resolved scene, without name, description and seed
    {"scene": ID, "as": ID, "but": {...}}    the same as another one before it, but for these values
    {"run": SET/WATER/CROWD, "seed": N, "scene": ID, "commit": ..., results}    see record.py

Lines are only ever appended, whole and on to the disk. Of lines with the same run, seed and scene the last one counts. A
last line without its end, as a crash leaves it, does not count.
"""

import contextlib
import fcntl
import functools
import hashlib
import json
import os

from wade.paths import CONFIGS

FORMAT = {"format": 1}
NAMES = ("run", "seed", "scene")


class StoreError(Exception):
    """The file is not what it should be."""


class Store:
    """The runs in a file, which need not exist yet. Several campaigns may add to it at once."""

    def __init__(self, file):
        self.file, self.size = file, 0
        self.scenes, self.rows = {}, {}  # by id; by (run, seed): {scene's id: record}
        self.read()

    def read(self):
        data = self.file.read_bytes() if self.file.exists() else b""
        self.size = data.rfind(b"\n") + 1
        for number, line in enumerate(data[: self.size].splitlines(), 1):
            try:
                self.take(json.loads(line))
            except (ValueError, KeyError, TypeError, AttributeError) as error:
                raise StoreError(f"{self.file}:{number}: not a line of the runs that are kept") from error

    def take(self, line):
        if "run" in line:
            record = {key: value for key, value in line.items() if key not in NAMES}
            self.rows.setdefault((line["run"], line["seed"]), {})[line["scene"]] = record
        elif "scene" in line:
            self.scenes[line["scene"]] = line["is"] if "is" in line else merged(self.scenes[line["as"]], line["but"])
        elif line != FORMAT:
            raise ValueError

    def find(self, run, seed, scene):
        """The record of a run of this scene, with the same seed; None if there is none."""
        of_run = self.rows.get((run, seed), {})
        now = seedless(scene)
        same = [record for key, record in of_run.items() if same_scene(self.scenes[key], now)]
        return of_run.get(id_of(now)) or (same[-1] if same else None)

    def seeds(self, run):
        return {seed for name, seed in self.rows if name == run}

    def add(self, run, seed, scene, record):
        """Appends a complete run."""
        with self.alone() as size:
            if size != self.size:
                self.read()  # another campaign has added runs
            kept = seedless(scene)
            key = id_of(kept)
            lines = [] if self.size else [FORMAT]
            lines += [] if key in self.scenes else [{"scene": key, "is": kept}]
            lines.append({"run": run, "seed": seed, "scene": key, **record})
            data = "".join(json.dumps(line, separators=(",", ":"), ensure_ascii=False) + "\n"
                           for line in lines).encode()
            with open(self.file, "r+b" if self.file.exists() else "wb") as file:
                file.truncate(self.size)  # of a last line that a crash cut off
                file.seek(self.size)
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            self.size += len(data)
            for line in lines:
                self.take(line)

    @contextlib.contextmanager
    def alone(self):
        """No other campaign changes the file meanwhile; gives the size that it has."""
        folder = os.open(self.file.parent, os.O_RDONLY)
        try:
            fcntl.flock(folder, fcntl.LOCK_EX)
            yield self.file.stat().st_size if self.file.exists() else 0
        finally:
            os.close(folder)


def seedless(scene):
    return {key: value for key, value in what_counts(scene).items() if key != "seed"}


def id_of(scene):
    return hashlib.sha256(json.dumps(scene, sort_keys=True).encode()).hexdigest()[:12]


def merged(base, but):
    both = dict(base)
    for key, value in but.items():
        deep = isinstance(value, dict) and isinstance(base.get(key), dict)
        both[key] = merged(base[key], value) if deep else value
    return both


def what_counts(scene):
    """The scene without the words that change no result."""
    return {key: value for key, value in scene.items() if key not in ("name", "description")}


@functools.cache
def schema():
    return json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8"))


def is_default(value, node):
    """Whether a value of a scene is what the schema gives where a scene is silent."""
    if isinstance(value, dict) and "properties" in node:
        return all(key in node["properties"] and is_default(v, node["properties"][key]) for key, v in value.items())
    return "default" in node and value == node["default"]


def silent(key, known):
    """The node of the schema that has the default of a key: a group that is silent has that of the crowd."""
    node = known.get(key, {})
    of_crowd = schema()["properties"]["crowd"]["properties"]
    return of_crowd.get(key, node) if node.get("x-default") == "that of crowd" else node


def same_scene(old, now):
    """Whether two resolved scenes are the same but for keys that older programs did not know and that have their default
    now."""
    return same_part(what_counts(old), what_counts(now), schema())


def same_part(old, now, node):
    if isinstance(old, list) and isinstance(now, list):
        return len(old) == len(now) and all(same_part(*pair, node.get("items", {})) for pair in zip(old, now))
    if not (isinstance(old, dict) and isinstance(now, dict)):
        return old == now
    known = node.get("properties", {})
    added = now.keys() - old.keys()
    return old.keys() <= now.keys() and all(is_default(now[key], silent(key, known)) for key in added) and all(
        same_part(old[key], now[key], known.get(key, {})) for key in old)
