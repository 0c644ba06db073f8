"""The layers of the top view of a run: ground, water, stream, obstacles, paths, goals."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402
from matplotlib.patches import Circle, Rectangle  # noqa: E402

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
        # Cut off at the edge of the world, where nobody walks and the picture has its title.
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
