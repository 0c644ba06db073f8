"""Writes a run as a film (.mp4, .webp or .gif), seen from above: the water, the people on their way, their paths, and how
they ended. With --camera viewer, --eye or --look it is as the page of tools/wade view shows it, which a .png holds, too.

Reads manifest.json, agents.csv, the paths and water.bin of a run folder; --water takes the water of a recording instead,
which knows it between the snapshots of water.bin, too. Needs ffmpeg; the viewer's camera chromium and npm.
"""

import json
import pathlib
import shutil
import subprocess

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from wade import UsageError, progress, view
from wade.building import bring_up_to_date
from wade.export.recording import AGENTS, Recording
from wade.export.sources import Thinning, of_run, scene_of
from wade.outside import require
from wade.pictures import top_view
from wade.pictures.figure import add_legend, rows_of_groups
from wade.pictures.render import triple
from wade.pictures.run_files import RunError, water_snapshots
from wade.pictures.texts import GREY, draw_title, plain, title_of
from wade.reports.files import whole_file, write_whole
from wade.run.outcome import read_agents
from wade.run.processes import end_with_parent
from wade.states import CODES, LOST, SAFE
from wade.terminal import Parser, say_error

LONGEST_S = 30.0  # of a film without a given speed
WIDTHS = (320, 7680)
# How ffmpeg is told to write a film, by its ending.
CODECS = {
    ".mp4": ("-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart"),
    ".webp": ("-c:v", "libwebp_anim", "-quality", "75", "-compression_level", "6", "-loop", "0"),
    ".gif": ("-vf", "split[a][b];[a]palettegen=max_colors=128[p];[b][p]paletteuse=dither=bayer", "-loop", "0"),
}


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


class NoPeople:
    """The frame before the first one, while all are indoors."""

    time_s = -np.inf

    def __getitem__(self, name):
        return np.empty(0, int)

    def stacked(self, *names):
        return np.empty((0, len(names)))


def between(before, after, time_s):
    """Returns ids, positions and states of people at a time between two frames; states change at the frame after."""
    if after is None or time_s <= before.time_s or before.time_s == -np.inf:
        return before["id"], before.stacked("x", "z"), before["state"]
    share = min(1.0, (time_s - before.time_s) / (after.time_s - before.time_s))
    if share == 1:
        return after["id"], after.stacked("x", "z"), after["state"]
    there = np.searchsorted(after["id"], before["id"])  # no person leaves the frames
    a, b = before.stacked("x", "z"), after.stacked("x", "z")[there]
    jumps = np.abs(b - a).max(axis=1) > 20 * (after.time_s - before.time_s)  # round a periodic world
    return before["id"], np.where(jumps[:, None], a, a + share * (b - a)), before["state"]


class Film:
    """Draws frame after frame on one canvas; what stays is drawn once, and again with each new state of the water."""

    def __init__(self, run, water, thinning, width_px):
        self.scene = scene_of(run)
        self.water = Recorded(water, self.scene) if water else Snapshots(run / "water.bin")
        self.people = of_run(run).points(thinning)
        rows = read_agents(run / "agents.csv")
        self.agents = len(rows) or sum(group["count"] for group in self.scene["crowd"]["groups"])
        # Ends between two frames of the paths count from their own time on.
        ended = [row["outcome"] in (*SAFE, *LOST) for row in rows]
        self.ends = np.array([float(row["time_s"]) if has_end else np.inf for row, has_end in zip(rows, ended)])
        self.outcomes = np.array([CODES[row["outcome"]] if has_end else 0 for row, has_end in zip(rows, ended)])
        self.before, self.after = NoPeople(), next(self.people, None)
        self.paths = []  # (ids, positions) of the frames that have passed
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
        self.clock = self.figure.text(0.985, 1 - 0.72 / high, "", ha="right", va="center", fontsize=11, color=GREY)
        self.marks = {outcome: self.axes.plot([], [], linestyle="none", zorder=10, clip_on=False, **style)[0]
                      for outcome, style in top_view.OUTCOMES.items()}
        for artist in (self.clock, *self.marks.values()):
            artist.set_animated(True)
        self.mesh = self.bar = None
        shown = [outcome for outcome in top_view.OUTCOMES if outcome != "sheltered" or self.scene.get("site")]
        add_legend(self.figure, dict.fromkeys(shown, [None]), self.scene, of_film=True)

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
        ids, places, states = between(self.before, self.after, time_s)
        if len(self.ends):
            states = np.where(self.ends[ids] <= time_s + 1e-6, self.outcomes[ids], states)
        counts = {}
        for outcome, codes in top_view.CODES_OF.items():
            chosen = np.isin(states, codes)
            self.marks[outcome].set_data(*places[chosen].T)
            counts[outcome] = int(chosen.sum())
        if self.scene.get("site"):  # paths begin at the doors
            counts["indoors"] = self.agents - sum(counts.values())
        else:
            del counts["sheltered"]
        self.clock.set_text(f"t = {time_s:.1f} s   " + "  ".join(f"{n} {outcome}" for outcome, n in counts.items()))
        return counts


