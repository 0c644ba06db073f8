"""Who crosses, over the plane of depth H and velocity v_F: the paper's argument is about their product.

Runs N x N depths (0.25 to 1.5 m) and velocities (0.5 to 5 m/s), one water at a time with a crowd for
each tau and seed in it, and writes DIR/depth_sweep.csv and DIR/depth_sweep.png. Rows of the table are
not run again, so that a sweep that was cut off goes on. They are not checked: use another DIR for
another scene or other programs. Meant for the kinematic water of configs/observed.
The part `plane` of `tools/wade paper` is this sweep.
"""

import argparse
import collections
import csv
import json
import math
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
from matplotlib.ticker import PercentFormatter

from wade import UsageError, plain_file
from wade.many import seed_range
from wade.paths import CONFIGS, RUNS, module_command
from wade.reports.files import say
from wade.reports.plots import pyplot, save
from wade.reports.tables import read_csv
from wade.run.processes import end_with_parent, resolved
from wade.scenes import find_scene
from wade.sweeps.limits import given_tau, limits_of
from wade.terminal import Parser

COLUMNS = ("scene", "tau", "depth_m", "v_f_m_s", "dv_m2_s", "level", "seed", "agents", "arrived", "dead", "active",
           "last_arrival_s", "level_met", "agents_at_level_met", "commit", "until_s")
SPACING = 0.4642  # m, that of the paper; shallower water takes particles of its own depth, as it needs a layer
BOUNDS = {"low": 0.0, "moderate": 0.5, "high": 0.75, "very_high": 1.0}  # m2/s, Table 2
LINES = ((0.5, "moderate", ":"), (0.75, "high", "--"), (1.0, "very high", "-"))


class TableError(UsageError):
    """A table of another version of this program, or of runs of another length."""


def level_of(depth_speed):
    return [level for level, bound in BOUNDS.items() if depth_speed >= bound][-1]


def rounded(value):
    return float(f"{value:.3g}")


def run_water(options, depth, speed, crowds):
    """Runs one water with these crowds, a list of (tau, seed); their rows of the table."""
    folder = options.out / "depth_sweep_run"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    names = {f"tau{tau:g}-seed{seed}": (tau, seed) for tau, seed in crowds}
    listed = folder / "crowds.json"
    listed.write_text(json.dumps([{"name": name, "set": {"/crowd/tau": tau, "/seed": seed}}
                                  for name, (tau, seed) in names.items()], indent=1), encoding="utf-8")
    command = [*module_command("wade.run.pair"), options.scene, "--out", folder / "crowds", "--crowds", listed,
               "--no-trajectories", "--no-figure", "--threads", "1", "--danger-every-s", "1", "--water-every-s", "0",
               "--set", f"/channel/depth_m={depth}", "--set", f"/channel/velocity_m_s={speed}",
               "--set", f"/fluid/particle_spacing_m={min(SPACING, depth)}"]
    if options.until_s:
        command += ["--until-s", str(options.until_s)]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, preexec_fn=end_with_parent)
    if done.returncode != 0:
        raise SystemExit(f"depth-sweep: {' '.join(map(str, command))} ended with {done.returncode}:\n{done.stderr}")
    cut = {"until_s": options.until_s or ""}
    rows = [row_of(folder / "crowds" / name, depth, speed, *crowd) | cut for name, crowd in names.items()]
    shutil.rmtree(folder)
    return rows


def row_of(folder, depth, speed, tau, seed):
    outcome = plain_file.read_json(folder / "outcome.json")
    commit = plain_file.read_json(folder / "manifest.json")["git_hash"]
    met = collections.Counter(agent["danger_level"] for agent in read_csv(folder / "agents.csv"))
    level_met, count = met.most_common(1)[0]
    product = rounded(depth * speed)
    return {"scene": outcome["scene"], "tau": tau, "depth_m": depth, "v_f_m_s": speed, "dv_m2_s": product,
            "level": level_of(product), "seed": seed, "agents": outcome["agents"], "arrived": outcome["arrived"],
            "dead": outcome["dead"], "active": outcome["active"],
            "last_arrival_s": "" if outcome["last_arrival_s"] is None else outcome["last_arrival_s"],
            "level_met": level_met, "agents_at_level_met": count, "commit": commit}


