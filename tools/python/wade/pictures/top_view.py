"""The layers of the top view of a run: ground, water, stream, obstacles, paths, goals."""

import math
import os

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Circle, Rectangle
from matplotlib.patheffects import withStroke

from wade import plain_file
from wade.states import CODES, IN_HOUSES, STATES, UNKNOWN

GROUND = "#f1ece1"
BED = "#ded6c6"
BANK = "#b5a98f"
WATER = LinearSegmentedColormap.from_list("water", ["#d5e8f5", "#86b8df", "#4587c6", "#123f7a"])
PATH = "#d62728"
DEAD = "#16161a"
STAR = "#ffc928"
# How people ended: each by its shape as well as its colour, with a rim that is seen on any water and danger level.
OUTCOMES = {
    "active": {"marker": "D", "markersize": 4.6, "markerfacecolor": "white", "markeredgecolor": DEAD, "markeredgewidth": 1},
    "arrived": {"marker": "^", "markersize": 7.5, "markerfacecolor": "#009e73", "markeredgecolor": "white",
                "markeredgewidth": 0.7},
    "sheltered": {"marker": "s", "markersize": 5.5, "markerfacecolor": "#009e73", "markeredgecolor": "white",
                  "markeredgewidth": 0.7},
    "dead": {"marker": "X", "markersize": 8, "markerfacecolor": DEAD, "markeredgecolor": "white", "markeredgewidth": 0.8},
}
# The codes of states (wade.states) that are drawn as each outcome: active where there is no end.
CODES_OF = {outcome: [CODES[word] for word, state in STATES.items() if word not in IN_HOUSES and outcome == (
    "active" if state.end == "none" else "dead" if state.end == "lost" else word)] for outcome in OUTCOMES}
CODES_OF["active"].append(UNKNOWN)  # of paths, before an end
# Of paths and goals where there are several groups: Tol's "muted" colours without the one that is lost on water.
GROUPS = ("#cc6677", "#332288", "#999933", "#117733", "#aa4499", "#44aa99", "#882255", "#ddcc77")
DASHES = ("solid", (0, (5, 2)), (0, (1.2, 1.2)))  # of the first eight groups, the next ones, the last ones
MOST_GROUPS = len(GROUPS) * len(DASHES)  # that can be told apart
INK = "#2a2a2e"

ROUND_STEPS = (1, 1.5, 2, 3, 5, 7.5, 10)
WET_M = 0.001  # less water than the file of snapshots resolves
MAX_PATH_POINTS = 1500  # of one agent; more would not be seen


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
        axes.annotate("fall", (0, (z0 + z1) / 2), xytext=(5, 0), textcoords="offset points", rotation=90, ha="left",
                      va="center", fontsize=8, color=INK, zorder=9,
                      path_effects=[withStroke(linewidth=2, foreground="white")])  # seen on dark colours, too


def new_map(scene, right, above, below):
    """A figure with the ground of a scene, and its axes; right, above, below: room round the map, inches."""
    length, width = scene["world"]["length_m"], scene["world"]["width_m"]
    map_wide, left = 10.0, 0.75
    map_high = float(np.clip(map_wide * width / length, 2.2, 11.0))
    wide, high = left + map_wide + right, above + map_high + below
    figure, axes = plt.subplots(figsize=(wide, high), dpi=160)
    figure.subplots_adjust(left=left / wide, right=1 - right / wide, bottom=below / high, top=1 - above / high)
    draw_ground(axes, scene)
    axes.set(xlim=(-0.01 * length, 1.01 * length), ylim=(-0.02 * width, 1.02 * width), aspect="equal")
    axes.set_xlabel("x, m", fontsize=9, color=INK)
    axes.set_ylabel("z, m", fontsize=9, color=INK)
    axes.tick_params(labelsize=8, colors=INK, length=3)
    for spine in axes.spines.values():
        spine.set_visible(False)
    return figure, axes


def depth_scale(scene):
    """Depth of the darkest water, m: the same in all pictures of a scene, a round number half as deep again as it names."""
    channel = scene["channel"]
    named = [block["depth_m"] for block in channel["water_blocks"]]
    if channel["flow"] != "closed":
        named.append(channel["depth_m"])
    return rounded_up(1.5 * max(named, default=1.0))


