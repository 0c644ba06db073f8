#!/usr/bin/env python3
"""Measures the rows of the table of the choice of the model that tests/validation/speed_vs_error lacks.

    tools/model_choice/measure.py --out DIR

writes tests/validation/model_choice/measured.csv and the finest runs of the scenes that have none elsewhere. A row says
with its command how it was made. Standard library only.
"""

import argparse
import csv
import io
from pathlib import Path

from runs import ROOT, command_of, median_and_p95, read_standing, run, standing_of, store_standing, write_whole

HOME = ROOT / "tests" / "validation" / "model_choice"
DATA = ROOT / "tests" / "validation" / "data"

FINEST = 0.09284  # m, of the finest runs made here: a fifth of the paper's spacing
# kind of water: the scene that measures it, its finest run and the spacing of that, m.
SCENES = {
    "river": ("configs/validation/impulse_river.json", DATA / "impulse_river_standing.csv", 0.09284),
    "dry_front": ("configs/validation/impulse_front.json", DATA / "impulse_front_standing.csv", 0.0773667),
    "wet_front": ("configs/model_choice/table_wet_front.json", HOME / "data" / "table_wet_front_standing.csv", FINEST),
    "inflow": ("configs/model_choice/table_inflow.json", HOME / "data" / "table_inflow_standing.csv", FINEST),
    "lee": ("configs/validation/impulse_lee.json", DATA / "impulse_lee_standing.csv", 0.09284),
}
SPACINGS = (0.4642, 0.2321, 0.1161)
GRAVITY = 9.81
SEEDS = range(2, 9)  # chance of the models that draw particles at random; 1 is the scenes' own

HEADER = (
    "kind,model,spacing_m,tolerance,divergence_tolerance,cfl,kernel,chance,particles,particle_steps,simulated_s,"
    "solver_cpu_s,impulse_median,impulse_p95,failure,command"
).split(",")
DEFAULT = {"tolerance": 0.0005, "divergence_tolerance": 0.001, "cfl": 0.5, "kernel": "cubic_spline"}


def room(kind, spacing):
    """max_particles: those of 14 m x 6 m x 1 m and an eighth more, at least as many as the emitter needs at 0.4642 m."""
    return [f"/fluid/max_particles={max(1200, int(84 * 1.125 / spacing**3))}"]


def water(model, spacing, cfl=None, chance=""):
    values = [f"/fluid/model={model}", f"/fluid/particle_spacing_m={spacing:g}"]
    if model == "shallow_water":
        values.append(f"/fluid/shallow_water/cell_size_m={spacing:g}")
    if cfl is not None:
        values.append(f"/fluid/cfl={cfl:g}")
    if chance.startswith("seed "):
        values.append(f"/seed={chance.removeprefix('seed ')}")
    elif chance:
        values.append(f"/world/gravity_m_s2={GRAVITY * (1 + float(chance.removeprefix('gravity '))):.10g}")
    return values


def points():
    """What is measured: (kind, model, spacing, cfl, what is left to chance), the cheap ones first."""
    wanted = []
    for kind in SCENES:
        known = kind in ("river", "dry_front", "lee")  # what the speed-against-error report has
        for d in SPACINGS:
            wanted.append((kind, "shallow_water", d, 0.5, ""))
            if d > 0.2:
                wanted.append((kind, "steering", d, 0.5, ""))
                wanted += [(kind, "dfsph", d, 0.5, f"gravity {change:g}") for change in (-1e-4, 1e-4)]
                models = ("shallow_water", "kinematic") if kind == "river" else ("shallow_water",)
                wanted += [(kind, model, d, 0.5, f"seed {seed}") for model in models for seed in SEEDS]
            if not known or (d < 0.2 and kind != "dry_front"):
                wanted += [(kind, "dfsph", d, cfl, "") for cfl in (1.0, 0.5)]
    return sorted(wanted, key=lambda p: p[1] == "dfsph" and p[2] < 0.2)


def finest(kind, folder):
    scene, table, _ = SCENES[kind]
    if not table.exists():
        overrides = water("dfsph", FINEST) + room(kind, FINEST)
        document = run(scene, overrides, folder)
        if "error" in document:
            raise SystemExit(f"measure.py: the finest run of {scene} failed: {document['error']}")
        store_standing(document, command_of(scene, overrides), table)
    return read_standing(table)


def row_of(point, folder):
    kind, model, d, cfl, chance = point
    scene = SCENES[kind][0]
    overrides = water(model, d, cfl, chance) + room(kind, d)
    document = run(scene, overrides, folder)
    row = {"kind": kind, "model": model, "spacing_m": f"{d:g}", "chance": chance}
    if model == "dfsph":
        row |= {k: f"{v:g}" if isinstance(v, float) else v for k, v in (DEFAULT | {"cfl": cfl}).items()}
    row["command"] = " ".join(command_of(scene, overrides))
    if "error" in document:
        return row | {"failure": document["error"].replace("\n", " ")}
    median, p95 = median_and_p95(standing_of(document), finest(kind, folder))
    return row | {
        "particles": document["particles"],
        "particle_steps": f"{document['particle_steps']:.10g}",
        "simulated_s": f"{document['simulated_s']:g}",
        "solver_cpu_s": f"{document['solver_cpu_s']:.6g}",
        "impulse_median": f"{median:.6g}",
        "impulse_p95": f"{p95:.6g}",
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder of the runs; those that are there are not repeated")
    options = parser.parse_args()
    rows = []
    for point in points():
        rows.append(row_of(point, options.out))
        text = io.StringIO()
        writer = csv.DictWriter(text, HEADER, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        write_whole(HOME / "measured.csv", text.getvalue())


if __name__ == "__main__":
    main()
