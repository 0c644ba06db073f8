"""What is exported: the water of a recording and the people of a run folder, one frame at a time."""

import itertools
import os

import numpy as np

from wade import UsageError, plain_file
from wade.export.recording import AGENTS, Recording
from wade.run.outcome import MOST_PEOPLE, path_rate, read_agents
from wade.scenes import resolved_scene
from wade.states import CODES, UNKNOWN
from wade.terminal import say_error

ROW = ("id", "x", "z", "heading", "state", "y", "lean_x", "lean_z")  # of a person in a frame
CHUNK = 1 << 18  # rows of a Spool that are in memory at once
BLOCK = 16  # frames of paths that are asked for at once


class Points:
    """A frame of particles or people: number, time_s, and arrays of float32 or int32, of one length, by name.

    Always x, y, z (m) and vx, vy, vz (m/s); particles have mass (kg), people id, state (UNKNOWN where no file holds it), height (m), heading (rad, from x
    towards z) and lean_x, lean_z (rad, out of the vertical); y of a person is its feet, or where they would be.
    """

    def __init__(self, number, time_s, arrays):
        self.number, self.time_s, self.arrays = number, time_s, arrays

    def __len__(self):
        return len(self.arrays["x"])

    def __getitem__(self, name):
        return self.arrays[name]

    def stacked(self, *names):
        return np.stack([self.arrays[name] for name in names], axis=1).astype("f4")

    def only(self, kept):
        return Points(self.number, self.time_s, {name: array[kept] for name, array in self.arrays.items()})

    def z_up(self):
        """The same with y across and z up, which makes left-handed axes right-handed; a heading then is from x towards y."""
        swap = {"y": "z", "z": "y", "vy": "vz", "vz": "vy", "lean_z": "lean_y"}
        return Points(self.number, self.time_s, {swap.get(name, name): array for name, array in self.arrays.items()})


