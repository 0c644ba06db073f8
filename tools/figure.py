#!/usr/bin/python3
"""Draws the top view of a run: the river, the water, the paths of the people, their goals and how it ended.

    tools/figure.py RUN_DIR [--time S] [--output PNG]

Reads manifest.json, outcome.json, agents.csv, trajectories.sqlite and water.bin of a run folder. Without --time the
whole run is drawn, with the water of its last snapshot; with it, everything as it was at that time.
"""

import argparse
import csv
import json
import pathlib
import re
import sqlite3
import struct
import sys

import numpy as np
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.patches import Circle, Patch, Rectangle  # noqa: E402

GROUND = "#f1ece1"
BED = "#ded6c6"
BANK = "#b5a98f"
WATER = np.array([0x1F, 0x77, 0xC4]) / 255
PATH = "#d62728"
PERSON = "#7f0d12"
ARRIVED = "#2b8a3e"
DEAD = "#16161a"
STAR = "#ffc928"
INK = "#2a2a2e"

MAX_SQUARES = 120_000  # above this a picture of squares is slower to draw than it is better to look at
MAX_PATH_POINTS = 1500  # of one agent; more would not be seen


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


def read_paths(path, until_frame):
    """Paths by agent, arrays of (frame, x, z), up to a frame."""
    if not path.exists():
        raise RunError(f"'{path}' does not exist")
    try:
        with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as database:
            rows = np.array(
                database.execute(
                    "SELECT id, frame, pos_x, pos_y FROM trajectory_data WHERE frame <= ? ORDER BY id, frame",
                    (until_frame,),
                ).fetchall(),
                dtype=float,
            )
    except sqlite3.Error as error:
        raise RunError(f"cannot read '{path}': {error}") from error
    if rows.size == 0:
        return {}
    starts = np.flatnonzero(np.diff(rows[:, 0], prepend=rows[0, 0] - 1))
    return {int(part[0, 0]): part[:, 1:] for part in np.split(rows, starts[1:])}


def read_water(path, time):
    """The snapshot nearest to a time: (time, x edges' start, z start, cell size, depth array in m), or None."""
    if not path.exists():
        return None
    data = path.read_bytes()
    if len(data) < 64 or data[:8] != b"WADEWAT1":
        raise RunError(f"'{path}' is not a file of water snapshots")
    columns, rows, cell, x0, z0, _ = struct.unpack_from("<IIdddd", data, 8)
    record = np.dtype([("frame", "<u8"), ("time", "<f8"), ("depth", "<u2", (rows, columns))])
    count = (len(data) - 64) // record.itemsize  # a record cut off by a crash does not count
    if count == 0:
        return None
    records = np.frombuffer(data, dtype=record, count=count, offset=64)
    nearest = records[int(np.argmin(np.abs(records["time"] - time)))]
    return float(nearest["time"]), x0, z0, cell, nearest["depth"] / 1000.0