def times_of(run, thinning, speed, rate):
    """Returns the times of the frames, s, and the speed: the given one, or one that keeps the film within LONGEST_S."""
    ends = [frame.time_s for frame in thinning.chosen(of_run(run).frames())]
    _, water = water_snapshots(run / "water.bin")
    if water is not None and len(water) > 0 and (len(ends) < 2 or ends[0] > water["time"].min()):  # all are indoors at first
        ends = sorted({*ends, *(t for t in water["time"].tolist() if thinning.from_s <= t <= thinning.until_s)})
    if not ends:
        raise UsageError(f"{run} holds no frame in this time")
    first, last = ends[0], ends[-1]
    speed = speed or max(1.0, (last - first) / LONGEST_S)
    return first + np.arange(int((last - first) * rate / speed + 1e-6) + 1) * speed / rate, speed


def write(frames, form, rate, output):
    """Pipes frames through ffmpeg, which is told their form, into a file, which is there whole or not at all."""
    with whole_file(output) as part:
        command = ["ffmpeg", "-y", "-loglevel", "error", *form, "-r", f"{rate:g}", "-i", "-", *CODECS[output.suffix.lower()], part]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
            try:
                for frame in frames:
                    ffmpeg.stdin.write(frame)
                ffmpeg.stdin.close()
            except BrokenPipeError:
                pass  # it says itself why it has ended
            said = ffmpeg.stderr.read().decode("utf-8", "backslashreplace").strip()
        if ffmpeg.returncode != 0:
            raise RunError(f"ffmpeg ended with exit code {ffmpeg.returncode}: {said or 'it said nothing'}")


