"""The folder of an ensemble: what is complete in it, how a run gets into it whole, and what dead workers left."""

import errno
import hashlib
import json
import os
import re
from pathlib import Path

from wade import plain_file

FAILURE = "failure.json"
# Ends that another try may not meet: a time-out, a peer that died or gave up, a name in use, a kill.
ACCIDENTS = (3, 4, 5, 7, 8)


def digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


def fingerprint(resolved):
    """Of a resolved scene but for its seed."""
    return digest({key: value for key, value in resolved.items() if key != "seed"})


def is_accident(code):
    return code in ACCIDENTS or code > 128


def read_json(file):
    """A JSON file; None if there is none that is whole."""
    try:
        return plain_file.read_json(file)
    except plain_file.FileError:
        return None


def messages_of(text):
    """The messages of a log, each in one line, however the console broke it."""
    return [line for line in re.sub(r"\n {2,}", " ", text).splitlines() if line.strip()]


def message_of(text):
    """The last message of a log, "" if there is none."""
    return (messages_of(text) or [""])[-1]


def name_of(index):
    """Of the folder of a run."""
    return f"{index:05d}"


class EnsembleFolder:
    """DIR of `tools/wade many`."""

    def __init__(self, path):
        self.path = Path(path).absolute()
        self.plan, self.settings, self.table = self.path / "plan.csv", self.path / "ensemble.json", self.path / "runs.csv"
        self.runs, self.work = self.path / "runs", self.path / "work"
        self.units, self.waters = self.path / "units", self.path / "waters"

    def run(self, index):
        return self.runs / name_of(index)

    def unit(self, index):
        return self.units / f"{name_of(index)}.json"


def status_of(folder, expected, seed):
    """Returns `not_run`, `stale`, `failed` or the status in outcome.json; `completed` means that all files are there.

    expected: the fingerprint of its scene.
    """
    if not folder.is_dir():
        return "not_run"
    outcome, manifest = read_json(folder / "outcome.json"), read_json(folder / "manifest.json")
    if outcome is None or manifest is None:
        return "failed"
    if manifest.get("seed") != seed or fingerprint(manifest.get("resolved_scene", {})) != expected:
        return "stale"
    status = outcome.get("status", "failed")
    return status if status != "completed" or not fault_of_agents(folder, outcome) else "failed"


def fault_of_agents(folder, outcome):
    """Returns why agents.csv does not count; empty if it has a whole line for each agent."""
    try:
        with plain_file.open_plain(folder / "agents.csv", plain_file.TABLE_MIB) as file:
            lines = sum(piece.count(b"\n") for piece in iter(lambda: file.read(1 << 20), b""))
        return "" if lines == outcome["agents"] + 1 else "agents.csv cut off"
    except plain_file.FileError as error:
        return "no agents.csv" if error.errno == errno.ENOENT else f"{Path(error.filename).name}: {error.strerror}"


def why_incomplete(folder):
    """Why a run folder does not count; "" if it is complete."""
    if not folder.is_dir():
        return "not run"
    files = {}
    for name in ("outcome.json", "manifest.json"):
        try:
            files[name] = plain_file.read_json(folder / name)
        except plain_file.FileError as error:
            return f"no {name}" if error.errno == errno.ENOENT else f"{name}: {error.strerror}"
    outcome = files["outcome.json"]
    missing = [key for key in ("status", "seed", "scene", "agents", "sim_time_s") if key not in outcome]
    if missing:
        return f"outcome.json without {missing[0]}"
    if "resolved_scene" not in files["manifest.json"]:
        return "manifest.json without resolved_scene"
    if outcome["status"] != "completed":
        return str(outcome["status"])
    return fault_of_agents(folder, outcome)


def is_complete(folder, expected, seed):
    return status_of(folder, expected, seed) == "completed"


def publish(made, place, expected, seed):
    """Moves a run that was made elsewhere into its folder by a rename; a complete run there stays."""
    aside = made.with_name(f"{made.name}.old")
    for _ in range(3):
        if is_complete(place, expected, seed):
            remove_tree(made)
            return
        try:
            if place.exists():
                place.rename(aside)
                remove_tree(aside)
            made.rename(place)
            return
        except OSError:  # another worker was quicker
            continue
    raise OSError(f"{made} cannot be moved to {place}")


def remove_tree(folder):
    """Removes a folder and what is left in it."""
    try:
        folder.rmdir()  # mostly nothing is, and nothing more has to be imported
    except OSError:
        import shutil

        shutil.rmtree(folder, ignore_errors=True)


def alive(pid):
    return Path(f"/proc/{pid}").is_dir()


def host_name():
    return re.sub(r"[^A-Za-z0-9.]", "", os.uname().nodename)[:60] or "host"


def worker_name(ensemble, index):
    """Returns the name of a worker's own folder and session: ensemble, index, job of the engine, host and process."""
    job = os.environ.get("SLURM_JOB_ID") or os.environ.get("PARALLEL_PID") or "0"
    return f"wade-many-{ensemble}-{name_of(index)}-{job}-{os.urandom(3).hex()}-{host_name()}-{os.getpid()}"


def is_left_over(name):
    """Returns true if the worker of this name ran on this machine and is gone; false for other machines."""
    match = re.fullmatch(r"wade-many-[0-9a-f]+-\d+-\d+-[0-9a-f]+-([A-Za-z0-9.]+)-(\d+)", name)
    return bool(match) and match[1] == host_name() and not alive(match[2])


def remove_left_overs(ensemble, work):
    """Removes segments and half-made runs of workers of this ensemble that were killed on this machine."""
    for segment in Path("/dev/shm").glob(f"wade-many-{ensemble}-*"):
        if is_left_over(re.sub("-(fluid|agents)$", "", segment.name)):
            segment.unlink(missing_ok=True)
    for made in work.glob(f"wade-many-{ensemble}-*"):
        if is_left_over(made.name):
            remove_tree(made)