def rounded_up(value):
    """The least round number that is not below a value above 0."""
    power = 10.0 ** math.floor(math.log10(value) + 1e-9)
    return power * next(step for step in ROUND_STEPS if step * power >= value * (1 - 1e-9))


def edges_of(start, cell, count, end):
    """Borders of cells, the last one cut off where the channel ends."""
    return np.minimum(start + cell * np.arange(count + 1), end)


def passable(x_edges, z_edges, obstacles):
    """Returns a mask of the cells with their middle outside of all obstacles."""
    x, z = (edges[:-1] + np.diff(edges) / 2 for edges in (x_edges, z_edges))
    free = np.ones((len(z), len(x)), dtype=bool)
    for box in obstacles:
        free &= ~np.outer((z > box["z_min_m"]) & (z < box["z_max_m"]), (x > box["x_min_m"]) & (x < box["x_max_m"]))
    return free


def exchanged(depth, free, size):
    """Depth of rows of cells after neighbours have exchanged a quarter of their difference; the volume stays."""
    flow = 0.25 * np.diff(depth, axis=1) * np.minimum(size[1:], size[:-1]) * (free[:, 1:] & free[:, :-1])
    return depth + (np.pad(flow, ((0, 0), (0, 1))) - np.pad(flow, ((0, 0), (1, 0)))) / size


def water_cells(water, scene):
    """Borders of the cells along x and z, cut to the channel, and the depth in each, m, as (rows of z, columns of x).

    Where cells hold few particles that lie anyhow, single ones make the water speckled. Neighbours exchange a part of it, the
    more so the fewer particles (by spacing) a cell has.
    """
    _, x0, z0, cell, depth = water
    channel, spacing = scene["channel"], scene["fluid"]["particle_spacing_m"]
    x_edges = edges_of(x0, cell, depth.shape[1], channel["x_max_m"])
    z_edges = edges_of(z0, cell, depth.shape[0], channel["z_max_m"])
    wide, high = np.diff(x_edges), np.diff(z_edges)
    depth = depth * cell**2 / np.outer(high, wide)  # the file's depth is that over a whole cell
    free = passable(x_edges, z_edges, scene.get("obstacles", []))
    for _ in range(round(1.2 * (spacing / cell) ** 2)):
        depth = exchanged(depth, free, wide)
        depth = exchanged(depth.T, free.T, high).T
    return x_edges, z_edges, depth


def draw_water(axes, cells, scene):
    """Draws the water, cells as water_cells gives them. Returns None if all is dry."""
    x_edges, z_edges, depth = cells
    if not np.any(depth >= WET_M):
        return None
    return axes.pcolormesh(x_edges, z_edges, np.ma.masked_less(depth, WET_M), cmap=WATER, vmin=0, vmax=depth_scale(scene),
                           edgecolors="none", antialiased=False, rasterized=True, zorder=3)


def draw_depth_bar(figure, axes, mesh, label="depth of the water, m"):
    """A slim colour bar beside the map."""
    wide, high = figure.get_size_inches()
    room = axes.get_subplotspec().get_position(figure)  # in shares of the figure
    place = (room.x1 + 0.1 / wide, room.y0, 0.12 / wide, min(room.height, 4.0 / high))
    full = mesh.get_clim()[1]
    deeper = np.max(mesh.get_array()) > full
    bar = figure.colorbar(mesh, cax=figure.add_axes(place), extend="max" if deeper else "neither",
                          ticks=np.linspace(0, full, 6))
    bar.set_label(label, fontsize=8, color=INK)
    bar.ax.tick_params(labelsize=8, colors=INK, length=3)
    bar.outline.set_visible(False)


def is_wet(cells, x, z):
    """Whether there is water at a point; cells as water_cells gives them, None if nothing is known of the water."""
    if cells is None:
        return True
    x_edges, z_edges, depth = cells
    column, row = (np.searchsorted(edges, at) - 1 for edges, at in ((x_edges, x), (z_edges, z)))
    return depth[np.clip(row, 0, depth.shape[0] - 1), np.clip(column, 0, depth.shape[1] - 1)] >= WET_M


