"""Reads what a run folder of crowd_client holds, and puts pictures there."""

import os
import struct

import numpy as np
from PIL import Image

from wade import UsageError, plain_file
from wade.reports.files import whole_file
from wade.run.outcome import path_rate

MOST_CELLS = 16_000_000  # of a snapshot of water.bin
MOST_CELLS_OF_MAP = 100_000_000
BLOCK = 4096  # times of snapshots that are read at once
ENDINGS = (".png", ".pdf", ".eps", ".ps")  # of pictures that can be written


class RunError(Exception):
    """The run folder does not hold what the picture needs."""


def read_paths(path, until_s=np.inf):
    """Paths by agent, arrays of (time, x, z), up to a time, s."""
    with plain_file.database(path) as database:
        rate = path_rate(database, path)
        found = database.execute("SELECT id, frame, pos_x, pos_y FROM trajectory_data WHERE frame <= ? ORDER BY id, frame",
                                 (min(until_s * rate + 1e-6, 2**53),)).fetchall()
    try:
        rows = np.array(found, dtype=float)
    except ValueError as error:
        raise plain_file.FileError(path, f"it holds no numbers: {error}") from error
    if rows.size == 0:
        return {}
    rows[:, 1] /= rate
    starts = np.flatnonzero(np.diff(rows[:, 0], prepend=rows[0, 0] - 1))
    return {int(part[0, 0]): part[:, 1:] for part in np.split(rows, starts[1:])}


def water_snapshots(path):
    """All snapshots: ((x edges' start, z start, cell size), records with frame, time and depth in mm, in a file), or Nones."""
    if not os.path.lexists(path):
        return None, None
    with plain_file.open_plain(path) as file:
        head, size = file.read(64), os.fstat(file.fileno()).st_size
        if len(head) < 64 or head[:8] != b"WADEWAT1":
            raise plain_file.FileError(path, "it is not a file of water snapshots")
        columns, rows, cell, x0, z0, _ = struct.unpack_from("<IIdddd", head, 8)
        if not (0 < columns * rows <= MOST_CELLS and cell > 0 and np.isfinite([cell, x0, z0]).all()):
            raise plain_file.FileError(path, f"it has snapshots of {columns} x {rows} cells; allowed: 1 to {MOST_CELLS:,} cells")
        record = np.dtype([("frame", "<u8"), ("time", "<f8"), ("depth", "<u2", (rows, columns))])
        count = (size - 64) // record.itemsize  # a record cut off by a crash does not count
        if count == 0:
            return None, None
        records = np.memmap(file, record, "r", offset=64, shape=(count,))
    before = -np.inf
    for first in range(0, count, BLOCK):
        times = np.concatenate([[before], records["time"][first : first + BLOCK]])
        if not (np.diff(times) > 0).all() or times[-1] == np.inf:
            raise plain_file.FileError(path, f"the times of its snapshots do not increase from number {first} on")
        before = times[-1]
    return (x0, z0, cell), records


def read_water(path, time):
    """The snapshot nearest to a time: (time, x edges' start, z start, cell size, depth array in m), or None."""
    grid, records = water_snapshots(path)
    if records is None:
        return None
    nearest = records[int(np.argmin(np.abs(records["time"] - time)))]
    return float(nearest["time"]), *grid, nearest["depth"] / 1000.0


def read_map(path):
    """Values of a map that the run has written, the southern row first, and the size of a cell along x and z, m."""
    Image.MAX_IMAGE_PIXELS = None
    with plain_file.open_plain(path, plain_file.TABLE_MIB) as file:
        try:
            with Image.open(file) as image:
                if image.width * image.height > MOST_CELLS_OF_MAP:
                    raise plain_file.FileError(path, f"it claims {image.width} x {image.height} cells; allowed: {MOST_CELLS_OF_MAP:,}")
                scale = image.tag_v2[33550]
                return np.asarray(image, dtype=float)[::-1], scale[0], scale[1]
        except plain_file.FileError:
            raise
        except (OSError, KeyError, AttributeError, SyntaxError, ValueError, TypeError) as error:
            raise plain_file.FileError(path, f"it is no map of a run: {error}") from error


def save_picture(figure, output):
    """Writes a picture whole or not at all, without date or version: the same run gives the same bytes."""
    with whole_file(output) as part:
        # A fifth larger than with zlib's default level, in a third of its time.
        options = {"pil_kwargs": {"compress_level": 1}} if output.suffix.lower() == ".png" else {}
        figure.savefig(part, metadata={"Software": None}, **options)


def check_time(run, time_s, option="--time"):
    """Refuses a time after the end of a run; of a run that was killed the end is not known."""
    outcome = plain_file.read_json(run / "outcome.json")
    if time_s > outcome["sim_time_s"] + 1e-9 and outcome["status"] != "running":
        raise UsageError(f"{option}: {time_s:g} s is after the end of the run; allowed: 0 to {outcome['sim_time_s']:g} s")
