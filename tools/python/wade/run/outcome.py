"""What a run, or many crowds in one water, came to: read from the run folder and put in words."""

import math
import os

from wade import plain_file
from wade.states import check_states

MOST_PEOPLE = 10_000_000  # of a run


def state_of(path):
    """What tells a file from a later one of that name; None if there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


class BeforeRun:
    """Records the content of the run folder when a run begins, to tell new results from older ones."""

    def __init__(self, folder, many):
        self.folder, self.many = folder, many
        self.results = folder / ("crowds.csv" if many else "outcome.json")
        self.earlier = self.files()
        self.earlier_crowds = self.crowds() if many else {}

    def files(self):
        """{name: what tells this file from a later one of that name}, of the results of one crowd and of many."""
        files = {name: state_of(self.folder / name) for name in ("outcome.json", "crowds.csv")}
        return {name: state for name, state in files.items() if state}

    def crowds(self):
        """The run folders of crowds, {name: what tells this outcome from a later one of that name}."""
        return {outcome.parent.name: state_of(outcome) for outcome in self.folder.glob("*/outcome.json")}

    def has_new_results(self):
        return state_of(self.results) not in (None, self.earlier.get(self.results.name))

    def left_from_earlier(self):
        """Returns the names of files and of crowds with results of an earlier run."""
        files, crowds = self.files(), self.crowds() if self.many else {}
        return [name for name, state in self.earlier.items() if files.get(name) == state] + sorted(
            name for name, outcome in self.earlier_crowds.items() if crowds.get(name) == outcome
        )


def in_site(outcome):
    """Returns the numbers of sheltered and indoor people as words."""
    return f", {outcome['sheltered']} sheltered, {int(outcome['indoors']) + int(outcome['upper_floor'])} indoors"


def summary(folder):
    """The outcome in words, from outcome.json; empty if there is none."""
    try:
        outcome = plain_file.read_json(folder / "outcome.json")
    except plain_file.FileError:
        return []
    last = outcome["last_arrival_s"]
    arrival = f", the last after {last:.1f} s" if last is not None else ""
    of_site = in_site(outcome) if "sheltered" in outcome else ""
    deep = outcome.get("indoors_behind_deep_water")
    if deep:
        of_site += f" ({deep} of them behind more than 0.5 m of water)"
    lines = [f"{outcome['scene']}: {outcome['status']}; {outcome['arrived']} of {outcome['agents']} arrived{arrival}{of_site}; "
             f"{outcome['dead']} dead, {outcome['active']} active"]
    wall, memory = outcome["wall_time_s"], outcome["fluid"].get("resident_bytes")
    if wall:
        simulated = outcome["sim_time_s"]
        speed = f"{simulated:.1f} s simulated in {wall:.1f} s ({simulated / wall:.2f} s per second)"
        lines.append(speed + (f", server memory {memory / 1e6:.0f} MB" if memory else ""))
    return lines


def crowds_of(folder):
    """The rows of crowds.csv; empty if there is none."""
    try:
        return plain_file.read_table(folder / "crowds.csv")
    except plain_file.FileError:
        return []


def crowds_summary(folder):
    """The outcome of many crowds in words, a line each."""
    for row in crowds_of(folder):
        last = f", the last after {float(row['last_arrival_s']):.1f} s" if row["last_arrival_s"] else ""
        of_site = in_site(row) if any(int(row.get(key) or 0) for key in ("sheltered", "indoors", "upper_floor")) else ""
        yield (f"{row['name']}: {row['status']}; {row['arrived']} of {row['agents']} arrived{last}{of_site}; "
               f"{row['dead']} dead, {row['active']} active")


def has_frames(folder):
    try:
        return plain_file.read_json(folder / "outcome.json")["frames"] > 0
    except plain_file.FileError:
        return False


def read_agents(path):
    """Returns the rows of agents.csv with checked numbers and ends; none if the run ended before it was written."""
    if not os.path.lexists(path):
        return []
    rows = plain_file.read_table(path)
    for row in rows:
        try:
            numbers = [float(row[name]) for name in ("time_s", "x_m", "z_m", "height_m") if row.get(name)]
            sound = 0 <= int(row["id"]) < MOST_PEOPLE and all(map(math.isfinite, numbers))
        except ValueError:
            sound = False
        if not sound:
            raise plain_file.FileError(path, f"the row of person {row['id'][:20]} is damaged")
    check_states(path, [row["outcome"] for row in rows], [row["state"] for row in rows if "state" in row])
    return rows


def path_rate(database, path):
    """Frames a second of the table of paths."""
    row = database.execute("SELECT value FROM metadata WHERE key = 'fps'").fetchone()
    try:
        rate = float(row[0])
    except (TypeError, ValueError):
        rate = 0
    if not 0 < rate < 1e9:
        raise plain_file.FileError(path, "it has no number of frames a second")
    return rate
