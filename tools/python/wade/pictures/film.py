"""Writes a run as a film (MP4), seen from above: the water, the people on their way, their paths, and how they ended.

Reads manifest.json, agents.csv, the paths and water.bin of a run folder; --water takes the water of a recording instead,
which knows it between the snapshots of water.bin, too. Needs ffmpeg.
"""

import os
import pathlib
import shutil
import subprocess

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from wade import UsageError
from wade.export.recording import AGENTS, Recording
from wade.export.sources import CODES, Thinning, of_run, scene_of
from wade.pictures import top_view
from wade.pictures.figure import add_legend, rows_of_groups
from wade.pictures.run_files import RunError, water_snapshots
from wade.pictures.texts import GREY, draw_title, plain, title_of
from wade.terminal import Parser, say_error

LONGEST_S = 30.0  # of a film whose speed was not given
WIDTHS = (320, 7680)
KINDS = {"arrived": [CODES["arrived"]], "dead": [CODES["dead"], CODES["drowned"]]}


class Snapshots:
    """The water of a run folder, of its file of snapshots: at(time) is the newest one, None before the first."""

    def __init__(self, path):
        self.grid, self.records = water_snapshots(path)

    def at(self, time_s):
        """(number, what top_view.water_cells takes)."""
        past = np.flatnonzero(self.records["time"] <= time_s + 1e-9) if self.records is not None else []
        if len(past) == 0:
            return None, None
        record = self.records[past[-1]]
        return int(past[-1]), (float(record["time"]), *self.grid, record["depth"] / 1000.0)


class Recorded:
    """The water of a recording, as depths of cells; times are asked for in their order."""

    def __init__(self, path, scene):
        self.recording = Recording(path)
        if self.recording.kind == AGENTS:
            raise UsageError(f"--water: {path} holds people, not water")
        self.frames, self.now, self.next = self.recording.frames(), None, None
        self.next = next(self.frames, None)
        self.channel, self.cell = scene["channel"], max(0.5, scene["fluid"]["particle_spacing_m"])
        self.density = scene["fluid"]["rest_density_kg_m3"]

    def at(self, time_s):
        while self.next and self.next.time_s <= time_s + 1e-9:
            self.now, self.next = self.next, next(self.frames, None)
        if self.now is None:
            return None, None
        values, sides = self.now.values(), []
        for axis in "zx":
            low, high = self.channel[f"{axis}_min_m"], self.channel[f"{axis}_max_m"]
            sides.append(low + self.cell * np.arange(int(np.ceil((high - low) / self.cell - 1e-9)) + 1))
        mass, _, _ = np.histogram2d(values["pz"], values["px"], sides, weights=values["mass"])
        depth = mass / (self.density * self.cell**2)
        return self.now.number, (self.now.time_s, sides[1][0], sides[0][0], self.cell, depth)


def between(before, after, time_s):
    """Places of people at a time between two frames, and their states, those of the frame before until the one after."""
    if after is None or time_s <= before.time_s:
        return before["id"], before.stacked("x", "z"), before["state"]
    share = min(1.0, (time_s - before.time_s) / (after.time_s - before.time_s))
    if share == 1:
        return after["id"], after.stacked("x", "z"), after["state"]
    there = np.searchsorted(after["id"], before["id"])  # nobody leaves the frames
    a, b = before.stacked("x", "z"), after.stacked("x", "z")[there]
    jumps = np.abs(b - a).max(axis=1) > 20 * (after.time_s - before.time_s)  # round a periodic world
    return before["id"], np.where(jumps[:, None], a, a + share * (b - a)), before["state"]