def seen_pictures(address, times, size, page, panels):
    """The PNGs of the page at an address at these times, in parts of any length; page: what follows # of its address."""
    for program in ("chromium", "node"):
        require(program, "the viewer's camera needs chromium and node (tools/install_dependencies.sh viewer); without it the film "
                "is seen from above")
    job = {"url": address, "times": times, "width": size[0], "height": size[1], "hash": page, "bare": not panels, "browser": shutil.which("chromium")}
    modules = view.install_modules(with_tests=True)
    command = ["node", view.PAGE.parent / "film.mjs", modules]
    with subprocess.Popen([*map(str, command)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, preexec_fn=end_with_parent) as node:
        node.stdin.write(json.dumps(job).encode())  # not on the command line, as the address holds the key of the page
        node.stdin.close()
        while part := node.stdout.read1(1 << 20):
            yield part
    if node.returncode != 0:
        raise RunError("the page could not be drawn; the messages above say why")


def write_seen(address, times, options, output):
    """The film of the page at an address, or its first picture."""
    eye = ",".join(f"{value:g}" for value in (*options.eye, *options.look)) if options.eye else ""
    page = f"dark=0&mode={options.colour}" + (f"&eye={eye}" if eye else "")
    size = options.width_px, options.height_px or 2 * round(options.width_px * 9 / 32)
    if output.suffix.lower() == ".png":
        write_whole(output, b"".join(seen_pictures(address, times[:1], size, page, options.panels)))
    else:
        pictures = seen_pictures(address, times, size, page, options.panels)
        write(pictures, ("-f", "image2pipe", "-c:v", "png"), options.rate_hz, output)


def film_of_page(times, options, output):
    """Starts the viewer's server for the film and ends it."""
    bring_up_to_date(("wade_view_server",))
    server = view.Server("--run", options.run, *(["--recording", options.water] if options.water else []))
    try:
        if not server.address:
            raise RunError("the server of the page did not start; its message is above")
        write_seen(server.address, times, options, output)
    finally:
        server.end()


def main(arguments):
    """tools/wade film."""
    parser = Parser("film", __doc__)
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of crowd_client")
    parser.add_argument("--out", type=pathlib.Path, metavar="FILE", help="film to write: .mp4, .webp, .gif; of the viewer "
                        "also .png, the first moment [RUN_DIR/film.mp4]")
    parser.add_argument("--water", type=pathlib.Path, metavar="RECORDING", help="recording of the run's water")
    parser.add_argument("--rate-hz", type=float, default=25.0, metavar="F", help="frames a second, 1 to 120 [25]")
    parser.add_argument("--speed", type=float, metavar="X", help="simulated s a second [1, or so that it takes 30 s]")
    parser.add_argument("--width-px", type=int, default=1280, metavar="W", help="width, even, 320 to 7680 pixels [1280]")
    parser.add_argument("--from-s", type=float, default=0.0, metavar="T", help="begin, simulated s [0]")
    parser.add_argument("--until-s", type=float, default=np.inf, metavar="T", help="end, simulated s [that of the run]")
    parser.add_argument("--camera", choices=("top", "viewer"), default="top", help="as the paper's pictures, or as the page [top]")
    parser.add_argument("--eye", type=triple, metavar="X,Y,Z", help="place of the viewer's camera, m [that of the page]")
    parser.add_argument("--look", type=triple, metavar="X,Y,Z", help="place that it looks at, m; with --eye")
    parser.add_argument("--height-px", type=int, metavar="H", help="height of the viewer's pictures, even [9/16 of the width]")
    parser.add_argument("--colour", choices=("clear", "depth", "speed"), default="clear", help="of the viewer's water [clear]")
    parser.add_argument("--panels", action="store_true", help="with the panels of the page")
    options = parser.parse_args(arguments)
    output = options.out or options.run / "film.mp4"
    is_seen = options.camera == "viewer" or options.eye is not None
    endings = [*CODECS, *([".png"] if is_seen else [])]
    if output.suffix.lower() not in endings:
        parser.error(f"--out: {output}, allowed are names that end in {', '.join(endings)}")
    if (options.eye is None) != (options.look is None):
        parser.error("--eye and --look are given together")
    if options.height_px is not None and (not 64 <= options.height_px <= WIDTHS[1] or options.height_px % 2):
        parser.error(f"--height-px: {options.height_px}, allowed are even numbers from 64 to {WIDTHS[1]}")
    if not 1 <= options.rate_hz <= 120:
        parser.error(f"--rate-hz: {options.rate_hz:g}, allowed is 1 to 120")
    if options.speed is not None and not 0 < options.speed <= 1e6:
        parser.error(f"--speed: {options.speed:g}, allowed is above 0 to 1000000")
    if not WIDTHS[0] <= options.width_px <= WIDTHS[1] or options.width_px % 2:
        parser.error(f"--width-px: {options.width_px}, allowed are even numbers from {WIDTHS[0]} to {WIDTHS[1]}")
    if output.suffix.lower() != ".png":
        require("ffmpeg", "films need ffmpeg; Debian: apt-get install ffmpeg")
    thinning = Thinning(from_s=options.from_s, until_s=options.until_s)
    try:
        times, speed = times_of(options.run, thinning, options.speed, options.rate_hz)
        if is_seen:
            film_of_page([round(time_s, 6) for time_s in times.tolist()], options, output)
        else:
            film = Film(options.run, options.water, thinning, options.width_px)
            form = ("-f", "rawvideo", "-pix_fmt", "rgba", "-s", "{}x{}".format(*film.size))
            write(map(film.frame, progress.over(times, "draws the frames")), form, options.rate_hz, output)
            plt.close(film.figure)
    except (RunError, OSError) as error:
        say_error(f"wade film: {error}")
        return 1
    if output.suffix.lower() == ".png":
        print(f"{times[0]:.3g} s: {output}")
    else:
        print(f"{len(times)} frames, {speed:.3g} s a second: {output}")
    return 0
