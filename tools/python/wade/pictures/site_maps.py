"""Draws the maps of a site that a run leaves in RUN_DIR/maps: each GeoTIFF as a picture with a scale, an arrow to the
north, the houses, and the people's paths.

The maps: largest depth, speed and depth times speed, time of arrival of the water, and three scales of danger: Viseu
(2006), the classes H1 to H6 of Australian Rainfall and Runoff, and the hazard rating of Defra.
"""

import math
import os
import pathlib

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from wade import plain_file
from wade.pictures import run_files, top_view
from wade.pictures.figure import write
from wade.pictures.texts import draw_legend, draw_title, plain
from wade.scenes import resolved_scene
from wade.terminal import Parser

ROUND = (1, 2, 5)
DANGER = ("#ffffcc", "#fed976", "#fd8d3c", "#b10026")
# (title, unit, legend of classes or None): what a map shows. Classes: (lower bound, colour, words), the lowest first.
MAPS = {
    "max_depth_m": ("largest depth", "m", None),
    "max_speed_m_s": ("largest speed", "m/s", None),
    "max_dv_m2_s": ("largest depth times speed", "m²/s", None),
    "arrival_s": ("arrival of the water", "s", None),
    "viseu": ("danger after Viseu (2006), by depth times speed", "", (
        (1, DANGER[0], "low, < 0.5 m²/s"), (2, DANGER[1], "moderate, < 0.75 m²/s"), (3, DANGER[2], "high, < 1 m²/s"),
        (4, DANGER[3], "very high, ≥ 1 m²/s"))),
    "arr_h": ("hazard class of Australian Rainfall and Runoff, unsafe for", "", (
        (1, "#d9f0d3", "H1 nobody"), (2, "#fff7bc", "H2 small vehicles"), (3, "#fec44f", "H3 children, vehicles"),
        (4, "#fe9929", "H4 all people"), (5, "#d95f0e", "H5 weak buildings"), (6, "#7f2704", "H6 all buildings"))),
    "defra": ("hazard rating of Defra in towns", "", (
        (0.001, DANGER[0], "low, < 0.75"), (0.75, DANGER[1], "danger for some, < 1.25"),
        (1.25, DANGER[2], "for most, < 2"), (2, DANGER[3], "for all, ≥ 2"))),
}