class Film:
    """Draws frame after frame on one canvas; what stays is drawn once, and again with each new state of the water."""

    def __init__(self, run, water, thinning, width_px):
        self.scene = scene_of(run)
        self.water = Recorded(water, self.scene) if water else Snapshots(run / "water.bin")
        self.people = of_run(run).points(thinning)
        self.before, self.after = next(self.people, None), None
        if self.before is None:
            raise UsageError(f"{run} holds no frame in this time")
        self.after = next(self.people, None)
        self.paths = []  # (ids, places) of the frames that have passed
        self.drawn, self.shown, self.background = object(), 0, None
        rows = rows_of_groups(self.scene, of_film=True)
        self.by_group = rows > 0
        below = 0.9 + 0.21 * rows if rows else 0.92
        self.figure, self.axes = top_view.new_map(self.scene, right=0.85, above=0.85, below=below)
        wide, high = self.figure.get_size_inches()
        dpi = width_px / wide
        even = 2 * round(high * dpi / 2)  # as H.264 asks for
        self.figure.set_dpi(dpi)
        self.figure.set_size_inches(width_px / dpi, even / dpi)
        self.size = width_px, even
        top_view.draw_obstacles(self.axes, self.scene)
        top_view.draw_goals(self.axes, self.scene, self.by_group)
        draw_title(self.figure, title_of(self.scene, [], {}, []), plain(self.scene["name"]))
        self.clock = self.figure.text(0.985, 1 - 0.25 / high, "", ha="right", va="center", fontsize=11, color=GREY)
        self.marks = {outcome: self.axes.plot([], [], linestyle="none", zorder=10, clip_on=False, **style)[0]
                      for outcome, style in top_view.OUTCOMES.items()}
        for artist in (self.clock, *self.marks.values()):
            artist.set_animated(True)
        self.mesh = self.bar = None
        add_legend(self.figure, dict.fromkeys(top_view.OUTCOMES, [None]), self.scene, of_film=True)

    def new_water(self, cells):
        if self.mesh:
            self.mesh.remove()
        self.mesh = top_view.draw_water(self.axes, top_view.water_cells(cells, self.scene), self.scene) if cells else None
        if self.mesh and not self.bar:
            self.bar = top_view.draw_depth_bar(self.figure, self.axes, self.mesh) or True

    def advance(self, time_s):
        """Passes over the frames up to a time."""
        while self.after is not None and self.after.time_s <= time_s + 1e-9:
            self.paths.append((self.before["id"], self.before.stacked("x", "z")))
            self.before, self.after = self.after, next(self.people, None)

    def draw_ways(self, first):
        """The paths from the n-th frame that has passed on, over what is drawn."""
        frames = [*self.paths[first:], (self.before["id"], self.before.stacked("x", "z"))]
        parts, colours = [], []
        for (ids, a), (later, b) in zip(frames, frames[1:]):
            ways = np.stack([a, b[np.searchsorted(later, ids)]], axis=1)
            moved = (np.abs(ways[:, 1] - ways[:, 0]).max(axis=1) > 0) & (np.abs(ways[:, 1] - ways[:, 0]).max(axis=1) < 10)
            parts += list(ways[moved])
            colours += top_view.path_colours(self.scene, ids[moved]) if self.by_group else [top_view.PATH] * sum(moved)
        if parts:
            lines = LineCollection(parts, colors=colours, linewidths=0.9, alpha=0.8, zorder=6)
            self.axes.add_collection(lines, autolim=False)
            self.axes.draw_artist(lines)
            lines.remove()

    def frame(self, time_s):
        """The picture at a time, bytes of RGBA; times come in their order."""
        number, cells = self.water.at(time_s)
        self.advance(time_s)
        canvas = self.figure.canvas
        if number != self.drawn or self.background is None:
            self.new_water(cells)
            canvas.draw()
            self.drawn, first = number, 0
        else:
            canvas.restore_region(self.background)
            first = self.shown
        if first < len(self.paths):
            self.draw_ways(first)
        self.shown = len(self.paths)
        self.background = canvas.copy_from_bbox(self.figure.bbox)
        self.people_at(time_s)
        for artist in (*self.marks.values(), self.clock):
            self.figure.draw_artist(artist)
        return bytes(canvas.buffer_rgba())

    def people_at(self, time_s):
        """Moves the marks and the clock; {outcome: how many}."""
        _, places, states = between(self.before, self.after, time_s)
        kinds = {outcome: np.isin(states, codes) for outcome, codes in KINDS.items()}
        kinds["active"] = ~np.logical_or(*kinds.values())
        for outcome, chosen in kinds.items():
            self.marks[outcome].set_data(*places[chosen].T)
        counts = {outcome: int(chosen.sum()) for outcome, chosen in kinds.items()}
        self.clock.set_text(f"t = {time_s:.1f} s   " + "  ".join(f"{n} {outcome}" for outcome, n in counts.items()))
        return counts


