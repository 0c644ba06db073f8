"""Draws the top view of a run: the river, the water, the paths of the people, their goals and how it ended.

Reads manifest.json, outcome.json, agents.csv, trajectories.sqlite and water.bin of a run folder. Without --time the
whole run is drawn, with the water of its last snapshot; with it, everything as it was at that time.
"""

import argparse
import contextlib
import logging
import pathlib
import select
import signal
import sys
import warnings

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from wade import plain_file
from wade.pictures import top_view
from wade.pictures.run_files import ENDINGS, RunError, check_time, read_paths, read_water, save_picture
from wade.pictures.texts import draw_legend, draw_title, group_names, subtitle_of, title_of
from wade.pictures.top_view import INK, OUTCOMES, PATH, STAR, far_goals
from wade.run.outcome import read_agents
from wade.scenes import resolved_scene
from wade.terminal import Parser, say_error


def add_legend(figure, ends, scene, cut_off="", of_film=False):
    """What the marks mean, and how many there are; above it, where colours tell the groups apart, the groups.

    of_film: without numbers and starts, and without the groups that only dashes tell apart.
    """
    handles = []
    rows = rows_of_groups(scene, of_film)
    colours = top_view.group_colours(scene) if rows else None
    common = INK if colours else PATH  # of what stands for the paths of all groups
    count = len(scene["crowd"]["groups"])
    if count:
        label = "path" if colours or count == 1 else f"path ({count} groups)"
        handles.append(Line2D([], [], color=common, linewidth=1.4, label=label))
        if not of_film:
            handles.append(Line2D([], [], color=common, marker="o", markerfacecolor="white", markersize=4, linestyle="none",
                                  label="start"))
    for outcome, style in OUTCOMES.items():
        if ends.get(outcome):
            name = "last seen" if cut_off and outcome == "active" else outcome
            label = name if of_film else f"{name} ({len(ends[outcome])})"
            handles.append(Line2D([], [], linestyle="none", label=label, **style))
    goals, far = top_view.goals_of(scene), set(far_goals(scene))
    for marker, size, label, of in ((">", 9, "goal, laps away", far), ("*", 11, "goal", goals - far)):
        if of:
            fill = STAR if not colours or STAR in {top_view.goal_colour(scene, goal) for goal in of} else "white"
            handles.append(Line2D([], [], linestyle="none", marker=marker, markersize=size, markerfacecolor=fill,
                                  markeredgecolor=INK, markeredgewidth=0.6, label=label))
    if scene.get("obstacles"):
        handles.append(Patch(facecolor="#8d8d93", edgecolor=INK, hatch="////", label="obstacle"))
    if scene.get("site", {}).get("shelters"):
        handles.append(Patch(facecolor=STAR, edgecolor=INK, alpha=0.7, label="shelter"))
    names = group_names(scene["crowd"]["groups"], rows) if colours else []
    groups = [Line2D([], [], color=colour, linewidth=2.2, linestyle=top_view.dash_of_group(i), label=name)
              for i, (colour, name) in enumerate(zip(colours or [], names))]
    draw_legend(figure, handles, 0.03)
    draw_legend(figure, groups, 0.25, rows)


