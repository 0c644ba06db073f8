#!/usr/bin/env python3
"""Makes the table from which the server chooses a model: fluid_server/model_choice/table.csv.

    tools/model_choice/table.py           write it
    tools/model_choice/table.py --check   exit code 1 if it is not what the measurements give

It is made of tests/validation/model_choice/speed_vs_error.csv (dfsph and kinematic, one thread), the edition of the
speed-against-error report with which its choices were checked, and, where that has none, of measured.csv beside it.
Standard library only.
"""

import argparse
import csv
import io
import json
import re
import sys
from pathlib import Path

from measure import HOME, SCENES
from runs import ROOT, write_whole

TABLE = ROOT / "fluid_server" / "model_choice" / "table.csv"
REPORT = ROOT / "tests" / "validation" / "model_choice" / "speed_vs_error.csv"
CASES = {"impulse_river": "river", "impulse_front": "dry_front", "impulse_lee": "lee"}
OF_REPORT = ("dfsph", "kinematic")  # models whose points are taken from the report; the others were measured for the choice
SETTINGS = ("model", "spacing_m", "tolerance", "divergence_tolerance", "cfl", "kernel")
DEFAULT = ("0.0005", "0.001", "0.5", "cubic_spline")
HEADER = (
    "kind,model,spacing_m,tolerance,divergence_tolerance,cfl,kernel,impulse_median,impulse_p95,"
    "steps_per_s,us_per_particle_step,wave_speed_m_s"
).split(",")

NOTE = """\
# From which the server chooses a model, see table.hpp. Written by tools/model_choice/table.py, not by hand.
# Errors of the impulse on people who stand, relative to a fine run of dfsph, in water 1 m deep and with a contact distance of
# 0.25 m. A row has the largest error that chance makes of it: of dfsph at least that of the default of its spacing, also with
# gravity changed by 0.01 %, of kinematic and shallow_water that of eight seeds. Of dfsph it is then divided by 1 - d_finest / d, as the finest run, of spacing d_finest, has an error, too,
# unless a finer run became worse than a coarser one by that.
"""


def rows_of_report():
    """Points of the report: (kind, settings) -> values."""
    points = {}
    with open(REPORT, newline="") as file:
        for row in csv.DictReader(file):
            if row["case"] not in CASES or row["model"] not in OF_REPORT or row["threads"] != "1" or row["failure"]:
                continue
            key = (CASES[row["case"]], *(row[name] for name in SETTINGS))
            point = points.setdefault(key, {})
            point[row["error_metric"]] = float(row["error"])
            particle_steps = float(row["particle_steps_per_s"]) * float(row["wall_s_per_sim_s"])
            point["steps_per_s"] = particle_steps / float(row["particles"])
            point["us_per_particle_step"] = 1e6 * float(row["cpu_s_per_sim_s"]) / particle_steps
    return points


def rows_measured():
    """The same of what was measured for the choice, and errors that differ by chance: (kind, model, spacing) -> list."""
    points, chance = {}, {}
    with open(HOME / "measured.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["failure"]:
                continue
            errors = {name: float(row[name]) for name in ("impulse_median", "impulse_p95")}
            if row["chance"]:
                chance.setdefault((row["kind"], row["model"], row["spacing_m"]), []).append(errors)
                continue
            steps = float(row["particle_steps"])
            points[(row["kind"], *(row[name] for name in SETTINGS))] = errors | {
                "steps_per_s": steps / float(row["particles"]) / float(row["simulated_s"]),
                "us_per_particle_step": 1e6 * float(row["solver_cpu_s"]) / steps,
            }
    return points, chance


def wave_speed(kind):
    """sqrt(g depth) + v_F of the scene that measured a kind, m/s."""
    text = re.sub(r"^\s*//.*$", "", (ROOT / SCENES[kind][0]).read_text(), flags=re.M)
    scene = json.loads(text)
    channel = scene["channel"]
    depth = max([b["depth_m"] for b in channel.get("water_blocks", [])] or [channel.get("depth_m", 1)])
    return (scene["world"]["gravity_m_s2"] * depth) ** 0.5 + channel.get("velocity_m_s", 0)


def beyond_finest(kind, model, spacing):
    """By how much the error of dfsph is larger than that against a finest run, which has an error itself.

    If errors are proportional to the spacing, the distance of two runs is the share 1 - d_finest / d of the coarser's error.
    """
    return 1 / (1 - SCENES[kind][2] / spacing) if model == "dfsph" else 1.0


def table_text():
    measured, chance = rows_measured()
    points = measured | rows_of_report()
    kinds = list(SCENES)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(HEADER)
    estimates = {}  # of the next coarser spacing
    order = sorted(points, key=lambda k: (kinds.index(k[0]), k[1], *k[3:], -float(k[2])))
    for key in order:
        kind, model, spacing = key[:3]
        point = points[key]
        values = []
        for name in ("impulse_median", "impulse_p95"):
            same = chance.get((kind, model, spacing), [])
            if model == "dfsph":
                same = [points.get((kind, model, spacing, *DEFAULT), point), *same]
            error = max(p[name] for p in [point, *same])
            # The addition for the finest run's own error does not make a finer run worse than a coarser one.
            coarser = estimates.get((kind, model, *key[3:], name), float("inf"))
            estimate = min(error * beyond_finest(kind, model, float(spacing)), max(error, coarser))
            estimates[(kind, model, *key[3:], name)] = estimate
            values.append(estimate)
        values += [point["steps_per_s"], point["us_per_particle_step"], wave_speed(kind)]
        writer.writerow([*key, *(f"{v:.4g}" for v in values)])
    return NOTE + out.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    text = table_text()
    if not options.check:
        write_whole(TABLE, text)
    elif not TABLE.exists() or TABLE.read_text() != text:
        sys.exit(f"{TABLE}: not what the measurements give; run tools/model_choice/table.py")


if __name__ == "__main__":
    main()
