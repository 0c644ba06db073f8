#!/usr/bin/python3
"""Draws the top view of a run: the river, the water, the paths of the people, their goals and how it ended.

    tools/figure.py RUN_DIR [--time S] [--output PNG]

Reads manifest.json, outcome.json, agents.csv, trajectories.sqlite and water.bin of a run folder. Without --time the
whole run is drawn, with the water of its last snapshot; with it, everything as it was at that time.
"""

import argparse
import pathlib
import re
import sys

import numpy as np

import top_view  # first, as it picks matplotlib's backend
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from run_files import ENDINGS, RunError, read_agents, read_json, read_paths, read_water, save_picture
from top_view import ARRIVED, DEAD, INK, PATH, PERSON, STAR, far_goals, speeds_of

def short_name(name):
    match = re.search(r"(?:^|[_-])s0*(\d+)$", name)
    return f"S{match.group(1)}" if match else name


def range_of(value):
    """(lowest, highest) of a value that all agents of a group share, or of a range from which each draws its own."""
    return (value["min"], value["max"]) if isinstance(value, dict) else (value, value)


def tau_text(scene):
    taus = sorted({range_of(g["tau"]) for g in scene["crowd"]["groups"]})
    text = "/".join(f"{low:g}" if low == high else f"{low:g}\u2013{high:g}" for low, high in taus)
    for event in scene.get("events", []):
        text += f"\u2192{event['tau']:g}"
    return text


def title_of(scene, agents, ends, arrivals, cut_off=""):
    """cut_off: "so far" if the run was, and its results are those of a moment before, "unknown" if it left none."""
    parts = []
    if agents:
        parts.append(f"\u03c4 {tau_text(scene)}")
    if scene["channel"]["flow"] != "closed":
        low, high = speeds_of(scene)
        parts.append(f"$v_F$ {low:g} m/s" if low == high else f"$v_F$ {low:g} to {high:g} m/s")
    title = f"{short_name(scene['name'])}: " + ", ".join(parts) if parts else short_name(scene["name"])
    if not agents:
        return title
    if cut_off == "unknown":
        return f"{title} \u2013 cut off, no outcome"
    result = [f"{len(ends['arrived'])} of {len(agents)} arrived"]
    if arrivals:
        result.append(f"last after {max(arrivals):.0f} s")
    if ends["dead"]:
        result.append(f"{len(ends['dead'])} dead")
    if cut_off:
        result.append("then cut off")
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


def add_legend(figure, ends, scene, cut_off=""):
    """What the marks mean; above it, where colours tell the groups apart, the groups."""
    handles = []
    colours = top_view.group_colours(scene)
    common = INK if colours else PATH  # of what stands for the paths of all groups
    if scene["crowd"]["groups"]:
        handles.append(Line2D([], [], color=common, linewidth=1.4, label="path"))
        handles.append(Line2D([], [], color=common, marker="o", markerfacecolor="white", markersize=4, linestyle="none",
                              label="start"))
    marks = {
        "active": {"marker": "o", "color": PERSON, "markersize": 5},
        "arrived": {"marker": "o", "color": ARRIVED, "markersize": 5},
        "dead": {"marker": "x", "color": DEAD, "markersize": 6, "markeredgewidth": 1.5},
    }
    for outcome, style in marks.items():
        if ends[outcome]:
            name = "last seen" if cut_off and outcome == "active" else outcome
            handles.append(Line2D([], [], linestyle="none", label=f"{name} ({len(ends[outcome])})", **style))
    goals = {(g["goal"]["x_m"], g["goal"]["z_m"]) for g in scene["crowd"]["groups"]}
    far = set(far_goals(scene))
    for marker, size, label, of in ((">", 9, "goal, laps away", far), ("*", 11, "goal", goals - far)):
        if of:
            fill = STAR if STAR in {top_view.goal_colour(scene, goal) for goal in of} else "white"
            handles.append(Line2D([], [], linestyle="none", marker=marker, markersize=size, markerfacecolor=fill,
                                  markeredgecolor=INK, markeredgewidth=0.6, label=label))
    if scene.get("obstacles"):
        handles.append(Patch(facecolor="#8d8d93", edgecolor=INK, hatch="////", label="obstacle"))
    groups = [Line2D([], [], color=colour, linewidth=2.4, label=group["name"])
              for colour, group in zip(colours or [], scene["crowd"]["groups"])]
    for row, inches in ((handles, 0.03), (groups, 0.25)):
        if row:
            figure.legend(handles=row, loc="lower center", ncol=len(row), frameon=False, fontsize=8.5, handletextpad=0.5,
                          columnspacing=1.6, bbox_to_anchor=(0.5, inches / figure.get_figheight()))


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
    ends, lines = top_view.people_at(agents, paths, end_time, whole_run)
    arrivals = [float(a["time_s"]) for a in agents
                if a["outcome"] == "arrived" and (whole_run or float(a["time_s"]) <= end_time + 1e-9)]

    world = scene["world"]
    length, width = world["length_m"], world["width_m"]
    # Inches: the map, and round it room for title, labels and legend.
    map_wide, left, right, above, below = 10.0, 0.75, 0.85, 0.85, 1.1 if top_view.group_colours(scene) else 0.92
    map_high = float(np.clip(map_wide * width / length, 2.2, 11.0))
    wide, high = left + map_wide + right, above + map_high + below
    figure, axes = plt.subplots(figsize=(wide, high), dpi=160)
    figure.subplots_adjust(left=left / wide, right=1 - right / wide, bottom=below / high, top=1 - above / high)
    figure.patch.set_facecolor("white")
    top_view.draw_ground(axes, scene)
    cells = top_view.water_cells(water, scene) if water else None
    mesh = top_view.draw_water(axes, cells, scene) if water else None
    if mesh:
        place = ((left + map_wide + 0.1) / wide, below / high, 0.12 / wide, min(map_high, 4.0) / high)
        top_view.draw_depth_bar(figure, place, mesh)
    top_view.draw_flow(axes, scene, cells)
    top_view.draw_obstacles(axes, scene)
    top_view.draw_people(axes, ends, lines, scene)
    top_view.draw_goals(axes, scene)

    axes.set_xlim(-0.01 * length, 1.01 * length)
    axes.set_ylim(-0.02 * width, 1.02 * width)
    axes.set_aspect("equal")
    axes.set_xlabel("x, m", fontsize=9, color=INK)
    axes.set_ylabel("z, m", fontsize=9, color=INK)
    axes.tick_params(labelsize=8, colors=INK, length=3)
    for spine in axes.spines.values():
        spine.set_visible(False)
    people = agents if agents else list(lines)
    cut_off = ""
    if outcome["status"] == "running":  # a run that is killed writes no other
        cut_off = "so far" if agents else "unknown"
    figure.text(0.5, 1 - 0.25 / high, title_of(scene, people, ends, arrivals, cut_off), ha="center",
                va="center", fontsize=14, color=INK)
    figure.text(0.5, 1 - 0.53 / high, subtitle_of(outcome, end_time, water, whole_run), ha="center",
                va="center", fontsize=8, color="#6b6b72")
    add_legend(figure, ends, scene, cut_off)
    save_picture(figure, output)
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
    if output.suffix.lower() not in ENDINGS:
        parser.error(f"--output: {output}, allowed are names that end in {', '.join(ENDINGS)}")
    try:
        draw(options.run, options.time, output)
    except (RunError, OSError) as error:
        print(f"figure.py: {error}", file=sys.stderr)
        return 1
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