def times_of(run, thinning, speed, rate):
    """The times of the frames, s: at the speed, or at one at which the film is not too long; and that speed."""
    ends = [frame.time_s for frame in thinning.chosen(of_run(run).frames())]
    if not ends:
        raise UsageError(f"{run} holds no frame in this time")
    first, last = ends[0], ends[-1]
    speed = speed or max(1.0, (last - first) / LONGEST_S)
    return first + np.arange(int((last - first) * rate / speed + 1e-6) + 1) * speed / rate, speed


def write(film, times, rate, output):
    """Pipes the frames through ffmpeg into a file, which is there whole or not at all."""
    part = output.with_name(f".{output.stem}-{os.getpid()}{output.suffix}")
    wide, high = film.size
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{wide}x{high}", "-r",
               f"{rate:g}", "-i", "-", "-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart", part]
    try:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
            try:
                for time_s in times:
                    ffmpeg.stdin.write(film.frame(time_s))
                ffmpeg.stdin.close()
            except BrokenPipeError:
                pass  # it says itself why it has ended
            said = ffmpeg.stderr.read().decode("utf-8", "backslashreplace").strip()
        if ffmpeg.returncode != 0:
            raise RunError(f"ffmpeg ended with exit code {ffmpeg.returncode}: {said or 'it said nothing'}")
        part.replace(output)
    finally:
        part.unlink(missing_ok=True)


def main(arguments):
    """tools/wade film."""
    parser = Parser("film", __doc__)
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of crowd_client")
    parser.add_argument("--out", type=pathlib.Path, metavar="FILE", help="film to write, .mp4 [RUN_DIR/film.mp4]")
    parser.add_argument("--water", type=pathlib.Path, metavar="RECORDING", help="recording of the run's water")
    parser.add_argument("--rate-hz", type=float, default=25.0, metavar="F", help="frames a second, 1 to 120 [25]")
    parser.add_argument("--speed", type=float, metavar="X", help="simulated s a second [1, or so that it takes 30 s]")
    parser.add_argument("--width-px", type=int, default=1280, metavar="W", help="width, even, 320 to 7680 pixels [1280]")
    parser.add_argument("--from-s", type=float, default=0.0, metavar="T", help="begin, simulated s [0]")
    parser.add_argument("--until-s", type=float, default=np.inf, metavar="T", help="end, simulated s [that of the run]")
    options = parser.parse_args(arguments)
    output = options.out or options.run / "film.mp4"
    if output.suffix.lower() != ".mp4":
        parser.error(f"--out: {output}, allowed are names that end in .mp4")
    if not 1 <= options.rate_hz <= 120:
        parser.error(f"--rate-hz: {options.rate_hz:g}, allowed is 1 to 120")
    if options.speed is not None and not 0 < options.speed <= 1e6:
        parser.error(f"--speed: {options.speed:g}, allowed is above 0 to 1000000")
    if not WIDTHS[0] <= options.width_px <= WIDTHS[1] or options.width_px % 2:
        parser.error(f"--width-px: {options.width_px}, allowed are even numbers from {WIDTHS[0]} to {WIDTHS[1]}")
    if not shutil.which("ffmpeg"):
        raise UsageError("films need ffmpeg, which is not installed; Debian: apt-get install ffmpeg")
    thinning = Thinning(from_s=options.from_s, until_s=options.until_s)
    try:
        times, speed = times_of(options.run, thinning, options.speed, options.rate_hz)
        film = Film(options.run, options.water, thinning, options.width_px)
        write(film, times, options.rate_hz, output)
        plt.close(film.figure)
    except (RunError, OSError) as error:
        say_error(f"wade film: {error}")
        return 1
    print(f"{len(times)} frames, {speed:.3g} s a second: {output}")
    return 0