def round_length(longest):
    """The largest of 1, 2, 5, 10, 20, ... up to a length, m."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in ROUND if step * power <= longest * (1 + 1e-9))


def draw_scale(axes, length, width):
    """A bar of a round length and an arrow to the north, on the lower edge of the map."""
    bar = round_length(0.25 * length)
    x, z, high = 0.03 * length, 0.03 * width, 0.012 * max(length, width)
    rim = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "boxstyle": "round,pad=0.25"}
    axes.plot([x, x + bar], [z, z], color=top_view.INK, linewidth=3, solid_capstyle="butt", zorder=12)
    axes.text(x + bar / 2, z + high, f"{bar:g} m", ha="center", va="bottom", fontsize=8, zorder=12, bbox=rim)
    tip = (0.955 * length, 0.03 * width + 0.09 * max(length, width))
    axes.annotate("N", xy=tip, xytext=(tip[0], 0.03 * width), ha="center", va="bottom", fontsize=10, zorder=12, bbox=rim,
                  arrowprops={"arrowstyle": "-|>", "color": top_view.INK, "linewidth": 1.6})


def draw_classes(axes, extent, values, classes):
    """A map of classes; returns the patches of its legend, with the share of the wet cells in each."""
    bounds = [bound for bound, _, _ in classes]
    wet = np.ma.masked_where(~(values >= bounds[0]), values)
    axes.imshow(wet, cmap=ListedColormap([colour for _, colour, _ in classes]), norm=BoundaryNorm([*bounds, 1e9], len(classes)),
                extent=extent, origin="lower", interpolation="nearest", zorder=3)
    total, handles = max(1, wet.count()), []
    for k, (bound, colour, words) in enumerate(classes):
        upper = bounds[k + 1] if k + 1 < len(bounds) else math.inf
        share = np.count_nonzero((wet >= bound) & (wet < upper)) / total
        handles.append(Patch(facecolor=colour, edgecolor="#8d8d93", linewidth=0.6, label=f"{words} ({100 * share:.0f} %)"))
    return handles


def draw_values(figure, axes, extent, name, values, unit):
    """A map of values with its bar of colours."""
    there = np.isfinite(values) if name == "arrival_s" else values > 0
    if not there.any():
        return
    top = float(np.percentile(values[there], 99.5))
    cmap = "viridis_r" if name == "arrival_s" else top_view.WATER
    mesh = axes.imshow(np.ma.masked_where(~there, values), cmap=cmap, vmin=0, vmax=top or 1, extent=extent, origin="lower",
                       interpolation="nearest", zorder=3)
    wide, high = figure.get_size_inches()
    axes.apply_aspect()
    room = axes.get_position()
    bar = figure.colorbar(mesh, extend="max", cax=figure.add_axes(
        (room.x1 + 0.1 / wide, room.y0, 0.12 / wide, min(room.height, 4.0 / high))))
    bar.set_label(unit, fontsize=8, color=top_view.INK)
    bar.ax.tick_params(labelsize=8, colors=top_view.INK, length=3)
    bar.outline.set_visible(False)


def draw(run, name, output):
    path = run / "maps" / f"{name}.tif"
    values, dx, dz = run_files.read_map(path)
    scene = resolved_scene(plain_file.read_json(run / "manifest.json"))
    length, width = values.shape[1] * dx, values.shape[0] * dz
    title, unit, classes = MAPS[name]
    figure, axes = top_view.new_map(scene, right=0.85, above=0.75, below=0.75 if classes else 0.6)
    extent = (0, length, 0, width)
    axes.imshow(np.ma.masked_where(~np.isnan(values) | (name == "arrival_s"), np.ones_like(values)), extent=extent,
                origin="lower", cmap=ListedColormap(["#c9c9cc"]), interpolation="nearest", zorder=2)
    handles = draw_classes(axes, extent, values, classes) if classes else []
    if not classes:
        draw_values(figure, axes, extent, name, values, unit)
    top_view.draw_obstacles(axes, scene)
    paths = run_files.read_paths(run / "trajectories.sqlite") if os.path.lexists(run / "trajectories.sqlite") else {}
    ways = [top_view.thinned(points[:, 1:3]) for points in paths.values()]
    fine = 1 if len(ways) <= 100 else 0.4  # the water must be seen below the paths of many
    for colour, line_width in (("white", 1.5), ("#3a3a40", 0.7)):
        axes.add_collection(LineCollection(ways, colors=colour, linewidths=fine * line_width, zorder=6))
    top_view.draw_goals(axes, scene)
    draw_scale(axes, length, width)
    epsg = scene.get("site", {}).get("epsg")
    draw_title(figure, f"{plain(scene['name'])}: {title}", "cells of {:.4g} m{}".format(dx, f", EPSG:{epsg}" if epsg else ""))
    draw_legend(figure, handles, 0.08)
    run_files.save_picture(figure, output)
    plt.close(figure)


def main(arguments):
    """tools/wade maps."""
    parser = Parser("maps", __doc__)
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of a scene with a site")
    parser.add_argument("--map", choices=MAPS, metavar="NAME", help=f"only this one: {', '.join(MAPS)} [all]")
    parser.add_argument("--out", type=pathlib.Path, metavar="DIR", help="folder of the pictures [RUN_DIR/maps]")
    options = parser.parse_args(arguments)
    folder = options.out or options.run / "maps"
    folder.mkdir(parents=True, exist_ok=True)
    code = 0
    for name in [options.map] if options.map else MAPS:
        code = code or write(parser, folder / f"{name}.png", lambda output, name=name: draw(options.run, name, output))
    return code
