#!/usr/bin/python3
"""Who crosses, over the plane of depth H and velocity v_F: the paper's argument is about their product.

    tools/depth_sweep.py [--scene SCENE] [--tau T] [--seeds A-B] [--points N] [--out DIR]

Runs the pair for N x N depths (0.25 to 1.5 m) and velocities (0.5 to 5 m/s), one run at a time, and writes
DIR/depth_sweep.csv and DIR/depth_sweep.png. Points that are in the table already are not run again, so that a sweep
that was cut off goes on. Meant for the kinematic water of configs/observed. Build first (tools/run.sh).
"""

import argparse
import collections
import csv
import json
import math
import pathlib
import re
import subprocess
import sys

import numpy as np
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLUMNS = ("scene", "tau", "depth_m", "v_f_m_s", "dv_m2_s", "level", "seed", "agents", "arrived", "dead", "active",
           "last_arrival_s", "level_met", "agents_at_level_met")
SPACING = 0.4642  # m, that of the paper; shallower water takes particles of its own depth, as it needs a layer
BOUNDS = {"low": 0.0, "moderate": 0.5, "high": 0.75, "very_high": 1.0}  # m2/s, Table 2
LINES = ((0.5, "moderate", ":"), (0.75, "high", "--"), (1.0, "very high", "-"))


def level_of(depth_speed):
    return [level for level, bound in BOUNDS.items() if depth_speed >= bound][-1]


def rounded(value):
    return float(f"{value:.3g}")


def run_point(options, folder, depth, speed, seed):
    """Runs the pair; its row of the table."""
    command = [sys.executable, ROOT / "tools" / "run_pair.py", "--programs", options.programs, options.scene,
               "--out", folder, "--no-figure", "--threads", "1", "--seed", str(seed), "--danger-every-s", "1",
               "--water-every-s", "0", "--set", f"/channel/depth_m={depth}", "--set", f"/channel/velocity_m_s={speed}",
               "--set", f"/crowd/tau={options.tau}", "--set", f"/fluid/particle_spacing_m={min(SPACING, depth)}"]
    if options.until_s:
        command += ["--until-s", str(options.until_s)]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"depth_sweep.py: {' '.join(map(str, command))} ended with {done.returncode}:\n{done.stderr}")
    outcome = json.loads((folder / "outcome.json").read_text(encoding="utf-8"))
    with (folder / "agents.csv").open(newline="", encoding="utf-8") as file:
        met = collections.Counter(agent["danger_level"] for agent in csv.DictReader(file))
    level_met, count = met.most_common(1)[0]
    product = rounded(depth * speed)
    return {"scene": outcome["scene"], "tau": options.tau, "depth_m": depth, "v_f_m_s": speed, "dv_m2_s": product,
            "level": level_of(product), "seed": seed, "agents": outcome["agents"], "arrived": outcome["arrived"],
            "dead": outcome["dead"], "active": outcome["active"],
            "last_arrival_s": "" if outcome["last_arrival_s"] is None else outcome["last_arrival_s"],
            "level_met": level_met, "agents_at_level_met": count}


def read_table(path):
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if None not in row.values()]


def key_of(row):
    return float(row["tau"]), float(row["depth_m"]), float(row["v_f_m_s"]), int(row["seed"])


def limit_of(scene, tau):
    """Largest H v_F, m2/s, at which an agent in the middle of a uniform stream holds its ground by Eq. 9.

    v_F < v_B m_a / (tau m_c), and the water in contact weighs m_c = rho H pi r^2, so that H v_F < v_B m_a / (tau rho pi r^2).
    """
    coupling, group = scene["coupling"], scene["crowd"]["groups"][0]
    r_a, r_p = coupling["agent_radius_m"], coupling["particle_radius_m"]
    radius = r_a + r_p if coupling["contact_rule"] == "sum" else abs(r_a - r_p)
    walk = (0.989 if scene["crowd"]["speed_rule"] == "pi" else 1) * group["desired_speed_m_s"]
    return walk * group["mass_kg"] / (tau * scene["fluid"]["rest_density_kg_m3"] * math.pi * radius**2)


def edges(values):
    """Borders half-way between values, on a scale of ratios."""
    log = np.log(values)
    middle = (log[1:] + log[:-1]) / 2
    return np.exp(np.concatenate([[2 * log[0] - middle[0]], middle, [2 * log[-1] - middle[-1]]]))