def rows_of_groups(scene, of_film=False):
    """Lines of the legend of groups; none where they are not told apart."""
    rows = -(-len(top_view.group_colours(scene) or []) // len(top_view.GROUPS))
    return 0 if of_film and rows > 1 else rows


def draw(run, time, output, width_px=None):
    if time is not None:
        check_time(run, time)
    manifest = plain_file.read_json(run / "manifest.json")
    outcome = plain_file.read_json(run / "outcome.json")
    scene = resolved_scene(manifest)
    whole_run = time is None
    paths = read_paths(run / "trajectories.sqlite", np.inf if whole_run else time)
    end_time = outcome["sim_time_s"] if whole_run else time
    if whole_run and outcome["status"] == "running":  # killed; its outcome is older than its paths
        end_time = max([end_time, *(points[-1, 0] for points in paths.values())])
    agents = read_agents(run / "agents.csv")
    water = read_water(run / "water.bin", end_time)
    ends, lines = top_view.people_at(agents, paths, end_time, whole_run)
    arrivals = [float(a["time_s"]) for a in agents
                if a["outcome"] == "arrived" and (whole_run or float(a["time_s"]) <= end_time + 1e-9)]

    rows = rows_of_groups(scene)
    figure, axes = top_view.new_map(scene, right=0.85, above=0.85, below=0.9 + 0.21 * rows if rows else 0.92)
    if width_px:
        figure.set_dpi(width_px / figure.get_figwidth())
    cells = top_view.water_cells(water, scene) if water else None
    mesh = top_view.draw_water(axes, cells, scene) if water else None
    if mesh:
        top_view.draw_depth_bar(figure, axes, mesh)
    top_view.draw_flow(axes, scene, cells)
    top_view.draw_obstacles(axes, scene)
    top_view.draw_people(axes, ends, lines, scene)
    top_view.draw_goals(axes, scene)

    people = agents if agents else list(lines)
    cut_off = ""
    if outcome["status"] == "running":  # a run that is killed writes no other
        cut_off = "so far" if agents else "unknown"
    draw_title(figure, title_of(scene, people, ends, arrivals, cut_off), subtitle_of(outcome, end_time, water, whole_run))
    add_legend(figure, ends, scene, cut_off)
    save_picture(figure, output)
    plt.close(figure)


def warm_up(scene):
    """Draws what needs no results, so that fonts and texts are at hand."""
    rows = rows_of_groups(scene)
    figure, axes = top_view.new_map(scene, right=0.85, above=0.85, below=0.9 + 0.21 * rows if rows else 0.92)
    grid = np.linspace(0, 1, 2)
    top_view.draw_depth_bar(figure, axes, top_view.draw_water(axes, (grid, grid, np.ones((1, 1))), scene))
    top_view.draw_flow(axes, scene, None)
    top_view.draw_obstacles(axes, scene)
    top_view.draw_goals(axes, scene)
    draw_title(figure, title_of(scene, [], {}, []), "")
    add_legend(figure, {outcome: [None] for outcome in OUTCOMES}, scene)
    figure.canvas.draw()
    plt.close(figure)


def wait_until_told(run):
    """Returns true when a line comes on the standard input, false at its end; warms up as soon as the run has a manifest."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # that of the run, which then closes the standard input
    warm, manifest = False, run / "manifest.json"
    while not select.select([sys.stdin], [], [], None if warm else 0.1)[0]:
        if not warm and manifest.exists():
            warm = True
            with contextlib.suppress(Exception):  # what is wrong with the scene shows in the picture itself
                warm_up(plain_file.read_json(manifest)["resolved_scene"])
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return bool(sys.stdin.readline())


def main(arguments):
    """tools/wade figure."""
    parser = Parser("figure", __doc__)
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of crowd_client")
    parser.add_argument("--time", type=float, metavar="S", help="simulated time to draw, s [the whole run]")
    parser.add_argument("--output", type=pathlib.Path, metavar="PNG", help="picture to write [RUN_DIR/figure.png]")
    parser.add_argument("--width-px", type=int, metavar="W", help="width of the picture, 320 to 7680 pixels [1856]")
    # Beside a run: loads and warms up, and draws when a line comes on the standard input.
    parser.add_argument("--when-told", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.when_told and not wait_until_told(options.run):
        return 0
    if options.width_px is not None and not 320 <= options.width_px <= 7680:
        parser.error(f"--width-px: {options.width_px}, allowed is 320 to 7680")
    if options.time is not None and not options.time >= 0:
        parser.error(f"--time: {options.time} s, allowed is 0 or more")
    return write(parser, options.output or options.run / "figure.png",
                 lambda output: draw(options.run, options.time, output, options.width_px))


def write(parser, output, draw_it):
    """Draws a picture of a run and says where it is; returns the exit code."""
    if output.suffix.lower() not in ENDINGS:
        parser.error(f"--output: {output}, allowed are names that end in {', '.join(ENDINGS)}")
    warnings.filterwarnings("ignore", "Glyph")  # of names in letters that the font lacks
    logging.getLogger("matplotlib.mathtext").setLevel(logging.ERROR)
    try:
        draw_it(output)
    except (RunError, OSError) as error:
        say_error(f"{parser.prog.removeprefix('tools/')}: {error}")
        return 1
    print(output)
    return 0