def draw_flow(axes, scene, cells):
    """Arrows that show where the stream runs, where there is water."""
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
            if not (is_wet(cells, x - half, z) and is_wet(cells, x + half, z)):
                continue
            axes.annotate("", xy=(x - half, z), xytext=(x + half, z), zorder=4,
                          arrowprops={"arrowstyle": "-|>,head_width=0.18,head_length=0.36", "color": "white",
                                      "alpha": 0.85, "linewidth": 1.3})


def rings_of(geometry):
    """Outer rings of a GeoJSON polygon."""
    polygons = geometry["coordinates"] if geometry["type"] == "MultiPolygon" else [geometry["coordinates"]]
    return [np.array([point[:2] for point in polygon[0]]) for polygon in polygons]


def paths_of(geometry):
    """Points of a GeoJSON line."""
    lines = geometry["coordinates"] if geometry["type"] == "MultiLineString" else [geometry["coordinates"]]
    return [np.array([point[:2] for point in line]) for line in lines]


def shapes_of(scene, kind, key, word, parts_of):
    """Shapes of a list of a scene's site, in its metres, of the key and of files; files that are gone are left out."""
    site, shapes = scene.get("site", {}), []
    origin = [site.get("origin_easting_m", 0), site.get("origin_northing_m", 0)]
    for one in site.get(kind, []):
        if one.get(key):
            shapes.append(np.array(one[key]))
        if not one.get("file") or not os.path.exists(one["file"]):
            continue
        document = plain_file.read_json(one["file"])
        try:
            for feature in document.get("features", [document]):
                geometry = feature.get("geometry", feature) or {}
                if geometry.get("type") in (word, f"Multi{word}"):
                    shapes += [part - origin for part in parts_of(geometry)]
        except (AttributeError, TypeError, ValueError) as error:
            raise plain_file.FileError(one["file"], f"it is no GeoJSON of {key}s") from error
    return shapes


def polygons_of(scene, kind):
    """Ground plans of the `houses` or `shelters` of a scene."""
    return shapes_of(scene, kind, "polygon", "Polygon", rings_of)


def draw_obstacles(axes, scene):
    for box in scene.get("obstacles", []):
        axes.add_patch(Rectangle((box["x_min_m"], box["z_min_m"]), box["x_max_m"] - box["x_min_m"],
                                 box["z_max_m"] - box["z_min_m"], facecolor="#8d8d93", edgecolor=INK, linewidth=0.9,
                                 hatch="////", zorder=5))
    axes.add_collection(PolyCollection(polygons_of(scene, "houses"), facecolors="#8d8d93", edgecolors=INK, linewidths=0.5, zorder=5))
    axes.add_collection(LineCollection(shapes_of(scene, "walls", "line", "LineString", paths_of), colors=INK, linewidths=1.5, zorder=5))


def goals_of(scene):
    """Returns the goals of groups; groups that walk to shelters have none."""
    return {(g["goal"]["x_m"], g["goal"]["z_m"]) for g in scene["crowd"]["groups"] if g["goal"].get("to") != "shelters"}


def far_goals(scene):
    """Goals that lie laps away in a periodic world, and so are a direction to walk in."""
    return sorted(goal for goal in goals_of(scene) if period_of(scene) and not 0 <= goal[0] <= period_of(scene))


def group_colours(scene):
    """A colour for each group, in their order; None if there is one group, or more than can be told apart."""
    count = len(scene["crowd"]["groups"])
    return [GROUPS[i % len(GROUPS)] for i in range(count)] if 1 < count <= MOST_GROUPS else None