def thinned(points):
    step = max(1, len(points) // MAX_PATH_POINTS)
    kept = points[::step]
    return kept if len(points) == 0 or np.array_equal(kept[-1], points[-1]) else np.vstack([kept, points[-1]])


def period_of(scene):
    """Length after which the world repeats along x, m; 0 if it has ends."""
    return scene["world"]["length_m"] if scene["world"]["ends"] == "periodic" else 0


def laps_apart(points, period):
    """The parts of a path (rows of x, z) between the ends of a periodic world, each drawn up to the end that it crosses."""
    if not period or len(points) < 2:
        return [points]
    # A step is far shorter than half the world: a longer one has gone round.
    crossings = np.flatnonzero(np.abs(np.diff(points[:, 0])) > period / 2) + 1
    parts = [part.copy() for part in np.split(points, crossings)]
    for before, after in enumerate(range(1, len(parts))):
        (x0, z0), (x1, z1) = parts[before][-1], parts[after][0]
        leaves, enters = (period, 0.0) if x0 > x1 else (0.0, period)
        way = period - abs(x0 - x1)
        z = z0 + (abs(leaves - x0) / way if way > 0 else 0) * (z1 - z0)
        parts[before] = np.vstack([parts[before], [leaves, z]])
        parts[after] = np.vstack([[enters, z], parts[after]])
    return parts


def speeds_of(scene):
    """Lowest and highest v_F of the run, m/s."""
    channel = scene["channel"]
    speeds = [point["velocity_m_s"] for point in channel["velocity_history"]] or [channel["velocity_m_s"]]
    return min(speeds), max(speeds)


def draw_ground(axes, scene):
    world, channel = scene["world"], scene["channel"]
    length, width = world["length_m"], world["width_m"]
    axes.add_patch(Rectangle((0, 0), length, width, facecolor=GROUND, edgecolor="none", zorder=0))
    x0, x1 = channel["x_min_m"], channel["x_max_m"]
    z0, z1 = channel["z_min_m"], channel["z_max_m"]
    if channel["flow"] != "closed" or channel["water_blocks"]:
        axes.add_patch(Rectangle((x0, z0), x1 - x0, z1 - z0, facecolor=BED, edgecolor="none", zorder=1))
        for z in (z0, z1):
            axes.plot([x0, x1], [z, z], color=BANK, linewidth=1.1, zorder=2)
    axes.add_patch(Rectangle((0, 0), length, width, fill=False, edgecolor=INK, linewidth=0.9, zorder=9))
    if channel["flow"] != "closed" and not period_of(scene):
        axes.plot([0, 0], [z0, z1], color=DEAD, linewidth=3.2, solid_capstyle="butt", zorder=9)
        axes.annotate(
            "fall", (0, (z0 + z1) / 2), xytext=(5, 0), textcoords="offset points",
            rotation=90, ha="left", va="center", fontsize=8, color=INK, zorder=9,
        )


def draw_water(axes, water):
    _, x0, z0, cell, depth = water
    full = max(float(np.percentile(depth[depth > 0], 98)), 1e-3) if np.any(depth > 0) else 1.0
    opacity = np.where(depth > 0, 0.16 + 0.46 * np.minimum(depth / full, 1.0), 0.0)
    z_index, x_index = np.nonzero(depth > 0)
    if len(x_index) > MAX_SQUARES:
        colours = np.empty(depth.shape + (4,))
        colours[..., :3] = WATER
        colours[..., 3] = opacity
        rows, columns = depth.shape
        extent = (x0, x0 + columns * cell, z0, z0 + rows * cell)
        axes.imshow(colours, origin="lower", extent=extent, interpolation="nearest", zorder=3, aspect="equal")
        return
    margin = 0.06 * cell
    corner = np.stack([x0 + x_index * cell + margin, z0 + z_index * cell + margin], axis=1)
    side = cell - 2 * margin
    squares = corner[:, None, :] + side * np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    colours = np.column_stack([np.tile(WATER, (len(x_index), 1)), opacity[z_index, x_index]])
    axes.add_collection(
        PolyCollection(squares, facecolors=colours, edgecolors="none", antialiased=False, rasterized=True, zorder=3)
    )


def draw_flow(axes, scene):
    """Arrows that show where the stream runs."""
    channel = scene["channel"]
    if channel["flow"] == "closed" or speeds_of(scene)[1] == 0:
        return
    length = channel["x_max_m"] - channel["x_min_m"]
    width = channel["z_max_m"] - channel["z_min_m"]
    for x_share in (0.12, 0.37, 0.62, 0.87):
        for z_share in (0.2, 0.5, 0.8):
            x = channel["x_min_m"] + x_share * length
            z = channel["z_min_m"] + z_share * width
            half = 0.018 * length
            axes.annotate(
                "", xy=(x - half, z), xytext=(x + half, z), zorder=4,
                arrowprops={"arrowstyle": "-|>,head_width=0.18,head_length=0.36", "color": "white", "alpha": 0.85,
                            "linewidth": 1.3},
            )


def draw_obstacles(axes, scene):
    for box in scene.get("obstacles", []):
        axes.add_patch(
            Rectangle(
                (box["x_min_m"], box["z_min_m"]), box["x_max_m"] - box["x_min_m"], box["z_max_m"] - box["z_min_m"],
                facecolor="#8d8d93", edgecolor=INK, linewidth=0.9, hatch="////", zorder=5,
            )
        )


def far_goals(scene):
    """Goals that lie laps away in a periodic world, and so are a direction to walk in."""
    goals = {(g["goal"]["x_m"], g["goal"]["z_m"]) for g in scene["crowd"]["groups"]}
    return sorted(goal for goal in goals if period_of(scene) and not 0 <= goal[0] <= period_of(scene))


def draw_goals(axes, scene):
    crowd, length = scene["crowd"], scene["world"]["length_m"]
    for x, z in far_goals(scene):
        axes.plot(
            length if x > length else 0, z, marker=">" if x > length else "<", markersize=13, markerfacecolor=STAR,
            markeredgecolor=INK, markeredgewidth=0.8, zorder=12, clip_on=False,
        )
    for goal in sorted({(g["goal"]["x_m"], g["goal"]["z_m"]) for g in crowd["groups"]} - set(far_goals(scene))):
        reach = axes.add_patch(
            Circle(goal, crowd["goal_radius_m"], fill=False, edgecolor="#9a7400", linewidth=0.9, linestyle=(0, (3, 2)),
                   zorder=7)
        )
        reach.set_clip_path(Rectangle((0, 0), length, scene["world"]["width_m"], transform=axes.transData))
        axes.plot(
            *goal, marker="*", markersize=19, markerfacecolor=STAR, markeredgecolor=INK, markeredgewidth=0.8, zorder=12,
            clip_on=False,
        )


def people_at(agents, paths, end_time, whole_run):
    """End points by outcome, and each path with its end point joined on."""
    ends = {"arrived": [], "dead": [], "active": []}
    lines = {agent: points[:, 1:] for agent, points in paths.items()}
    for row in agents:
        agent, outcome = int(row["id"]), row["outcome"]
        point = np.array([float(row["x_m"]), float(row["z_m"])])
        if outcome != "active" and (whole_run or float(row["time_s"]) <= end_time + 1e-9):
            ends[outcome].append(point)
            if agent in lines:
                lines[agent] = np.vstack([lines[agent], point])
        elif agent in lines:
            ends["active"].append(lines[agent][-1])
    if not agents:
        ends["active"] = [points[-1] for points in lines.values()]
    return ends, lines


def draw_people(axes, ends, lines, period):
    parts = [part for points in lines.values() for part in laps_apart(points, period)]
    axes.add_collection(
        LineCollection([thinned(part) for part in parts], colors=PATH, linewidths=0.9, alpha=0.78, zorder=6,
                       capstyle="round", joinstyle="round")
    )
    if lines:
        starts = np.array([points[0] for points in lines.values()])
        axes.scatter(*starts.T, s=9, facecolors="white", edgecolors=PATH, linewidths=0.7, zorder=7, clip_on=False)
    styles = {
        "active": {"s": 17, "c": PERSON, "edgecolors": "white", "linewidths": 0.5},
        "arrived": {"s": 20, "c": ARRIVED, "edgecolors": "white", "linewidths": 0.5},
        "dead": {"s": 30, "c": DEAD, "marker": "x", "linewidths": 1.5},
    }
    for outcome, style in styles.items():
        if ends[outcome]:
            axes.scatter(*np.array(ends[outcome]).T, zorder=10, clip_on=False, **style)


def short_name(name):
    match = re.search(r"(?:^|[_-])s0*(\d+)$", name)
    return f"S{match.group(1)}" if match else name


def tau_text(scene):
    taus = sorted({g["tau"] for g in scene["crowd"]["groups"]})
    text = "/".join(f"{tau:g}" for tau in taus)
    for event in scene.get("events", []):
        text += f"\u2192{event['tau']:g}"
    return text


def title_of(scene, agents, ends, arrivals):
    parts = []
    if agents:
        parts.append(f"\u03c4 {tau_text(scene)}")
    if scene["channel"]["flow"] != "closed":
        low, high = speeds_of(scene)
        parts.append(f"$v_F$ {low:g} m/s" if low == high else f"$v_F$ {low:g} to {high:g} m/s")
    title = f"{short_name(scene['name'])}: " + ", ".join(parts) if parts else short_name(scene["name"])
    if not agents:
        return title
    result = [f"{len(ends['arrived'])} of {len(agents)} arrived"]
    if arrivals:
        result.append(f"last after {max(arrivals):.0f} s")
    if ends["dead"]:
        result.append(f"{len(ends['dead'])} dead")
    return f"{title} \u2013 " + ", ".join(result)


def subtitle_of(outcome, time, water, whole_run):
    parts = [outcome["scene"], f"seed {outcome['seed']}"]
    if outcome["fluid"]["model"]:
        parts.append(f"water: {outcome['fluid']['model']}")
    parts.append(f"contact rule {outcome['contact_rule']}")
    parts.append(f"0 to {time:.1f} s" if whole_run else f"t = {time:.1f} s")
    if water:
        parts.append(f"water at {water[0]:.1f} s")
    if outcome["status"] not in ("completed", "running"):
        parts.append(outcome["status"].replace("_", " "))
    return "  \u00b7  ".join(parts)


def add_legend(figure, ends, scene, water):
    handles = []
    if water and np.any(water[4] > 0):
        handles.append(Patch(facecolor=(*WATER, 0.6), label="water"))
    if scene["crowd"]["groups"]:
        handles.append(Line2D([], [], color=PATH, linewidth=1.4, label="path"))
        handles.append(Line2D([], [], color=PATH, marker="o", markerfacecolor="white", markersize=4, linestyle="none",
                              label="start"))
    marks = {
        "active": {"marker": "o", "color": PERSON, "markersize": 5},
        "arrived": {"marker": "o", "color": ARRIVED, "markersize": 5},
        "dead": {"marker": "x", "color": DEAD, "markersize": 6, "markeredgewidth": 1.5},
    }
    for outcome, style in marks.items():
        if ends[outcome]:
            handles.append(Line2D([], [], linestyle="none", label=f"{outcome} ({len(ends[outcome])})", **style))
    far = len(far_goals(scene))
    if far:
        handles.append(Line2D([], [], linestyle="none", marker=">", markersize=9, markerfacecolor=STAR,
                              markeredgecolor=INK, markeredgewidth=0.6, label="goal, laps away"))
    if len({(g["goal"]["x_m"], g["goal"]["z_m"]) for g in scene["crowd"]["groups"]}) > far:
        handles.append(Line2D([], [], linestyle="none", marker="*", markersize=11, markerfacecolor=STAR,
                              markeredgecolor=INK, markeredgewidth=0.6, label="goal"))
    if scene.get("obstacles"):
        handles.append(Patch(facecolor="#8d8d93", edgecolor=INK, hatch="////", label="obstacle"))
    if handles:
        figure.legend(handles=handles, loc="lower center", ncol=len(handles), frameon=False, fontsize=8.5,
                      handletextpad=0.5, columnspacing=1.6)


def draw(run, time, output):
    manifest = read_json(run / "manifest.json")
    outcome = read_json(run / "outcome.json")
    scene = manifest["resolved_scene"]
    whole_run = time is None
    rate = outcome["step_rate_hz"]  # a frame of the paths is a step of the crowd
    # A run that was killed still says frame 0 in its outcome; its paths tell how far it came.
    until_frame = 2**53 if whole_run else int(round(time * rate))
    paths = read_paths(run / "trajectories.sqlite", until_frame)
    last_frame = max([points[-1, 0] for points in paths.values()], default=0)
    end_time = max(outcome["sim_time_s"], last_frame / rate) if whole_run else time
    agents = read_agents(run / "agents.csv")
    water = read_water(run / "water.bin", end_time)
    ends, lines = people_at(agents, paths, end_time, whole_run)
    arrivals = [float(a["time_s"]) for a in agents
                if a["outcome"] == "arrived" and (whole_run or float(a["time_s"]) <= end_time + 1e-9)]

    world = scene["world"]
    length, width = world["length_m"], world["width_m"]
    # Inches: the map, and round it room for title, labels and legend.
    map_wide, left, right, above, below = 10.0, 0.75, 0.25, 0.85, 0.92
    map_high = float(np.clip(map_wide * width / length, 2.2, 11.0))
    wide, high = left + map_wide + right, above + map_high + below
    figure, axes = plt.subplots(figsize=(wide, high), dpi=160)
    figure.subplots_adjust(left=left / wide, right=1 - right / wide, bottom=below / high, top=1 - above / high)
    figure.patch.set_facecolor("white")
    draw_ground(axes, scene)
    if water:
        draw_water(axes, water)
    draw_flow(axes, scene)
    draw_obstacles(axes, scene)
    draw_people(axes, ends, lines, period_of(scene))
    draw_goals(axes, scene)

    axes.set_xlim(-0.01 * length, 1.01 * length)
    axes.set_ylim(-0.02 * width, 1.02 * width)
    axes.set_aspect("equal")
    axes.set_xlabel("x, m", fontsize=9, color=INK)
    axes.set_ylabel("z, m", fontsize=9, color=INK)
    axes.tick_params(labelsize=8, colors=INK, length=3)
    for spine in axes.spines.values():
        spine.set_visible(False)
    people = agents if agents else list(lines)
    figure.text(0.5, 1 - 0.25 / high, title_of(scene, people, ends, arrivals), ha="center", va="center",
                fontsize=14, color=INK)
    figure.text(0.5, 1 - 0.53 / high, subtitle_of(outcome, end_time, water, whole_run), ha="center",
                va="center", fontsize=8, color="#6b6b72")
    add_legend(figure, ends, scene, water)
    # No date or version in the file, so that the same run gives the same bytes.
    figure.savefig(output, metadata={"Software": None})
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of crowd_client")
    parser.add_argument("--time", type=float, metavar="S", help="simulated time to draw, s [the whole run]")
    parser.add_argument("--output", type=pathlib.Path, metavar="PNG", help="picture to write [RUN_DIR/figure.png]")
    options = parser.parse_args()
    if options.time is not None and not options.time >= 0:
        parser.error(f"--time: {options.time} s, allowed is 0 or more")
    output = options.output or options.run / "figure.png"
    try:
        draw(options.run, options.time, output)
    except (RunError, OSError) as error:
        print(f"figure.py: {error}", file=sys.stderr)
        return 1
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
