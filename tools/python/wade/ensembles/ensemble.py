"""An ensemble: a plan, its folder, what all of its runs have in common, and their units of work."""

import contextlib
import fcntl
import hashlib
import json
import os
import resource
import secrets
import shlex
import time
from pathlib import Path

from wade import UsageError, plain_file
from wade.commands import PAIR
from wade.ensembles.folder import FAILURE, EnsembleFolder, fingerprint, is_complete, read_json
from wade.ensembles.plan import find_scenes, is_plan, plan_text, product, read_plan, scene_name
from wade.ensembles.waters import is_own_of_crowd, resolve_all, units_of
from wade.reports.files import write_whole
from wade.run.arguments import is_given, split_arguments, suit_to_latest
from wade.scenes import find_scene

FILES_OF_PROGRAM, FILES_OF_CROWD = 48, 4  # that are open with pictures: crowd_client --crowds
PATIENCE_WITH_LOCK_S = 20  # workers of a command that was killed need some time to end


def strings_of(value):
    """All texts in a JSON value."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        for part in value.values() if isinstance(value, dict) else value:
            yield from strings_of(part)


def inputs_of(scenes):
    """{file: digest of its content} of the files that resolved scenes name, which they do with absolute paths."""
    files = {text for scene in scenes for text in strings_of(scene) if text.startswith("/") and Path(text).is_file()}
    return {file: hashlib.sha256(plain_file.read_bytes(file, plain_file.TABLE_MIB)).hexdigest()[:16] for file in sorted(files)}


class Ensemble:
    """A plan, its folder, and what all runs have in common."""

    def __init__(self, options):
        self.options = options
        self.folder = EnsembleFolder(options.out)
        self.kept = plain_file.read_json(self.folder.settings) if os.path.lexists(self.folder.settings) else None
        if self.kept and not (options.resume or options.gather):
            raise UsageError(f"--out: {options.out} holds an ensemble; --resume goes on with it, --gather sums it up")
        if not self.kept and not options.scenes:
            raise UsageError(f"--out: {options.out} holds no ensemble")
        self.identity = (self.kept or {}).get("ensemble") or secrets.token_hex(4)
        self.common = self.kept["options"] if self.kept and not options.own_options else options.common
        self.pictures = options.pictures or bool(self.kept and self.kept["pictures"])
        self.plan, beside = self.planned()
        files = find_scenes(self.plan, beside)
        self.files = {scene_name(file): Path(file).resolve() for file in files.values()}
        for run in self.plan:
            run.scene = scene_name(files[run.scene])
        self.split_options()
        self.scenes = resolve_all(self.plan, self.files, self.theirs["crowd_client"])
        self.give_seeds()
        self.inputs = inputs_of([resolved for resolved, _ in self.scenes.values() if resolved])

    def planned(self):
        """Returns the plan, and the folder that relative paths in it start from."""
        names = self.options.scenes
        if not names:
            return read_plan(self.folder.plan), self.folder.path
        if is_plan(names[0]):
            return read_plan(names[0]), Path(names[0]).absolute().parent
        scenes = [str(find_scene(name)) for name in names]
        return product(scenes, self.options.seeds or [None], self.options.vary), None

    def split_options(self):
        """Sorts the options of all runs by program; water of another producer is that of tools/wade run."""
        _, own, self.theirs = split_arguments(["scene", *self.common], PAIR)
        unsuited = [name for name in own if name not in ("--producer", "--replay", "--no-figure")]
        if unsuited:
            raise UsageError(f"{unsuited[0]} is not allowed behind --: the runs would share what each needs for itself")
        self.other_water = "--producer" in own or "--replay" in own
        if not self.other_water:
            suit_to_latest(self.theirs)

    def give_seeds(self):
        """Runs without a seed get that of their scene, so that the plan says what is done."""
        for run in self.plan:
            resolved, _ = self.scenes[run.scene, run.settings_text]
            if run.seed is None and resolved is not None:
                run.seed = resolved["seed"]
        refusals = {refusal for _, refusal in self.scenes.values()}
        if None not in refusals:
            raise UsageError("no run of the plan can be done: " + "; ".join(sorted(refusals)))

    def fingerprint_of(self, run):
        resolved, _ = self.scenes[run.scene, run.settings_text]
        return resolved and fingerprint(resolved)

    def check_growth(self):
        """A plan that goes on begins as it did: what is there must be of its index."""
        if not self.kept:
            if read_json(self.folder.settings):
                raise UsageError(f"--out: {self.options.out} holds an ensemble that was begun just now; --resume goes on with it")
            return
        if self.common != self.kept["options"]:
            raise UsageError(f"--resume: options of every run are {shlex.join(self.common)}, they were "
                             f"{shlex.join(self.kept['options'])}; allowed: the same, none, or another --out")
        for file, content in self.kept["files"].items():
            if self.inputs.get(file, content) != content:
                raise UsageError(f"--resume: {file}, which scenes name, has changed since; allowed: the same file, or another --out")
        old = {run.index: (run.scene, run.seed, run.settings) for run in read_plan(self.folder.plan)}
        for run in self.plan:
            if run.index in old and old.pop(run.index) != (run.scene, run.seed, run.settings):
                raise UsageError(f"--resume: run {run.index} is {run}, which it was not in {self.folder.plan}; allowed: a plan that "
                                 "begins as that one, or another --out")
        if old:
            raise UsageError(f"--resume: run {min(old)} of {self.folder.plan} is not in this plan; allowed: a plan that begins "
                             "as that one, or another --out")

    def write(self):
        write_whole(self.folder.plan, plan_text(self.plan))
        write_whole(self.folder.settings, json.dumps({"ensemble": self.identity, "options": self.common,
                                                      "pictures": self.pictures, "files": self.inputs}, indent=1))

    def is_complete(self, run):
        expected = self.fingerprint_of(run)
        return expected is not None and is_complete(self.folder.run(run.index), expected, run.seed)

    def due(self, failed_too):
        """Returns the runs that are not complete. Failed runs count only after an accident, unless failed_too."""
        runs = [run for run in self.plan if self.fingerprint_of(run) and not self.is_complete(run)]
        if failed_too:
            return runs
        failures = ((run, read_json(self.folder.run(run.index) / FAILURE)) for run in runs)
        return [run for run, failure in failures if failure is None or failure["accident"]]

    def words_of(self, run):
        """A run as its worker needs it."""
        resolved, _ = self.scenes[run.scene, run.settings_text]
        crowd = {f"/{key}": resolved[key] for key in ("name", "description", "crowd", "coupling", "events") if key in resolved}
        water = {pointer: value for pointer, value in run.settings.items() if not is_own_of_crowd(pointer)}
        return {"index": run.index, "seed": run.seed, "fingerprint": self.fingerprint_of(run), "words": run.words(),
                "water_words": run.words(water), "crowd": {"/seed": run.seed, **crowd}}

    def prepare(self, runs):
        """Writes units of these runs; the indices to hand out."""
        options = self.options
        own_water = options.own_water or self.other_water or is_given(self.common, "--mode")
        units = units_of(runs, self.scenes, self.most_in_one_water(), own_water)
        # Of an array's tasks each has what Slurm gives it, which ensembles.one looks up.
        threads = 1 if options.engine == "slurm" else max(1, len(os.sched_getaffinity(0)) // options.jobs)
        for unit in units:
            document = {
                "ensemble": self.identity, "scene": str(self.files[unit[0].scene]), **self.theirs, "pictures": self.pictures,
                "launcher": self.common if self.other_water else None, "figures": options.figures, "threads": threads,
                "runs": [self.words_of(run) for run in unit]}
            write_whole(self.folder.unit(unit[0].index), json.dumps(document))
        return [unit[0].index for unit in units]

    def most_in_one_water(self):
        """How many crowds share a water, as many as are wanted and as files may be open."""
        files = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        if not self.pictures or files == resource.RLIM_INFINITY:
            return self.options.share
        return max(1, min(self.options.share, (files - FILES_OF_PROGRAM) // FILES_OF_CROWD))


@contextlib.contextmanager
def locked(folder):
    """One command at a time works in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with plain_file.open_lock(folder / ".lock") as lock:
        given_up_at = time.monotonic() + PATIENCE_WITH_LOCK_S
        while True:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > given_up_at:
                    raise UsageError(f"--out: another tools/wade many works in {folder}") from None
                time.sleep(0.1)
        yield