def dash_of_group(group):
    """The dashes of the paths of a group, by its number."""
    return DASHES[group // len(GROUPS)]


def groups_of(scene, agents):
    """Numbers of the groups of these agents (ids). Ids run through the groups in their order."""
    ends = np.cumsum([group["count"] for group in scene["crowd"]["groups"]])
    return np.searchsorted(ends, list(agents), side="right")


def path_colours(scene, agents):
    """Colours of the paths of these agents (ids)."""
    colours = group_colours(scene)
    return [PATH] * len(agents) if colours is None else [colours[group] for group in groups_of(scene, agents)]


def path_dashes(scene, agents):
    """Dashes of the paths of these agents (ids)."""
    return ["solid"] * len(agents) if group_colours(scene) is None else [dash_of_group(g) for g in groups_of(scene, agents)]


def goal_colour(scene, goal):
    """The colour of the group that walks there; that of all goals if there is no such, or several do."""
    colours = group_colours(scene) or []
    of = {colour for colour, g in zip(colours, scene["crowd"]["groups"]) if (g["goal"]["x_m"], g["goal"]["z_m"]) == goal}
    return of.pop() if len(of) == 1 else STAR


def draw_goals(axes, scene, by_group=True):
    """Draws goals below the people that may stand on them, in the colours of the groups, or all alike."""
    crowd, length = scene["crowd"], scene["world"]["length_m"]
    style = {"markeredgecolor": INK, "markeredgewidth": 0.8, "zorder": 8, "clip_on": False}
    for x, z in far_goals(scene):
        axes.plot(length if x > length else 0, z, marker=">" if x > length else "<", markersize=13,
                  markerfacecolor=goal_colour(scene, (x, z)) if by_group else STAR, **style)
    axes.add_collection(PolyCollection(polygons_of(scene, "shelters"), facecolors=STAR, edgecolors=INK, linewidths=0.8,
                                       alpha=0.7, zorder=4))
    for goal in sorted(goals_of(scene) - set(far_goals(scene))):
        # Cut off at the edge of the world: no person walks beyond it, and the picture has its title there.
        reach = axes.add_patch(Circle(goal, crowd["goal_radius_m"], fill=False, edgecolor="#9a7400", linewidth=0.9,
                                      linestyle=(0, (3, 2)), zorder=7))
        reach.set_clip_path(Rectangle((0, 0), length, scene["world"]["width_m"], transform=axes.transData))
        axes.plot(*goal, marker="*", markersize=19, markerfacecolor=goal_colour(scene, goal) if by_group else STAR,
                  **style)


def people_at(agents, paths, end_time, whole_run):
    """End points by outcome, and each path with its end point joined on; walls hide people indoors."""
    ends = {outcome: [] for outcome in OUTCOMES}
    lines = {agent: points[:, 1:] for agent, points in paths.items()}
    for row in agents:
        agent, outcome = int(row["id"]), row["outcome"]
        if outcome in IN_HOUSES:
            continue
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


def draw_paths(axes, lines, scene):
    """The paths, those of groups with a light rim, so that dark ones are seen on deep water."""
    styles = zip(lines.values(), path_colours(scene, list(lines)), path_dashes(scene, list(lines)))
    parts = [(thinned(part), colour, dash) for points, colour, dash in styles
             for part in laps_apart(points, period_of(scene))]
    ways = [part for part, _, _ in parts]
    if group_colours(scene):
        axes.add_collection(LineCollection(ways, colors="white", linewidths=2.2, alpha=0.6, zorder=6, capstyle="round"))
    axes.add_collection(LineCollection(ways, colors=[colour for _, colour, _ in parts], linewidths=1, alpha=0.85, zorder=6,
                                       linestyles=[dash for _, _, dash in parts], capstyle="butt", joinstyle="round"))


def draw_ends(axes, ends):
    """A mark where each person is in the end, by outcome."""
    for outcome, style in OUTCOMES.items():
        if len(ends.get(outcome, ())):
            axes.plot(*np.array(ends[outcome]).T, linestyle="none", zorder=10, clip_on=False, **style)


def draw_people(axes, ends, lines, scene):
    draw_paths(axes, lines, scene)
    if lines:
        starts = np.array([points[0] for points in lines.values()])
        axes.scatter(*starts.T, s=9, facecolors="white", edgecolors=path_colours(scene, list(lines)), linewidths=0.7, zorder=7,
                     clip_on=False)
    draw_ends(axes, ends)