def read_table(path):
    if not os.path.lexists(path):
        return []
    columns = plain_file.read_columns(path, grows=True)
    if tuple(columns or COLUMNS) != COLUMNS:
        raise TableError(f"{path}: its columns are {','.join(columns)}, expected are {','.join(COLUMNS)}; take it"
                         " away, or write to another folder")
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def rows_to_go_on_with(path, until_s):
    """Keys of the rows that are in the table. TableError if they are of runs of another length."""
    rows = read_table(path)
    lengths = {row["until_s"] for row in rows} - {str(until_s or "")}
    if lengths:
        raise TableError(f"{path}: holds runs with --until-s {lengths.pop() or 'of the scene'}; write to another folder")
    return {key_of(row) for row in rows}


def key_of(row):
    return float(row["tau"]), float(row["depth_m"]), float(row["v_f_m_s"]), int(row["seed"])


def limit_of(scene, tau):
    """Returns the largest H v_F, m2/s, that an agent in the middle of a uniform stream withstands by Eq. 9.

    v_F < v_B m_a / (tau m_c), and the water in contact weighs m_c = rho H pi r^2, so that H v_F < v_B m_a / (tau rho pi r^2).
    tau: a number, or the limits between which it is drawn. (lowest, highest) of the first group; two numbers only if tau
    or the mass is drawn.
    """
    group = scene["crowd"]["groups"][0]
    return limits_of({**scene, "crowd": {**scene["crowd"], "groups": [{**group, "tau": tau}]}}, depth=1)


def edges(values):
    """Returns the borders midway between values, on a logarithmic scale."""
    log = np.log(values)
    middle = (log[1:] + log[:-1]) / 2
    return np.exp(np.concatenate([[2 * log[0] - middle[0]], middle, [2 * log[-1] - middle[-1]]]))


def shares(rows):
    """Depths, velocities, and the share that arrives at each pair of them, over all seeds."""
    depths, speeds = (sorted({float(row[name]) for row in rows}) for name in ("depth_m", "v_f_m_s"))
    arrived, total = np.zeros((2, len(depths), len(speeds)))
    for row in rows:
        place = depths.index(float(row["depth_m"])), speeds.index(float(row["v_f_m_s"]))
        arrived[place] += int(row["arrived"])
        total[place] += int(row["agents"])
    return depths, speeds, np.divide(arrived, total, out=np.full_like(arrived, np.nan), where=total > 0)


def limit_in_words(limit):
    return " to ".join(f"{end:.2f}" for end in sorted(set(limit)))


def draw_plane(axes, rows, tau, limit):
    depths, speeds, share = shares(rows)
    x, y = edges(speeds), edges(depths)
    colours = axes.pcolormesh(x, y, share, cmap="cividis", vmin=0, vmax=1, edgecolors="white", linewidth=0.6)
    for (i, j), value in np.ndenumerate(share):
        if not np.isnan(value):
            axes.text(speeds[j], depths[i], f"{100 * value:.0f}", ha="center", va="center", fontsize=8, zorder=5,
                      color="black" if value > 0.55 else "white")
    line = np.geomspace(x[0], x[-1], 50)
    for product, level, style in LINES:
        axes.plot(line, product / line, style, color="#d55e00", linewidth=1.8,
                  label=f"$H v_F$ = {product:g} m²/s: {level} from here on")
    for end in sorted(set(limit)):
        axes.plot(line, end / line, "-.", color="#cc79a7", linewidth=2.6,
                  label="largest $H v_F$ against which Eq. 9 lets an agent stand" if end == limit[0] else None)
    axes.set(xscale="log", yscale="log", xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel="velocity $v_F$, m/s",
             ylabel="depth $H$, m")
    for axis, values in ((axes.xaxis, speeds), (axes.yaxis, depths)):
        axis.set_ticks(values, labels=[f"{value:g}" for value in values], fontsize=8)
        axis.set_ticks([], minor=True)
    axes.set_title(f"τ {tau:g}, limit of Eq. 9: {limit_in_words(limit)} m²/s", fontsize=10)
    return colours


