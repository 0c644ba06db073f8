"""Reads what a run folder of crowd_client holds, and puts pictures there."""

import csv
import json
import os
import sqlite3
import struct

import numpy as np

from wade import UsageError
from wade.reports.files import whole_file

ENDINGS = (".png", ".pdf", ".eps", ".ps")  # of pictures that can be written


class RunError(Exception):
    """The run folder does not hold what the picture needs."""


def read_json(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RunError(f"cannot read '{path}': {error.strerror}") from error
    except ValueError as error:
        raise RunError(f"'{path}' is not valid JSON: {error}") from error


def read_agents(path):
    """Rows of agents.csv; none if the run ended before it was written."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def read_paths(path, until_s=np.inf):
    """Paths by agent, arrays of (time, x, z), up to a time, s."""
    if not path.exists():
        raise RunError(f"'{path}' does not exist")
    try:
        with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as database:
            rate = float(database.execute("SELECT value FROM metadata WHERE key = 'fps'").fetchone()[0])
            rows = np.array(
                database.execute(
                    "SELECT id, frame, pos_x, pos_y FROM trajectory_data WHERE frame <= ? ORDER BY id, frame",
                    (min(until_s * rate + 1e-6, 2**53),),
                ).fetchall(),
                dtype=float,
            )
    except sqlite3.Error as error:
        raise RunError(f"cannot read '{path}': {error}") from error
    if rows.size == 0:
        return {}
    rows[:, 1] /= rate
    starts = np.flatnonzero(np.diff(rows[:, 0], prepend=rows[0, 0] - 1))
    return {int(part[0, 0]): part[:, 1:] for part in np.split(rows, starts[1:])}


def water_snapshots(path):
    """All snapshots: ((x edges' start, z start, cell size), records with frame, time and depth in mm, in a file), or Nones."""
    if not path.exists():
        return None, None
    with path.open("rb") as file:
        head, size = file.read(64), file.seek(0, os.SEEK_END)
    if len(head) < 64 or head[:8] != b"WADEWAT1":
        raise RunError(f"'{path}' is not a file of water snapshots")
    columns, rows, cell, x0, z0, _ = struct.unpack_from("<IIdddd", head, 8)
    record = np.dtype([("frame", "<u8"), ("time", "<f8"), ("depth", "<u2", (rows, columns))])
    count = (size - 64) // record.itemsize  # a record cut off by a crash does not count
    if count == 0:
        return None, None
    return (x0, z0, cell), np.memmap(path, record, "r", offset=64, shape=(count,))


def read_water(path, time):
    """The snapshot nearest to a time: (time, x edges' start, z start, cell size, depth array in m), or None."""
    grid, records = water_snapshots(path)
    if records is None:
        return None
    nearest = records[int(np.argmin(np.abs(records["time"] - time)))]
    return float(nearest["time"]), *grid, nearest["depth"] / 1000.0


def save_picture(figure, output):
    """Writes a picture whole or not at all, without date or version: the same run gives the same bytes."""
    with whole_file(output) as part:
        # A fifth larger than with zlib's default level, in a third of its time.
        options = {"pil_kwargs": {"compress_level": 1}} if output.suffix.lower() == ".png" else {}
        figure.savefig(part, metadata={"Software": None}, **options)


def check_time(run, time_s, option="--time"):
    """Refuses a time after the end of a run; of a run that was killed the end is not known."""
    outcome = read_json(run / "outcome.json")
    if time_s > outcome["sim_time_s"] + 1e-9 and outcome["status"] != "running":
        raise UsageError(f"{option}: {time_s:g} s is after the end of the run; allowed: 0 to {outcome['sim_time_s']:g} s")
