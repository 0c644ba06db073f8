"""Draws the largest danger level of each cell of the water, and over it the paths of the people and how they ended.

Needs danger.csv, which crowd_client writes with --danger-every-s 1. Levels: Table 2 of Schaffer et al. (2020), after
Viseu (2006), by depth times speed: low below 0.5 m2/s, moderate below 0.75, high below 1, very high from there on.
"""

import os
import pathlib

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from wade import plain_file
from wade.pictures import run_files, top_view
from wade.pictures.figure import write
from wade.pictures.texts import draw_legend, draw_title, subtitle_of, title_of
from wade.run.outcome import read_agents
from wade.scenes import resolved_scene
from wade.terminal import Parser

# Light to dark, so that the order is seen without colours, too; blue and black marks stand out from all of them.
LEVELS = {
    "low": ("#ffffcc", "low, < 0.5 m²/s"),
    "moderate": ("#fed976", "moderate, < 0.75 m²/s"),
    "high": ("#fd8d3c", "high, < 1 m²/s"),
    "very_high": ("#b10026", "very high, ≥ 1 m²/s"),
}
PATH = "#3a3a40"


def read_cells(path):
    if not os.path.lexists(path):
        raise run_files.RunError(f"'{path}' does not exist; run crowd_client with --danger-every-s 1")
    return plain_file.read_table(path)


def draw_levels(axes, cells):
    wet = [cell for cell in cells if cell["danger_level"] in LEVELS]
    corners = [[float(cell[f"{axis}_{end}_m"]) for axis, end in (("x", "min"), ("x", "max"), ("z", "min"), ("z", "max"))]
               for cell in wet]
    squares = [[(x0, z0), (x1, z0), (x1, z1), (x0, z1)] for x0, x1, z0, z1 in corners]
    colours = [LEVELS[cell["danger_level"]][0] for cell in wet]
    axes.add_collection(PolyCollection(squares, facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=3))
    return wet


def draw_people(axes, agents, paths, period):
    _, lines = top_view.people_at(agents, paths, np.inf, True)
    ways = [top_view.thinned(part) for points in lines.values() for part in top_view.laps_apart(points, period)]
    # With a light rim, so that they can be seen on the dark levels, too.
    for colour, line_width in (("white", 1.7), (PATH, 0.8)):
        axes.add_collection(LineCollection(ways, colors=colour, linewidths=line_width, zorder=6))
    places = {outcome: [(float(a["x_m"]), float(a["z_m"])) for a in agents if a["outcome"] == outcome]
              for outcome in top_view.OUTCOMES}
    top_view.draw_ends(axes, places)


def legend_handles(wet, cells, agents, scene):
    present = {cell["danger_level"] for cell in wet}
    share = {level: sum(cell["danger_level"] == level for cell in wet) / max(1, len(cells)) for level in LEVELS}
    levels = [Patch(facecolor=colour, edgecolor="#8d8d93", linewidth=0.6, label=f"{label} ({100 * share[level]:.0f} %)")
              for level, (colour, label) in LEVELS.items() if level in present]
    people = [Line2D([], [], color=PATH, linewidth=1.2, label="path")] if agents else []
    for outcome, style in top_view.OUTCOMES.items():
        count = sum(a["outcome"] == outcome for a in agents)
        if count:
            people.append(Line2D([], [], linestyle="none", label=f"{outcome} ({count})", **style))
    if agents:
        people.append(Line2D([], [], linestyle="none", marker="*", markersize=11, markerfacecolor=top_view.STAR,
                             markeredgecolor=top_view.INK, markeredgewidth=0.6, label="goal"))
    if scene.get("obstacles"):
        people.append(Patch(facecolor="#8d8d93", edgecolor=top_view.INK, hatch="////", label="obstacle"))
    return levels, people


def met_text(agents):
    """Returns counts of people by outcome and by the highest danger level that they met, worst first."""
    parts = []
    for outcome in top_view.OUTCOMES:
        levels = [a["danger_level"] for a in agents if a["outcome"] == outcome]
        if levels:
            counts = [f"{levels.count(level)} {level.replace('_', ' ')}"
                      for level in ("very_high", "high", "moderate", "low", "none") if level in levels]
            parts.append(f"{outcome} met at most: " + ", ".join(counts))
    return "   \u00b7   ".join(parts)


def draw(run, output):
    manifest = plain_file.read_json(run / "manifest.json")
    outcome = plain_file.read_json(run / "outcome.json")
    cells = read_cells(run / "danger.csv")
    scene = resolved_scene(manifest)
    agents = read_agents(run / "agents.csv")
    paths = run_files.read_paths(run / "trajectories.sqlite")

    figure, axes = top_view.new_map(scene, right=0.25, above=1.05, below=1.1)
    wet = draw_levels(axes, cells)
    top_view.draw_obstacles(axes, scene)
    draw_people(axes, agents, paths, top_view.period_of(scene))
    top_view.draw_goals(axes, scene, by_group=False)

    ends = {name: [a for a in agents if a["outcome"] == name] for name in top_view.OUTCOMES}
    arrivals = [float(a["time_s"]) for a in ends["arrived"]]
    subtitle = subtitle_of(outcome, outcome["sim_time_s"], None, True)
    draw_title(figure, title_of(scene, agents, ends, arrivals), f"largest danger level of each cell  \u00b7  {subtitle}",
               met_text(agents))
    levels, people = legend_handles(wet, cells, agents, scene)
    draw_legend(figure, levels, 0.3)
    draw_legend(figure, people, 0.06)
    run_files.save_picture(figure, output)
    plt.close(figure)


def main(arguments):
    """tools/wade danger-map."""
    parser = Parser("danger-map", __doc__)
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of crowd_client")
    parser.add_argument("--output", type=pathlib.Path, metavar="PNG", help="picture to write [RUN_DIR/danger.png]")
    options = parser.parse_args(arguments)
    return write(parser, options.output or options.run / "danger.png", lambda output: draw(options.run, output))