class Thinning:
    """Selects the frames and the region that are exported."""

    def __init__(self, every=1, interval_s=0.0, from_s=0.0, until_s=np.inf, region=None):
        self.every, self.interval_s, self.from_s, self.until_s, self.region = every, interval_s, from_s, until_s, region

    def chosen(self, frames):
        """Of frames with a time_s, those in the interval of time, each n-th, or each first at or after n intervals."""
        due, seen = self.from_s, 0
        for frame in frames:
            if frame.time_s > self.until_s + 1e-9:
                return
            if frame.time_s < self.from_s - 1e-9:
                continue
            seen += 1
            if self.interval_s and frame.time_s < due - 1e-9:
                continue
            if self.interval_s:
                due += self.interval_s * (1 + (frame.time_s - due + 1e-9) // self.interval_s)
            elif (seen - 1) % self.every:
                continue
            yield frame

    def cut(self, points):
        """What lies in the region."""
        if self.region is None:
            return points
        x0, x1, z0, z1 = self.region
        x, z = points["x"], points["z"]
        return points.only((x >= x0) & (x <= x1) & (z >= z0) & (z <= z1))


class Stream:
    """Points frame by frame. name: "water" or "people"; radius: of a particle, m, for programs that draw it.

    producer: the name of the program that made a recording. surface: makes a mesh of the points of water, see meshes.SurfaceOf.
    """

    def __init__(self, name, rate_hz, frames, radius=0.25, producer=""):
        self.name, self.rate_hz, self.frames, self.radius = name, rate_hz, frames, radius
        self.producer, self.surface = producer, None
        self.end_s = np.inf  # the time of the last frame, as far as it is known

    def points(self, thinning):
        for frame in thinning.chosen(self.frames()):
            yield thinning.cut(frame.points())


class _Frame:
    """A frame that reads its points only on demand."""

    def __init__(self, time_s, points):
        self.time_s, self.points = time_s, points


def particles_of(frame):
    """Points of a frame of a recording; people of an agents stream have the number of their index."""
    values = frame.values()
    arrays = {name: values[field] for name, field in
              (("x", "px"), ("y", "py"), ("z", "pz"), ("vx", "vx"), ("vy", "vy"), ("vz", "vz"), ("mass", "mass"))}
    if "state" in values:
        still = np.zeros(len(values["mass"]), "f4")
        ended = values["state"] > 0  # an agents stream tells outcomes, and 0 of all agents without one
        arrays |= {"id": np.arange(len(still), dtype="i4"), "state": np.where(ended, values["state"], UNKNOWN).astype("i4"),
                   "height": values["height"], "heading": np.arctan2(values["vz"], values["vx"]), "lean_x": still,
                   "lean_z": still}
        del arrays["mass"]
    return Points(frame.number, frame.time_s, arrays)


def scene_of(folder):
    """The scene of a run folder with every default."""
    try:
        return resolved_scene(plain_file.read_json(folder / "manifest.json"))
    except plain_file.FileError as error:
        raise UsageError(f"{folder} is no run folder: cannot read manifest.json: {error.strerror}") from error


def of_recording(path):
    """The stream of a recording. A file that was cut off is read to its last whole frame, which is said once."""
    recording, told = Recording(path), []

    def frames():
        empty = True
        for frame in recording.frames():
            empty = False
            yield _Frame(frame.time_s, lambda frame=frame: particles_of(frame))
        if recording.rest and not told:
            told.append(True)
            say_error(f"wade export: {path} was cut off; {recording.rest} bytes after its last whole frame are left out")
        if empty:
            raise UsageError(f"{path} holds no whole frame")

    name = "people" if recording.kind == AGENTS else "water"
    made = Stream(name, recording.rate_hz, frames, recording.radius or 0.25, recording.producer)
    made.end_s = recording.likely_end_s()
    return made


class People:
    """The people of a run folder: from poses.csv where there is one, else from trajectories.sqlite.

    People with an end stay in all later frames, at their last position, with their outcome as the state; "present" marks
    rows of this frame. Without poses.csv the state is UNKNOWN until the time of agents.csv. heights, ends: of agents.csv,
    by id; without a row there a person is 1.7 m tall.
    """

    def __init__(self, folder):
        self.folder, self.scene = folder, scene_of(folder)
        self.poses, self.paths = folder / "poses.csv", folder / "trajectories.sqlite"
        rows = read_agents(folder / "agents.csv")
        room = 1 + max((int(row["id"]) for row in rows), default=-1)
        self.heights, self.ends = np.full(room, 1.7), np.full(room, np.inf)
        self.outcomes = np.zeros(room, "i4")
        for row in rows:
            who = int(row["id"])
            self.heights[who] = float(row["height_m"])
            self.ends[who] = float(row["time_s"])
            self.outcomes[who] = CODES[row["state"] if row["outcome"] == "active" else row["outcome"]]
        world = self.scene["world"]
        self.period = world["length_m"] if world["ends"] == "periodic" else 0
        if os.path.lexists(self.poses):
            self.rate_hz = float(self.scene["crowd"]["poses"]["rate_hz"])
        elif os.path.lexists(self.paths):
            with plain_file.database(self.paths) as database:
                self.rate_hz = path_rate(database, self.paths)
        else:
            raise UsageError(f"{folder} holds no paths, neither trajectories.sqlite nor poses.csv")

    def query(self, sql):
        with plain_file.database(self.paths) as database:
            return database.execute(sql).fetchall()

    def rows(self):
        """(frame, rows) of all frames; the columns of rows are ROW."""
        return self.rows_of_poses() if os.path.lexists(self.poses) else self.rows_of_paths()

    def rows_of_paths(self):
        last = self.query("SELECT max(frame) FROM trajectory_data")[0][0]
        for first in range(0, (last or 0) + 1, BLOCK):
            found = self.query("SELECT frame, id, pos_x, pos_y, ori_x, ori_y FROM trajectory_data WHERE frame "
                               f"BETWEEN {first} AND {first + BLOCK - 1} ORDER BY frame, id")
            try:
                rows = np.array(found, float).reshape(-1, 6)
            except ValueError as error:
                raise plain_file.FileError(self.paths, f"it holds no numbers: {error}") from error
            if len(rows) and not 0 <= rows[:, 1].min() <= rows[:, 1].max() < MOST_PEOPLE:
                raise plain_file.FileError(self.paths, "a person's number is out of range")
            for part in np.split(rows, np.flatnonzero(np.diff(rows[:, 0])) + 1):
                if len(part):
                    heading = np.arctan2(part[:, 5], part[:, 4])
                    rest = np.zeros((len(part), 3))
                    yield int(part[0, 0]), np.column_stack([part[:, 1:4], heading, np.full(len(part), UNKNOWN), rest])

    def rows_of_poses(self):
        for frame, group in itertools.groupby(plain_file.table_rows(self.poses), lambda row: row["frame"]):
            try:
                number, rows = int(frame), np.array([self.row_of_pose(row) for row in group])
            except ValueError as error:
                raise plain_file.FileError(self.poses, f"frame {frame[:20]}: {error}") from error
            if not 0 <= rows[:, 0].min() <= rows[:, 0].max() < MOST_PEOPLE:
                raise plain_file.FileError(self.poses, f"frame {number}: a person's number is out of range")
            yield number, rows

    def row_of_pose(self, row):
        who, lean_x, lean_z = int(row["id"]), float(row["lean_x_rad"]), float(row["lean_z_rad"])
        # The hips are 0.53 of the height above the feet (docs/file_formats.md), the feet where a leg as leaning ends.
        leg = 0.53 * (self.heights[who] if who < len(self.heights) else 1.7)
        feet = float(row["hip_height_m"]) - leg * np.cos(min(np.pi / 2, np.hypot(lean_x, lean_z)))
        return (who, float(row["x_m"]), float(row["z_m"]), float(row["heading_rad"]), CODES.get(row["state"], UNKNOWN), feet,
                lean_x, lean_z)

    def frames(self):
        last, times = np.empty((0, len(ROW))), np.empty(0)
        for number, rows in self.rows():
            time_s = number / self.rate_hz
            ids = rows[:, 0].astype(int)
            room = max(len(last), ids.max() + 1)
            if room > len(last):  # nan: has not been seen yet
                last = np.concatenate([last, np.full((room - len(last), len(ROW)), np.nan)])
                times = np.concatenate([times, np.full(room - len(times), np.nan)])
            speeds = self.speeds(rows, last[ids], time_s - times[ids])
            last[ids], times[ids] = rows, time_s
            # What is asked for is asked for before the next frame is read.
            yield _Frame(time_s, lambda n=number, t=time_s, i=ids, v=speeds: self.points(n, t, i, v, last))

    def speeds(self, rows, before, passed):
        """Returns velocities since the row before, m/s; 0 for people without such a row."""
        way = rows[:, 1:3] - before[:, 1:3]
        if self.period:  # a step longer than half the world has crossed the periodic boundary
            way[:, 0] -= self.period * np.round(way[:, 0] / self.period)
        return np.nan_to_num(way / passed[:, None])

    def points(self, number, time_s, ids, speeds, last):
        seen = np.flatnonzero(np.isfinite(last[:, 0]))
        rows, count = last[seen], len(seen)
        arrays = dict(zip(ROW[1:], rows.T[1:].astype("f4")))
        arrays["id"], arrays["state"] = seen.astype("i4"), arrays["state"].astype("i4")
        arrays["height"] = np.full(count, 1.7, "f4")
        arrays["present"] = np.isin(seen, ids).astype("i4")
        arrays["vx"], arrays["vz"], arrays["vy"] = np.zeros((3, count), "f4")
        place = np.searchsorted(seen, ids)
        arrays["vx"][place], arrays["vz"][place] = speeds.T
        known = seen < len(self.heights)
        arrays["height"][known] = self.heights[seen[known]]
        over = known.copy()
        over[known] = self.ends[seen[known]] <= time_s + 1e-6
        arrays["state"][over] = self.outcomes[seen[over]]
        return Points(number, time_s, arrays)


def of_run(folder, says=False):
    """The stream of people of a run folder. says: tells on stderr where states are unknown."""
    people = People(folder)
    if says and not os.path.lexists(people.poses):
        say_error(f"wade export: {folder} has no poses.csv: states are unknown (empty, or -1) before the end of a person or of "
                  "the run; allowed: runs with /crowd/poses/rate_hz")
    made = Stream("people", people.rate_hz, people.frames)
    if os.path.lexists(folder / "outcome.json"):  # of a run that was killed early there is none
        made.end_s = float(plain_file.read_json(folder / "outcome.json")["sim_time_s"])
    return made


class Spool:
    """Rows of people, written as they come and sorted by person at the end, within files."""

    def __init__(self, file, width):
        self.file, self.kind = file, np.dtype([("who", "<i4"), ("time", "<f4"), ("values", "<f4", (width,))])
        self.out, self.counts = open(file, "w+b"), np.zeros(0, dtype=int)

    def add(self, ids, times, values):
        rows = np.empty(len(ids), self.kind)
        rows["who"], rows["time"], rows["values"] = ids, times, values
        self.out.write(rows.tobytes())
        counts = np.bincount(ids, minlength=len(self.counts))
        counts[: len(self.counts)] += self.counts
        self.counts = counts

    def by_person(self):
        """(times, values, first row of each person) as arrays that lie in files."""
        total = int(self.counts.sum())
        starts = np.concatenate([[0], np.cumsum(self.counts)])
        times = np.memmap(f"{self.file}.times", "<f4", "w+", shape=(max(1, total),))
        values = np.memmap(f"{self.file}.values", "<f4", "w+", shape=(max(1, total), self.kind["values"].shape[0]))
        cursor = starts[:-1].copy()
        self.out.seek(0)
        while len(data := self.out.read(CHUNK * self.kind.itemsize)):
            rows = np.frombuffer(data, self.kind)
            rows = rows[np.argsort(rows["who"], kind="stable")]
            who, first, count = np.unique(rows["who"], return_index=True, return_counts=True)
            place = np.arange(len(rows)) - np.repeat(first, count) + np.repeat(cursor[who], count)
            times[place], values[place] = rows["time"], rows["values"]
            cursor[who] += count
        self.out.close()
        return times, values, starts