def draw(rows, scene, output):
    taus = sorted({float(row["tau"]) for row in rows})
    columns = min(2, len(taus))
    lines = math.ceil(len(taus) / columns)
    legend = 0.75 if columns > 1 else 1.1  # inches below; its four entries stand in as many columns as the planes
    high = 0.65 + legend + 4.3 * lines
    figure, grid = pyplot.subplots(lines, columns, figsize=(1 + 5.6 * columns, high), squeeze=False,
                                layout="constrained")
    figure.get_layout_engine().set(rect=(0, legend / high, 1, 1 - legend / high))
    for axes, tau in zip(grid.flat, taus):
        colours = draw_plane(axes, [row for row in rows if float(row["tau"]) == tau], tau, limit_of(scene, tau))
    for axes in grid.flat[len(taus):]:
        axes.remove()
    seeds = sorted({int(row["seed"]) for row in rows})
    figure.suptitle(f"{rows[0]['scene']}: share that arrives, %  (seeds {', '.join(map(str, seeds))})", fontsize=12)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="lower center", ncol=columns, fontsize=9)
    figure.colorbar(colours, ax=grid, label="share that arrives, %", format=PercentFormatter(1, symbol=""))
    save(figure, output, dpi=120)


def numbers(text):
    """The taus of a list with commas."""
    values = [float(word) for word in text.split(",")]
    if not all(0 < value <= 1 for value in values):
        raise argparse.ArgumentTypeError(f"{text}, allowed is above 0 to 1 each")
    return values


def main(arguments):
    parser = Parser("depth-sweep", __doc__)
    parser.add_argument("--scene", default=CONFIGS / "observed" / "observed.json", help="[observed/observed]")
    parser.add_argument("--taus", type=numbers, default=[0.2, 0.8], metavar="T,T", help="endurances [0.2,0.8]")
    parser.add_argument("--seeds", type=seed_range, default=range(1, 2), metavar="A-B", help="seeds [1]")
    parser.add_argument("--points", type=int, default=8, metavar="N", help="depths, and velocities, 2 to 50 [8]")
    parser.add_argument("--until-s", type=float, metavar="T", help="end of each run, s [the scene's]")
    parser.add_argument("--out", type=Path, default=RUNS / "depth_sweep", metavar="DIR",
                        help="[runs/depth_sweep]")
    options = parser.parse_args(arguments)
    if not 2 <= options.points <= 50:
        parser.error(f"--points: {options.points}, allowed is 2 to 50")
    options.scene = find_scene(str(options.scene))
    scene = resolved(options.scene)
    given_tau(scene["crowd"]["groups"][0])  # people with the response `measured` would ignore the sweep's tau
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "depth_sweep.csv"
    done = rows_to_go_on_with(path, options.until_s)
    with path.open("a", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS)
        if path.stat().st_size == 0:
            table.writeheader()
        for depth in map(rounded, np.geomspace(0.25, 1.5, options.points)):
            for speed in map(rounded, np.geomspace(0.5, 5, options.points)):
                crowds = [(tau, seed) for tau in options.taus for seed in options.seeds
                          if (tau, depth, speed, seed) not in done]
                if not crowds:
                    continue
                rows = run_water(options, depth, speed, crowds)
                table.writerows(rows)
                file.flush()
                say(f"H {depth:g} m, v_F {speed:g} m/s ({rows[0]['level']}): "
                    + ", ".join(f"{row['arrived']} of {row['agents']}" for row in rows))
    draw(read_table(path), scene, options.out / "depth_sweep.png")
    say(options.out / "depth_sweep.png")
    return 0