def draw(rows, tau, limit, output):
    depths, speeds = (sorted({float(row[name]) for row in rows}) for name in ("depth_m", "v_f_m_s"))
    arrived, total = np.zeros((len(depths), len(speeds))), np.zeros((len(depths), len(speeds)))
    for row in rows:
        place = depths.index(float(row["depth_m"])), speeds.index(float(row["v_f_m_s"]))
        arrived[place] += int(row["arrived"])
        total[place] += int(row["agents"])
    share = np.divide(arrived, total, out=np.full_like(arrived, np.nan), where=total > 0)
    figure, axes = plt.subplots(figsize=(8.2, 6.2), dpi=150)
    x, y = edges(speeds), edges(depths)
    colours = axes.pcolormesh(x, y, share, cmap="cividis", vmin=0, vmax=1, edgecolors="white", linewidth=0.6)
    for i, depth in enumerate(depths):
        for j, speed in enumerate(speeds):
            if total[i, j] > 0:
                axes.text(speed, depth, f"{100 * share[i, j]:.0f}", ha="center", va="center", fontsize=8,
                          color="black" if share[i, j] > 0.55 else "white")
    line = np.geomspace(x[0], x[-1], 50)
    for product, level, style in LINES:
        axes.plot(line, product / line, style, color="#d55e00", linewidth=2,
                  label=f"$H v_F$ = {product:g} m²/s: {level} from here on")
    if limit:
        axes.plot(line, limit / line, "-.", color="#cc79a7", linewidth=2.6,
                  label=f"$H v_F$ = {limit:.2f} m²/s: limit of Eq. 9 for τ {tau:g}")
    axes.set(xscale="log", yscale="log", xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel="velocity $v_F$, m/s",
             ylabel="depth $H$, m")
    for axis, values in ((axes.xaxis, speeds), (axes.yaxis, depths)):
        axis.set_ticks(values, labels=[f"{value:g}" for value in values])
        axis.set_ticks([], minor=True)
    seeds = len({row["seed"] for row in rows})
    axes.set_title(f"{rows[0]['scene']}, τ {tau:g}: share that arrives, %"
                   + (f" (mean of {seeds} seeds)" if seeds > 1 else f" (seed {rows[0]['seed']})"), fontsize=11)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=2, frameon=False, fontsize=9)
    figure.colorbar(colours, ax=axes, label="share that arrives")
    figure.savefig(output, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--scene", default=ROOT / "configs" / "observed" / "observed.json", help="[observed.json]")
    parser.add_argument("--tau", type=float, default=0.8, help="endurance of all agents, above 0 to 1 [0.8]")
    parser.add_argument("--seeds", default="1", metavar="A-B", help="seeds [1]")
    parser.add_argument("--points", type=int, default=8, metavar="N", help="depths, and velocities, 2 to 50 [8]")
    parser.add_argument("--until-s", type=float, metavar="T", help="end of each run, s [the scene's]")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/depth_sweep"), metavar="DIR")
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "build" / "release", help="[build/release]")
    options = parser.parse_args()
    seeds = re.fullmatch(r"(\d+)(?:-(\d+))?", options.seeds)
    if not seeds:
        parser.error(f"--seeds: {options.seeds}, allowed is A-B or A")
    if not 0 < options.tau <= 1:
        parser.error(f"--tau: {options.tau}, allowed is above 0 to 1")
    if not 2 <= options.points <= 50:
        parser.error(f"--points: {options.points}, allowed is 2 to 50")
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "depth_sweep.csv"
    rows = read_table(path)
    done = {key_of(row) for row in rows}
    with path.open("a", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS)
        if path.stat().st_size == 0:
            table.writeheader()
        for seed in range(int(seeds[1]), int(seeds[2] or seeds[1]) + 1):
            for depth in map(rounded, np.geomspace(0.25, 1.5, options.points)):
                for speed in map(rounded, np.geomspace(0.5, 5, options.points)):
                    if (options.tau, depth, speed, seed) in done:
                        continue
                    row = run_point(options, options.out / "run", depth, speed, seed)
                    table.writerow(row)
                    file.flush()
                    print(f"H {depth:g} m, v_F {speed:g} m/s: {row['arrived']} of {row['agents']} arrive, "
                          f"level {row['level']}, met {row['level_met']}", flush=True)
    rows = [row for row in read_table(path) if float(row["tau"]) == options.tau]
    scene = json.loads(subprocess.run(
        [options.programs / "crowd_client", options.scene, "--print-config", "--set", f"/crowd/tau={options.tau}"],
        check=True, capture_output=True, text=True).stdout)
    draw(rows, options.tau, limit_of(scene, options.tau), options.out / "depth_sweep.png")
    print(options.out / "depth_sweep.png")


if __name__ == "__main__":
    main()
