"""Where to search: a map of the last places of the dead and the missing over all runs of an ensemble.

Contours hold 50 and 90 % of what is expected; squares of 10 m stand in the order of the search.
Writes victims.png, victims.csv (the squares) and victims.md. The missing are carried, hold on, recover or are
pinned when a run ends. --drift-s lets the bodies go on with the water of the end.
"""

import os
from pathlib import Path

import numpy as np

from wade import UsageError, plain_file
from wade.reports.files import say, write_whole
from wade.reports.options import above_0
from wade.reports.tables import count_of, document, markdown, section, write_csv
from wade.scenes import resolved_scene
from wade.statistics.ensemble import SWEPT_AWAY, read_ensemble
from wade.statistics.last_positions import SQUARE_M, density_of, drift, search_order, start_drift
from wade.states import MISSING
from wade.statistics.table import percent
from wade.terminal import Parser

HELD = (0.5, 0.9)
CELL_M = 2.0        # cells of the flow sampled at people
FAR_M = 5.0         # farther than this from a cell with samples the flow is not known
STEP_S = 0.5
EPILOG = "Exit code: 0, or 2 for bad usage or a folder without complete runs."


def felt_stream(case, world):
    """Returns water(x, z), the mean flow sampled at people (terms.csv), in cells of 2 m; None without such files."""
    rows = [row for run in case.runs if (run.folder / "terms.csv").exists() for row in _felt(run.folder)]
    if not rows:
        return None
    known = np.array(rows)
    shape = int(np.ceil(world["width_m"] / CELL_M)), int(np.ceil(world["length_m"] / CELL_M))
    at = tuple(np.clip((known[:, k] // CELL_M).astype(int), 0, size - 1) for k, size in ((1, shape[0]), (0, shape[1])))
    count = np.zeros(shape)
    np.add.at(count, at, 1)
    means = []
    for column in (2, 3, 4):
        total = np.zeros(shape)
        np.add.at(total, at, known[:, column])
        means.append(_filled(np.divide(total, count, out=np.zeros(shape), where=count > 0), count > 0))

    def water(x, z):
        here = (np.clip((z // CELL_M).astype(int), 0, shape[0] - 1), np.clip((x // CELL_M).astype(int), 0, shape[1] - 1))
        return tuple(mean[here] for mean in means)

    return water


def _felt(folder):
    """Yields (x, z, depth, velocity along x and z) sampled at people in the second half of a run; m, m/s."""
    from wade.pictures.run_files import read_paths

    if not os.path.lexists(folder / "trajectories.sqlite"):
        return
    paths, terms = read_paths(folder / "trajectories.sqlite"), folder / "terms.csv"
    half = max((float(row["time_s"]) for row in plain_file.table_rows(terms)), default=0) / 2
    for row in plain_file.table_rows(terms):
        time = float(row["time_s"])
        path = paths.get(int(row["id"]))
        if time >= half and row["depth_m"] and path is not None:
            place = path[np.argmin(np.abs(path[:, 0] - time))]
            yield place[1], place[2], float(row["depth_m"]), float(row["stream_x_m_s"]), float(row["stream_z_m_s"])


def _filled(values, known):
    """Cells without a value take that of the nearest one up to 5 m away, else 0."""
    values, known = values.copy(), known.copy()
    for _ in range(int(FAR_M / CELL_M)):
        sides = [(np.roll(values * known, shift, axis), np.roll(known, shift, axis)) for axis in (0, 1) for shift in (1, -1)]
        count = sum(side.astype(int) for _, side in sides)
        new = ~known & (count > 0)
        values = np.where(new, np.divide(sum(v for v, _ in sides), count, out=np.zeros_like(values), where=count > 0), values)
        known |= new
    return np.where(known, values, 0)


def straight_stream(scene):
    """water(x, z) of a straight channel that flows at v_F, towards x = 0; None of other water."""
    channel = scene.get("channel")
    if scene.get("site") or not channel or channel["flow"] == "closed" or scene.get("obstacles"):
        return None
    history = channel.get("velocity_history") or []
    speed = history[-1]["velocity_m_s"] if history else channel["velocity_m_s"]
    z0, z1 = channel["z_min_m"], channel["z_max_m"]

    def water(x, z):
        wet = (z > z0) & (z < z1)
        return np.where(wet, channel["depth_m"], 0.0), np.where(wet, -speed, 0.0), np.zeros(len(x))

    return water


def sought(case):
    """Returns x, z, run, is dead of the dead and missing people on the map, and the number of people carried off it."""
    people = case.people
    who = people["dead"] | np.isin(people["fate"].astype(str), MISSING)
    away = people["fate"].astype(str) == SWEPT_AWAY
    here = who & ~away
    return people["x_m"][here], people["z_m"][here], people["run"][here], people["dead"][here], int(away.sum())


def drifted(case, scene, x, z, duration):
    """(x, z, how many are stranded, how many left the map, what the water is from) after a drift."""
    world = scene["world"]
    water, source = felt_stream(case, world), "the stream that people felt, from terms.csv"
    if water is None:
        water, source = straight_stream(scene), "a straight stream at v_F"
    if water is None:
        raise UsageError("--drift-s: nothing is known of the water; run with --terms-every-s 1 and paths")
    inside = lambda xs, zs: (xs > 0) & (xs < world["length_m"]) & (zs > 0) & (zs < world["width_m"])  # noqa: E731
    bodies = drift(start_drift(x, z, 1.7), water, duration, STEP_S, 1, inside=inside)
    stay = ~bodies.gone
    return bodies.x[stay], bodies.z[stay], int(bodies.stranded.sum()), int(bodies.gone.sum()), source


def draw(scene, density, x, z, title, file):
    """Draws victims.png: the map with the density, its contours and the last positions."""
    import matplotlib.pyplot as plt

    from wade.pictures import top_view
    from wade.pictures.run_files import save_picture
    from wade.pictures.texts import draw_title

    figure, axes = top_view.new_map(scene, right=0.35, above=0.75, below=0.55)
    axes.pcolormesh(density.x, density.z, np.ma.masked_less(density.share, density.level(0.995)), cmap="YlOrRd", zorder=3,
                    alpha=0.8, rasterized=True)
    top_view.draw_obstacles(axes, scene)
    axes.plot(x, z, ".", color="#16161a", markersize=2.5, alpha=0.5, zorder=6)
    middle = [line[:-1] + np.diff(line) / 2 for line in (density.x, density.z)]
    levels = sorted({density.level(held) for held in HELD})
    lines = axes.contour(*middle, density.share, levels=levels, colors="#7a0019", linewidths=1.3, zorder=7)
    words = dict(zip(levels, [f"{100 * held:.0f} %" for held in sorted(HELD, reverse=True)]))
    axes.clabel(lines, fmt=words, fontsize=8)
    draw_title(figure, "Where to search", title)
    save_picture(figure, file)
    plt.close(figure)


def table_of(rows):
    """The squares that hold the first 90 %, at most 15."""
    last = next(k for k, row in enumerate(rows, 1) if row[3] >= HELD[1])
    lines = [[k, f"{x:g} to {x + SQUARE_M:g}", f"{z:g} to {z + SQUARE_M:g}", f"{percent(share)} %", f"{percent(so_far)} %",
              f"{area:,.0f}"] for k, (x, z, share, so_far, area) in enumerate(rows[: min(last, 15)], 1)]
    text = markdown(["", "x, m", "z, m", "in it", "so far", "m2 so far"], lines)
    return text + (f"\n90 % needs {last} squares; all stand in victims.csv.\n" if last > 15 else "")


def look(case, options, file):
    """Returns (section, lines of victims.csv) of a case; no lines without dead or missing people on the map."""
    scene = resolved_scene(case.manifest())
    x, z, run, dead, over = sought(case)
    lost = f" {over} were carried off the map." if over else ""
    if len(x) == 0:
        return section(case.name, f"Nobody is to be looked for on this map in {count_of(len(case.runs))}.{lost}"), []
    words = (f"{count_of(len(case.runs))}, {len(x)} people in {len(set(run.tolist()))} of them: {int(dead.sum())} dead, "
             f"{len(x) - int(dead.sum())} missing as the runs end.{lost}")
    if options.drift_s:
        x, z, stranded, gone, source = drifted(case, scene, x, z, options.drift_s)
        words += (f" After {options.drift_s:g} s of drift in {source}: {stranded} stranded, {gone} left the map.")
        if len(x) == 0:
            return section(case.name, words), []
    world = scene["world"]
    density = density_of(x, z, world["length_m"], world["width_m"])
    rows = search_order(density)
    draw(scene, density, x, z, f"{case.name}: {len(x)} people of {count_of(len(case.runs))}", file)
    areas = "; ".join(f"{100 * held:.0f} % within {density.area(held):,.0f} m2" for held in HELD)
    everything = world["length_m"] * world["width_m"]
    return section(case.name, words, f"{areas}, of {everything:,.0f} m2 of the map.", table_of(rows),
                   f"![Where to search]({file.name})"), rows


def parse(arguments):
    parser = Parser("victims", __doc__, EPILOG)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of an ensemble")
    parser.add_argument("--drift-s", type=above_0, metavar="T", help="how long bodies drift on, s [not at all]")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of what is written [DIR]")
    options = parser.parse_args(arguments)
    options.out = options.out or options.folder
    return options


def main(arguments):
    """tools/wade victims."""
    options = parse(arguments)
    ensemble = read_ensemble(options.folder)
    options.out.mkdir(parents=True, exist_ok=True)
    sections, lines = [], []
    for number, case in enumerate(ensemble.cases, 1):
        name = "victims.png" if len(ensemble.cases) == 1 else f"victims_{number}.png"
        text, rows = look(case, options, options.out / name)
        sections.append(text)
        lines += [(case.name, place, *row) for place, row in enumerate(rows, 1)]
    head = ("# Where to search\n\nKernel density of the last places, bandwidth 5 m, over all runs. x runs upstream, z across. "
            "The share counts people of all runs together; each run has a weight by how many it loses.")
    text = document(head, *sections)
    write_csv(options.out / "victims.csv", ("case", "place", "x_m", "z_m", "share", "share_so_far", "area_so_far_m2"), lines)
    write_whole(options.out / "victims.md", text)
    say(text)
    return 0
